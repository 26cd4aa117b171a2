"""From a validator's findings to sentences that a test engineer can act on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from vgvt.data.given import BOUNDS, bound, miscounted, shown
from vgvt.data.key_paths import key_path
from vgvt.scenario.base import MisfitError, Table
from vgvt.scenario.vocabulary import TOP, fixed_length, guess, inner_table, is_array_of_tables, meaning_of, table_at

Key = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Problem:
    """One mistake in a scenario: at which key, what is wrong, what to write."""

    key: Key
    text: str
    advice: str = ""
    instead: tuple[Problem, ...] = ()
    """The same mistake as it is told at the other keys that make it."""

    def at_own(self, is_own: Callable[[Key], bool]) -> Problem:
        """The mistake at the first of its keys that is the writer's own; at the first of all where none is."""
        return next((problem for problem in (self, *self.instead) if is_own(problem.key)), self)


def problems_of(error: ValidationError) -> tuple[Problem, ...]:
    """Every finding of the validator in plain words, one a key."""
    found: dict[Key, Problem] = {}
    for detail in error.errors(include_url=False):
        if miscounted(dict(detail)):
            continue
        problem = _explained(dict(detail))
        found.setdefault(problem.key, problem)
    return tuple(found.values())


def _explained(detail: Mapping[str, Any]) -> Problem:
    key: Key = tuple(detail["loc"])
    kind, value, limits = detail["type"], detail["input"], detail.get("ctx", {})
    name = next((step for step in reversed(key) if isinstance(step, str)), "")
    table = _table_of(key)
    if kind == "value_error":
        error = limits["error"]
        if isinstance(error, MisfitError):
            return _at(key, error)
        return Problem(key, str(error))
    if kind == "extra_forbidden":
        return Problem(key, "is not a key of this table", guess(table, _place(key[:-1]), name) if table else "")
    if kind == "missing" and key[-1] == name:
        return Problem(key, "is missing", _write(table, key))
    if kind == "missing":
        return Problem(key[:-1], _wrong_count(table, name, value), _write(table, key))
    if kind == "too_long" and table and fixed_length(table.model_fields[name].annotation):
        return Problem(key, _wrong_count(table, name, value), _write(table, key))
    if kind == "tuple_type" and isinstance(value, dict):
        return Problem(
            key, "is one table, but must be an array of tables", f"Write its heading as [[{key_path(key)}]]."
        )
    if kind == "tuple_type" and table and is_array_of_tables(table.model_fields[name].annotation):
        return Problem(key, f"is {shown(value)}, but must be an array of tables", _write(table, key))
    return Problem(key, _what_is_wrong(kind, value, limits), _write(table, key))


def _at(key: Key, error: MisfitError) -> Problem:
    instead = tuple(_at(key, other) for other in error.instead)
    return Problem((*key, *error.key), error.problem, error.advice, instead)


_LENGTHS = {"too_short": ("min_length", "at least"), "too_long": ("max_length", "at most")}

_EXPECTED = {
    "finite_number": "an ordinary number",
    "float_type": "a number without quotes",
    "int_type": "a whole number without quotes or decimals",
    "int_from_float": "a whole number",
    "string_type": 'text in "quotes"',
    "bool_type": "true or false, without quotes",
    "tuple_type": "a list in [brackets]",
    "model_type": "a table of keys under a [heading]",
    "string_pattern_mismatch": "lower-case letters, digits and hyphens, like my-aircraft-2",
}


def _what_is_wrong(kind: str, value: Any, limits: Mapping[str, Any]) -> str:
    if kind in BOUNDS:
        return f"is {shown(value)}, but must be {bound(kind, limits)}"
    if kind in _LENGTHS:
        limit, words = _LENGTHS[kind]
        return f"has {limits['actual_length']} entries, but needs {words} {limits[limit]}"
    if kind == "literal_error":
        return f"is {shown(value)}, but must be {limits['expected']}"
    return f"is {shown(value)}, but must be {_EXPECTED.get(kind, 'of another kind')}"


def _wrong_count(table: type[Table] | None, name: str, value: Any) -> str:
    count = fixed_length(table.model_fields[name].annotation) if table else None
    return f"is {shown(value)}, but must have exactly {count} entries"


def _table_of(key: Key) -> type[Table] | None:
    """The table that holds the last named key of a path."""
    steps = list(key)
    while steps and isinstance(steps[-1], int):
        steps.pop()
    return table_at(tuple(steps[:-1]))


def _heading(path: Key) -> str:
    names = ".".join(step for step in path if isinstance(step, str))
    return f"[[{names}]]" if isinstance(path[-1], int) else f"[{names}]"


def _place(path: Key) -> str:
    return f"in {_heading(path)}" if path else TOP


def _write(table: type[Table] | None, key: Key) -> str:
    """What to write at a key: its form, meaning and unit."""
    name = next((step for step in reversed(key) if isinstance(step, str)), "")
    field = table.model_fields.get(name) if table else None
    if table is None or field is None:
        return ""
    meaning = meaning_of(table, name)
    form = f"{name} = …"
    if inner_table(field.annotation) is not None:
        many = is_array_of_tables(field.annotation) and key[-1] == name
        form = f"[{_heading(key)}] as the heading of each" if many else f"the table {_heading(key)}"
    return f"Write {form}" + (f": {meaning}." if meaning else ".")
