"""Strict TOML tables: unknown keys are refused and every mistake is told with its key path."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from vgvt.data import InputError
from vgvt.data.given import BOUNDS, bound, miscounted, shown
from vgvt.data.key_paths import key_path, with_entries
from vgvt.data.suggestion import choose_one_of
from vgvt.files.toml_syntax import parsed_toml

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]


class Table(BaseModel):
    """A frozen table that refuses unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=False, use_attribute_docstrings=True)


_T = TypeVar("_T", bound=Table)


def load_table(path: Path, model: type[_T]) -> _T:
    """A TOML file as a checked table; InputError names the file, the line or key path, and what to write."""
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise InputError(str(path), f"cannot be read: {error.strerror or error}", "check the path") from error
    content = parsed_toml(path, raw)
    try:
        return model.model_validate(content)
    except ValidationError as error:
        details = [dict(detail) for detail in error.errors(include_url=False)]
        found = [_explain(model, detail, content) for detail in details if not miscounted(detail)]
        lines = list({told[0]: told for told in reversed(found)}.values())[::-1]
        where, problem, advice = lines[0]
        rest = "".join(f"\n  also {w}: {p}; {a}" if a else f"\n  also {w}: {p}" for w, p, a in lines[1:6])
        more = f"\n  and {len(lines) - 6} more" if len(lines) > 6 else ""
        raise InputError(f"{path}, {where}", problem, advice + rest + more) from error


def _explain(model: type[Table], detail: Mapping[str, Any], content: Mapping[str, Any]) -> tuple[str, str, str]:
    location, kind = detail["loc"], detail["type"]
    # Not keys: which of several types was tried, and the entry that a list lacks.
    if location and (location[-1] in ("int", "str") or (kind == "missing" and isinstance(location[-1], int))):
        location, kind = location[:-1], "too_short" if kind == "missing" else "union"
    problem, advice = _problem(model, location, kind, detail)
    return key_path(location) or "the file as a whole", problem, with_entries(advice, location, content)


def _problem(model: type[Table], location: tuple[Any, ...], kind: str, detail: Mapping[str, Any]) -> tuple[str, str]:
    key = str(location[-1]) if location else ""
    if kind == "extra_forbidden":
        known = _keys_at(model, location[:-1])
        return "unknown key", choose_one_of(key, known) if known else "leave it out"
    if kind == "missing":
        return "is missing", f"write {key} = ..."
    if kind == "value_error":
        problem, _, advice = detail["msg"].removeprefix("Value error, ").partition("; ")
        return problem, advice
    wrong, form = _wrong(kind, detail["input"], detail.get("ctx", {}))
    meaning = _meaning_at(model, location)
    named = next((step for step in reversed(location) if isinstance(step, str)), key)
    return wrong, f"write {named} = {form}" + (f" ({meaning})" if meaning else "")


_FORMS = {
    "string_type": ("text in quotes", '"..."'),
    "float_type": ("a number", "1.5, without quotes"),
    "float_parsing": ("a number", "1.5, without quotes"),
    "finite_number": ("an ordinary number", "1.5"),
    "int_type": ("a whole number", "2, without quotes"),
    "int_parsing": ("a whole number", "2, without quotes"),
    "int_from_float": ("a whole number", "2"),
    "tuple_type": ("a list", "[...], in brackets"),
    "too_long": ("a list with fewer entries", "[...]"),
    "too_short": ("a list with more entries", "[...]"),
    "union": ("a whole number, or text in quotes", "2"),
    "model_type": ("a table", "{ ... }, or its keys under a heading in brackets"),
    "dict_type": ("a table", "{ ... }, or its keys under a heading in brackets"),
}


def _wrong(kind: str, value: Any, limits: Mapping[str, Any]) -> tuple[str, str]:
    """What was given against what may be, and its form."""
    if kind in BOUNDS:
        limit = bound(kind, limits)
        return f"{shown(value)} was given, it must be {limit}", f"a number, {limit}"
    if kind in ("literal_error", "enum"):
        return f"{shown(value)} is none of the choices", str(limits["expected"])
    if kind == "string_pattern_mismatch":
        return f"{shown(value)} does not have the form of this key", f'"...", as in {limits["pattern"]}'
    words, form = _FORMS.get(kind, ("of the kind that belongs here", "..."))
    return f"{shown(value)} was given, it must be {words}", form


def _meaning_at(model: type[Table], location: tuple[Any, ...]) -> str:
    """What the key at a place means, where its table says so."""
    steps = [step for step in location if isinstance(step, str)]
    for end in range(len(steps), 0, -1):
        table = _table_at(model, tuple(steps[: end - 1]))
        if table is not None and steps[end - 1] in table.model_fields:
            said = (table.model_fields[steps[end - 1]].description or "").rstrip(".")
            return said[:1].lower() + said[1:]
    return ""


def _keys_at(model: type[Table], location: tuple[Any, ...]) -> tuple[str, ...]:
    """The keys of the table at a place in the model; empty where that is no table."""
    table = _table_at(model, location)
    return tuple(table.model_fields) if table is not None else ()


def _table_at(model: type[Table], location: tuple[Any, ...]) -> type[Table] | None:
    table: Any = model
    for step in location:
        if isinstance(step, int):
            continue
        if not (isinstance(table, type) and issubclass(table, Table)) or step not in table.model_fields:
            return None
        annotation = table.model_fields[step].annotation
        table = next((a for a in (annotation, *getattr(annotation, "__args__", ())) if isinstance(a, type)), None)
    return table if isinstance(table, type) and issubclass(table, Table) else None
