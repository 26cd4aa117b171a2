"""What every effect must declare and keep to, checked without a simulation; part of the shipped conformance suite.

The whole suite is ``vgvt.simulation.effect_conformance.checks()``, which runs these
first; see there for the three lines of a plugin's test file.
"""

from __future__ import annotations

import dataclasses
import math
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from vgvt.data.plugin import need_asserts
from vgvt.effects.acting import action_of
from vgvt.effects.action import Action, ChannelFilter
from vgvt.effects.parameter import Parameter, parameters_of, range_fault
from vgvt.effects.protocol import Effect, Family
from vgvt.effects.registry import available_effects, effects_of, make_effect
from vgvt.scenario import Scenario, load_scenario, to_toml
from vgvt.scenario.effect import EffectTable

_FREQUENCY_HZ = np.array([0.0, 0.5, 3.0, 11.0, 35.0, 250.0])
_RATE_HZ = 500.0


@dataclass(frozen=True, slots=True)
class Check:
    """One named check; call it with an effect class. ``str`` gives the name, so ``ids=str`` works in pytest."""

    name: str
    says: str
    run: Callable[[type], None]

    def __call__(self, effect: type) -> None:
        """Raise AssertionError, with the reason, unless the effect passes."""
        self.run(effect)

    def __str__(self) -> str:
        return self.name


def as_checks(*functions: Callable[[type], None]) -> tuple[Check, ...]:
    """Functions as checks: named after themselves, saying the first line of their docstrings.

    InputError where Python runs without assert (-O).
    """
    need_asserts()
    return tuple(Check(f.__name__, (f.__doc__ or "").splitlines()[0], f) for f in functions)


def declaration_checks() -> tuple[Check, ...]:
    """The checks that need no simulation."""
    return as_checks(
        is_a_frozen_dataclass,
        says_what_it_is,
        declares_its_parameters,
        acts_without_side_effects,
        survives_the_scenario_file,
    )


def size_parameter(effect: type) -> Parameter | None:
    """The parameter that says how big the effect is: the first with a neutral value."""
    return next(iter(sizes(effect)), None)


def sizes(effect: type) -> tuple[Parameter, ...]:
    """All parameters that can each switch the effect off, or a part of it: those with a neutral value."""
    return tuple(p for p in parameters_of(effect) if p.neutral is not None)


def neutral(effect: type) -> Effect:
    """The effect switched off: every parameter that has a neutral value at it, the rest at their defaults."""
    return cast(Effect, effect(**{p.name: p.neutral for p in sizes(effect)}))


def switched_on(effect: type, **values: float) -> Effect:
    """The effect at its largest plausible size, some parameters given."""
    size = size_parameter(effect)
    on = {} if size is None else {size.name: size.high}
    return cast(Effect, effect(**(on | values)))


def table_of(effect: Effect) -> EffectTable:
    """The ``[[effect]]`` table that switches this effect on."""
    fields = dataclasses.fields(cast(Any, effect))
    return EffectTable(name=effect.name, **{f.name: getattr(effect, f.name) for f in fields if f.init})


def with_effect(scenario: Scenario, effect: Effect) -> Scenario:
    """The scenario with this one effect switched on."""
    return scenario.model_copy(update={"effect": (table_of(effect),)})


def is_a_frozen_dataclass(effect: type) -> None:
    """A frozen dataclass whose fields all have defaults, registered under its name."""
    parameters: Any = getattr(effect, "__dataclass_params__", None)
    assert parameters is not None, f"{effect.__name__} must be a dataclass: its fields are its parameters"
    assert parameters.frozen, f"{effect.__name__} must be frozen: @dataclass(frozen=True)"
    for f in dataclasses.fields(effect):
        has = f.default is not dataclasses.MISSING or f.default_factory is not dataclasses.MISSING
        assert has, f"{effect.__name__}.{f.name} must have a default: an [[effect]] table may leave it out"
        assert str(f.metadata.get("doc", "")).strip(), f"{effect.__name__}.{f.name} must say what it is (doc)"
    name = getattr(effect, "name", None)
    registered = available_effects().get(str(name))
    assert registered is effect, f"no entry point {name!r} in group vgvt.effects leads to {effect.__name__}"


def says_what_it_is(effect: type) -> None:
    """Summary, family, signature, look-alikes, separating test and reference are there, each one sentence or name."""
    for attribute in ("name", "summary", "signature", "separating_test", "reference"):
        value = getattr(effect, attribute, "")
        assert isinstance(value, str) and value.strip(), f"{effect.__name__}.{attribute} must be a text"
        assert "\n" not in value, f"{effect.__name__}.{attribute} must be one line"
    summary: str = effect.summary  # type: ignore[attr-defined]
    assert summary[0].isupper() and not summary.endswith("."), "the summary is one sentence without its full stop"
    assert ". " not in summary, f"the summary must be one sentence: {summary!r}"
    assert isinstance(getattr(effect, "family", None), Family), f"{effect.__name__}.family must be a Family"
    assert isinstance(getattr(effect, "linear", None), bool), f"{effect.__name__}.linear must be true or false"
    names = getattr(effect, "confused_with", None)
    assert isinstance(names, tuple), f"{effect.__name__}.confused_with must be a tuple of names"
    for other in names:
        assert isinstance(other, str) and other.strip(), f"confused_with holds {other!r}, not an effect's name"
        assert other != effect.name, "an effect cannot be confused with itself"  # type: ignore[attr-defined]


def declares_its_parameters(effect: type) -> None:
    """Every parameter has a unit, a plausible range, a finite default and a source; positive ones may be log-scaled."""
    defaults = effect()
    for p in parameters_of(effect):
        where = f"{effect.__name__}.{p.name}"
        assert not (said := range_fault(p)), f"{where}: {said}"
        assert math.isfinite(getattr(defaults, p.name)), f"{where}: the default must be finite"
        assert p.doc.strip() and p.source.strip(), f"{where}: doc and source must say something"
        if p.neutral is not None:
            inside = p.low < p.neutral < p.high
            assert not (p.scale == "log" and inside), f"{where}: neutral inside a logarithmic range; make it linear"
        else:
            assert p.low <= getattr(defaults, p.name) <= p.high, f"{where}: the default is not in its plausible range"


def acts_without_side_effects(effect: type) -> None:
    """The same scenario and run give the same action, and neither the scenario nor any samples are changed."""
    scenario = load_scenario("hati-unsymmetric")
    before = to_toml(scenario)
    made = switched_on(effect)
    for run in (0, 3):
        first, again = (_facts(action_of(made, scenario, run)) for _ in range(2))
        assert len(first) == len(again), f"run {run} of one scenario gives two different actions"
        for one, other in zip(first, again, strict=True):
            assert np.array_equal(one, other), f"run {run} of one scenario gives {one} and then {other}"
    assert to_toml(scenario) == before, "act() changed the scenario; return a copy"


def survives_the_scenario_file(effect: type) -> None:
    """Written into a scenario's [[effect]] table as TOML and read again, it is the same effect."""
    made = switched_on(effect)
    text = to_toml(with_effect(load_scenario("quick"), made))
    (read,) = effects_of(Scenario.model_validate(tomllib.loads(text)))
    assert read == made, f"{made} comes back from a scenario file as {read}"
    for p in parameters_of(effect):
        assert make_effect(made.name, "conformance", **{p.name: p.high}) == effect(**{p.name: p.high}), p.name


def _facts(action: Action) -> list[Any]:
    """Everything an action says, as things that can be compared; its functions by what they do to a test signal."""
    time_s = np.arange(256) / _RATE_HZ
    signal = np.sin(40 * time_s) + 0.3 * np.cos(230 * time_s)
    facts: list[Any] = [action.scenario is None or to_toml(action.scenario), *action.elements, *action.points]
    facts.append(action.warming_k)
    if action.command is not None:
        facts.append(_unchanged(signal, lambda x: action.command(x, time_s) if action.command else x))
    for change in action.channels:
        facts += [change.channels, change.stage]
        if isinstance(change, ChannelFilter):
            facts.append(change.response(_FREQUENCY_HZ))
        else:
            facts += [change.together, change.pace]
            facts.append(_unchanged(signal, lambda x, c=change: c.change(x, _RATE_HZ, np.random.default_rng(1))))
    return facts


def _unchanged(signal: np.ndarray, function: Callable[..., Any]) -> Any:
    """The function of the signal; AssertionError if it wrote into its argument."""
    given = signal.copy()
    result = np.array(function(given))
    assert np.array_equal(given, signal), "a change of command or channel wrote into its input; work on a copy"
    assert result.shape == signal.shape, f"{signal.shape} samples went in, {result.shape} came out"
    return result
