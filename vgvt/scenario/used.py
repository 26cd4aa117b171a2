"""Which of a scenario's tables a simulation reads: what else is written there tells one test from no other."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

from vgvt.scenario.model import Scenario
from vgvt.scenario.rig import Shaker

_MODEL = {"model"}
_WORDS: dict[str, Any] = {
    **dict.fromkeys(("schema_version", "name", "summary", "lesson", "tolerances"), True),
    **dict.fromkeys(("shaker", "hammer", "transducer", "accelerometers", "acquisition", "generator"), _MODEL),
    "further_shaker": {"__all__": _MODEL},
}
"""What no simulation reads, as pydantic leaves it out of a dump; tolerances are for reconcile."""
_AIRFRAME_WORDS = {"name": True, "configuration": True, "sources": True}
_ITEM_NAMES = {"item": {"__all__": {"name"}}}
"""Only effects call an item by its name."""

_SHAKER_PLACE = {"node", "position_m", "attached_to"}
_OFF_UNDER_A_HAMMER: dict[str, Any] = {
    "shaker": set(Shaker.model_fields) - _SHAKER_PLACE,
    "stinger": True,
    "transducer": True,
    "generator": True,
    "excitation": {"amplitude_v", "taper_s"},
}
"""With a hammer there is no rig on the aircraft and no command; of the shaker its point remains, to be hit."""
_COIL = {"coil_resistance_ohm", "coil_inductance_h"}
"""An amplifier that controls the current sends it through any coil."""


def used_tables(scenario: Scenario) -> dict[str, Any]:
    """What a simulation reads of a scenario, as plain tables: with equal ones, seed and all, the records are equal.

    Keys that are left out have no entry.
    """
    return _without(scenario, _words(scenario) | _rig(scenario), exclude_none=True)


def is_there(tables: Any, place: tuple[str | int, ...]) -> bool:
    """Whether plain tables have an entry at a place."""
    for step in place:
        if step not in (tables if isinstance(tables, dict) else range(len(tables))):
            return False
        tables = tables[step]
    return True


def is_wording(scenario: Scenario, place: tuple[str | int, ...]) -> bool:
    """Whether the entry at a place is for readers, or for reconcile, whatever the test is."""
    return _is_left_out(scenario, _words(scenario), place)


def why_unused(scenario: Scenario, place: tuple[str | int, ...]) -> str:
    """In words why no simulation of a scenario would read an entry at a place; '' where it would."""
    if is_wording(scenario, place):
        return "no simulation depends on it"
    if not _is_left_out(scenario, _rig(scenario), place):
        return ""
    if _struck(scenario):
        return "no test with a hammer depends on it"
    return "only a test with a hammer depends on it" if place[0] == "hammer" else "no current drive depends on it"


def comparable(tables: Any) -> Hashable:
    """Plain tables as something that is equal, and has an equal hash, where they are equal."""
    if isinstance(tables, dict):
        return tuple((key, comparable(tables[key])) for key in sorted(tables))
    if isinstance(tables, list | tuple):
        return tuple(comparable(value) for value in tables)
    known: Hashable = tables
    return known


def _struck(scenario: Scenario) -> bool:
    return scenario.excitation.kind == "impact"


def _words(scenario: Scenario) -> dict[str, Any]:
    return _WORDS | {"airframe": _AIRFRAME_WORDS | ({} if scenario.effect else _ITEM_NAMES)}


def _rig(scenario: Scenario) -> dict[str, Any]:
    """What the kind of test makes idle, as pydantic leaves it out of a dump."""
    if _struck(scenario):
        return _OFF_UNDER_A_HAMMER
    first, *further = (_MODEL | _COIL if shaker.drive == "current" else _MODEL for shaker in scenario.shakers)
    return {"hammer": True, "shaker": first, "further_shaker": dict(enumerate(further))}


def _is_left_out(scenario: Scenario, left_out: dict[str, Any], place: tuple[str | int, ...]) -> bool:
    # A parameter that an effect has by default is in no table, and can be swept all the same.
    return is_there(_without(scenario, {}), place) and not is_there(_without(scenario, left_out), place)


def _without(scenario: Scenario, left_out: dict[str, Any], exclude_none: bool = False) -> dict[str, Any]:
    return scenario.model_dump(mode="json", exclude=left_out, exclude_none=exclude_none)
