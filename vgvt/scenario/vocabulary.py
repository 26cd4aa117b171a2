"""What the schema knows about its own words: which table has which key, what it means, in which unit."""

from __future__ import annotations

import difflib
from functools import cache
from typing import Any, get_args, get_origin

from vgvt.scenario.base import Table, written_fields
from vgvt.scenario.model import Scenario

TOP = "at the top of the file, before any [table]"

_UNITS = {
    "_n_m_per_rad": "N m/rad",
    "_n_m_s_per_rad": "N m s/rad",
    "_n_s_per_m": "N s/m",
    "_n_per_m": "N/m",
    "_n_per_a": "N/A",
    "_n_m2": "N m²",
    "_kg_m2": "kg m²",
    "_kg_per_m": "kg/m",
    "_kg_m": "kg m",
    "_v_per_n": "V/N",
    "_v_per_g": "V/g",
    "_v_per_rthz": "V/√Hz",
    "_kg": "kg",
    "_g": "g",
    "_hz": "Hz",
    "_ohm": "Ω",
    "_h": "H",
    "_n": "N",
    "_s": "s",
    "_v": "V",
    "_m": "m",
    "_ratio": "fraction of critical",
}


def unit_of(key: str) -> str:
    """The SI unit that a key's ending states, '' for none."""
    return next((unit for ending, unit in sorted(_UNITS.items(), key=lambda e: -len(e[0])) if key.endswith(ending)), "")


def meaning_of(table: type[Table], key: str) -> str:
    """What a key means and its unit, as a phrase for messages; '' where neither is known."""
    field = table.model_fields.get(key)
    text = " ".join((field.description or "").split()).rstrip(".") if field else ""
    unit = unit_of(key)
    if len(text) > 1 and text[1].islower():
        text = text[0].lower() + text[1:]
    return ", ".join(words for words in (text, f"in {unit}" if unit else "") if words)


def table_at(path: tuple[str | int, ...]) -> type[Table] | None:
    """The table that a key path leads to, None where the path does not lead to a table."""
    table: type[Table] | None = Scenario
    for step in path:
        if isinstance(step, int):
            continue
        field = table.model_fields.get(step) if table else None
        table = inner_table(field.annotation) if field else None
    return table


def inner_table(annotation: Any) -> type[Table] | None:
    """The table inside an annotation such as ``tuple[Beam, ...]`` or ``NoiseSpectrum | None``."""
    if isinstance(annotation, type) and issubclass(annotation, Table):
        return annotation
    found = (inner_table(a) for a in get_args(annotation))
    return next((t for t in found if t is not None), None)


def is_array_of_tables(annotation: Any) -> bool:
    """Whether an annotation such as ``tuple[Beam, ...]`` is written as [[headings]], one an entry."""
    if get_origin(annotation) is tuple:
        return inner_table(annotation) is not None
    return any(is_array_of_tables(inner) for inner in get_args(annotation))


def fixed_length(annotation: Any) -> int | None:
    """How many entries a tuple of fixed length inside an annotation has; None where there is none."""
    arguments = get_args(annotation)
    if get_origin(annotation) is tuple and Ellipsis not in arguments:
        return len(arguments)
    found = (fixed_length(a) for a in arguments)
    return next((n for n in found if n is not None), None)


def guess(table: type[Table], here: str, key: str) -> str:
    """A sentence about an unknown key of a table, ``here`` in the file: where it belongs, or what was meant."""
    # No field of any table: a file is merged with the one that it extends before it is checked.
    known = (*(("extends",) if table is Scenario else ()), *written_fields(table))
    owners = _owners()
    elsewhere = [place for place in owners.get(key, ()) if place != here]
    if elsewhere:
        return f"{key} belongs {' or '.join(elsewhere[:3])}."
    near = difflib.get_close_matches(key, known, n=1, cutoff=0.6)
    if near:
        return f"Did you mean {near[0]}?"
    parts = [name for name in known if f"_{key}_" in f"_{name}_" or f"_{name}_" in f"_{key}_"]
    if parts:
        return f"Did you mean {parts[0]}?"
    far = difflib.get_close_matches(key, owners, n=1, cutoff=0.75)
    if far:
        return f"Did you mean {far[0]} {owners[far[0]][0]}?"
    return f"The keys {here} are {', '.join(known)}."


@cache
def _owners() -> dict[str, tuple[str, ...]]:
    """Every key of the schema and the headings of the tables that have it."""
    owners: dict[str, list[str]] = {}

    def walk(table: type[Table], path: str, many: bool) -> None:
        place = f"in [[{path}]]" if many else f"in [{path}]" if path else TOP
        for key, field in written_fields(table).items():
            owners.setdefault(key, []).append(place)
            inner = inner_table(field.annotation)
            if inner is not None:
                walk(inner, f"{path}.{key}".lstrip("."), str(field.annotation).startswith("tuple"))

    walk(Scenario, "", False)
    owners["extends"] = [TOP]
    return {key: tuple(places) for key, places in owners.items()}
