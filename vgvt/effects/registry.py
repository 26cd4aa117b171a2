"""Finds effects by entry point (group ``vgvt.effects``) and makes those that a scenario switches on."""

from __future__ import annotations

import dataclasses
import typing
import warnings
from collections.abc import Mapping
from functools import cache
from importlib.metadata import EntryPoint, entry_points

from vgvt.data import InputError
from vgvt.data.plugin import lacking, one_of_each_name, whose_fault
from vgvt.data.suggestion import choose_one_of
from vgvt.effects.parameter import parameters_of, range_fault
from vgvt.effects.protocol import Effect, Family
from vgvt.scenario.model import Scenario

GROUP = "vgvt.effects"
_DECLARED = {
    "summary": str,
    "family": Family,
    "linear": bool,
    "signature": str,
    "confused_with": tuple,
    "separating_test": str,
    "reference": str,
}

# What a scenario file can hold in an [[effect]] table.
_WRITABLE = "bool, int, float, str and Literal[…]"
_IN_WORDS: dict[object, str] = {
    bool: "true or false", int: "a whole number", float: "a finite number", str: "a text in quotes",
}  # fmt: skip


class EffectPluginWarning(UserWarning):
    """An installed effect could not be used."""


def available_effects() -> dict[str, type]:
    """Every usable installed effect class by name, in alphabetical order.

    A plugin that cannot be imported or is no effect is left out with an ``EffectPluginWarning`` that names it, and so
    is one of a name that a bundled effect has, or another plugin of a package that comes first.
    """
    return one_of_each_name(entry_points(group=GROUP), _load, _warn)


def _load(point: EntryPoint) -> type | None:
    try:
        loaded = point.load()
        why = lacking(loaded, point.name, "act(scenario, run)", _DECLARED) or _unusable(loaded)
    except (Exception, SystemExit) as error:  # noqa: BLE001  what a plugin raises must not stop others
        why = f"{type(error).__name__}: {error}"
    if not why:
        return typing.cast(type, loaded)
    _warn(f"effect plugin {point.name!r} ({point.value}) is left out: {why}")
    return None


@cache
def _unusable(cls: type) -> str:
    """What keeps the fields of a class from being tried and fitted, in words; empty where nothing does."""
    hints = typing.get_type_hints(cls)  # raises where it cannot tell
    ranged = {f.name for f in dataclasses.fields(cls) if {"unit", "low", "high"} <= set(f.metadata)}
    for f in dataclasses.fields(cls):
        if f.init and f.default is dataclasses.MISSING:
            made = (
                "a default_factory: write a default" if f.default_factory is not dataclasses.MISSING else "no default"
            )
            return f"its field {f.name!r} has {made}"
        if "unit" in f.metadata and f.name not in ranged:
            return f"its field {f.name!r} has a unit, but no range: make it with parameter(unit, low, high, doc, …)"
        plain = hints[f.name] in (bool, int, float, str) or typing.get_origin(hints[f.name]) is typing.Literal
        if f.init and not plain:
            return f"its field {f.name!r} is none of {_WRITABLE}: an [[effect]] table could not give it"
    turn = getattr(cls, "turn", 0)
    if not isinstance(turn, int):
        return f"its class attribute 'turn' is {turn!r}: give one of vgvt.effects.acting.Turn"
    return next((f"its field {p.name!r}: {said}" for p in parameters_of(cls) if (said := range_fault(p))), "")


def make_effect(name: str, where: str, **values: object) -> Effect:
    """The effect called ``name`` with some parameters set.

    InputError, naming ``where`` (a file and key path), for an unknown name or
    parameter, a value of the wrong type, one that is not finite, or one below
    the parameter's least.
    """
    return _made(available_effects(), name, where, values)


def _made(known: Mapping[str, type], name: str, where: str, values: Mapping[str, object]) -> Effect:
    if name not in known:
        if any(point.name == name for point in entry_points(group=GROUP)):
            problem, advice = (
                f"effect {name!r} is installed, but of no use",
                "mend it: `vgvt doctor` says what is wrong",
            )
            raise InputError(where, problem, advice)
        raise InputError(where, f"there is no effect {name!r}", choose_one_of(name, tuple(known)))
    cls = known[name]
    hints = typing.get_type_hints(cls)
    fields = {f.name: f for f in dataclasses.fields(cls) if f.init}
    checked: dict[str, object] = {}
    for key, value in values.items():
        if key not in fields:
            raise InputError(
                f"{where}.{key}", f"effect {name!r} has no such parameter", choose_one_of(key, tuple(fields))
            )
        checked[key] = _fitting(f"{where}.{key}", value, hints[key])
    for about in parameters_of(cls):
        number = checked.get(about.name)
        if about.least is not None and isinstance(number, float) and number < about.least:
            problem = f"effect {name!r}: {number:g} is below {about.least:g}"
            raise InputError(f"{where}.{about.name}", problem, _ranges(cls))
    with whose_fault(cls, f"effect {name!r}", "its constructor"):
        try:
            made: Effect = cls(**checked)
        except ValueError as error:
            raise InputError(where, f"effect {name!r}: {error}", _ranges(cls)) from error
    return made


def effects_of(scenario: Scenario) -> tuple[Effect, ...]:
    """The effects that a scenario's ``[[effect]]`` tables switch on, in their order."""
    known = available_effects() if scenario.effect else {}
    return tuple(
        _made(known, table.name, f"scenario {scenario.name}: effect[{i}]", table.parameters)
        for i, table in enumerate(scenario.effect)
    )


def _fitting(where: str, value: object, hint: object) -> object:
    if hint is float and isinstance(value, int | float) and not isinstance(value, bool):
        number = float(value)
        if number == number and abs(number) != float("inf"):
            return number
    options = typing.get_args(hint) if typing.get_origin(hint) is typing.Literal else None
    if options is not None and value in options:
        return value
    if options is None and isinstance(hint, type) and hint is not float and type(value) is hint:
        return value
    wanted = " or ".join(map(repr, options)) if options else _IN_WORDS.get(hint, str(hint))
    raise InputError(where, f"{value!r} does not fit", f"Write {wanted}.")


def _ranges(cls: type) -> str:
    rows = (f"{p.name} in {p.unit or 'fractions'}, {p.low:g} to {p.high:g} is plausible" for p in parameters_of(cls))
    return "; ".join(rows)


def _warn(what: str) -> None:
    # From one place whoever asks, so that a command that asks often says it once.
    warnings.warn(what, EffectPluginWarning, stacklevel=1)
