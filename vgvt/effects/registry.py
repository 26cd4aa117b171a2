"""Finds effects by entry point (group ``vgvt.effects``) and makes those that a scenario switches on."""

from __future__ import annotations

import dataclasses
import typing
import warnings
from importlib.metadata import entry_points

from vgvt.data import InputError
from vgvt.data.suggestion import choose_one_of
from vgvt.effects.parameter import parameters_of
from vgvt.effects.protocol import Effect
from vgvt.scenario.model import Scenario

GROUP = "vgvt.effects"


class EffectPluginWarning(UserWarning):
    """An installed effect could not be used."""


def available_effects() -> dict[str, type]:
    """Every usable installed effect class by name, in alphabetical order.

    A plugin that cannot be imported or is no effect is left out with an
    ``EffectPluginWarning`` that names it.
    """
    found: dict[str, type] = {}
    for point in sorted(entry_points(group=GROUP), key=lambda p: (p.name, p.value)):
        try:
            loaded = point.load()
        except Exception as error:  # noqa: BLE001  whatever a third-party import raises must not stop the others
            _left_out(point.name, f"{type(error).__name__}: {error}")
            continue
        if not (isinstance(loaded, type) and dataclasses.is_dataclass(loaded) and callable(getattr(loaded, "act", 0))):
            _left_out(point.name, "it is not a dataclass with a method act(scenario, run)")
        elif loaded.__dict__.get("name") != point.name:
            _left_out(point.name, f"the class calls itself {loaded.__dict__.get('name')!r}")
        else:
            found[point.name] = loaded
    return found


def make_effect(name: str, where: str, **values: object) -> Effect:
    """The effect called ``name`` with some parameters set.

    InputError, naming ``where`` (a file and key path), for an unknown name or
    parameter, a value of the wrong type, one that is not finite, or one below
    the parameter's least.
    """
    known = available_effects()
    if name not in known:
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
    try:
        made: Effect = cls(**checked)
    except ValueError as error:
        raise InputError(where, f"effect {name!r}: {error}", _ranges(cls)) from error
    return made


def effects_of(scenario: Scenario) -> tuple[Effect, ...]:
    """The effects that a scenario's ``[[effect]]`` tables switch on, in their order."""
    return tuple(
        make_effect(table.name, f"scenario {scenario.name}: effect[{i}]", **table.parameters)
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
    wanted = " or ".join(map(repr, options)) if options else getattr(hint, "__name__", str(hint))
    raise InputError(where, f"{value!r} does not fit", f"Write {wanted if hint is not float else 'a finite number'}.")


def _ranges(cls: type) -> str:
    rows = (f"{p.name} in {p.unit or 'fractions'}, {p.low:g} to {p.high:g} is plausible" for p in parameters_of(cls))
    return "; ".join(rows)


def _left_out(name: str, why: str) -> None:
    warnings.warn(f"effect plugin {name!r} is left out: {why}", EffectPluginWarning, stacklevel=3)
