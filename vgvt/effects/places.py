"""Do a scenario's effects mean a place on its aircraft, and runs and sensors that its test has?

An effect is told of neither before it acts: who is given a scenario asks, before any time is spent on it.
"""

from __future__ import annotations

from vgvt.data import InputError
from vgvt.data.plugin import is_bundled
from vgvt.effects.acting import acted
from vgvt.effects.protocol import Effect, Family
from vgvt.effects.registry import effects_of
from vgvt.effects.sensor_choice import DRIVE, chosen_channels
from vgvt.effects.under_a_hammer import act_on
from vgvt.scenario.model import Scenario
from vgvt.scenario.placement import place_problem

_PLACES = (("x_m", "y_m"), ("other_x_m", "other_y_m"))


def require_on_aircraft(scenario: Scenario) -> None:
    """InputError, with the distance and the nearest part, for an effect that is farther than a chord off the aircraft.

    Not asked where effects are fitted: a search may look at places that no scenario should state.
    """
    for i, effect in enumerate(effects_of(scenario)):
        for names in _PLACES:
            if not all(hasattr(effect, name) for name in names):
                continue
            point = tuple(float(getattr(effect, name)) for name in names)
            problem = place_problem(scenario.airframe, ("effect", i, names[0]), f"effect {effect.name}", point)
            if problem is not None:
                where = f"scenario {scenario.name}: effect[{i}].{names[0]}"
                raise InputError(where, problem.text, problem.advice)


def require_in_the_runs(scenario: Scenario) -> None:
    """InputError for an effect that the scenario's runs cannot have.

    That is one that would be simulated as nothing: it begins after the last of them, goes on from run to run where
    there is one, or is on channels that none of them has. And one that refuses to act: on the shaker of a hammer test,
    say. Not asked where a campaign brings its own runs, nor where effects are fitted: procedures may repeat fewer runs.
    """
    runs, effects = len(scenario.acquisition.run_nodes), effects_of(scenario)
    for i, effect in enumerate(effects):
        if runs == 1 and effect.family is Family.BETWEEN_RUNS and getattr(effect, "shape", "step") != "step":
            raise InputError(
                f"scenario {scenario.name}: effect[{i}].shape",
                f"{effect.name} goes on from the first run to the last, and there is 1 run",
                "Give acquisition.runs or acquisition.repeats more of them, or leave the effect out.",
            )
        first = _begins_in(effect)
        if first is None or first <= runs:
            continue
        raise InputError(
            f"scenario {scenario.name}: effect[{i}].from_run",
            f"{effect.name}: from_run = {first}, but there {'is 1 run' if runs == 1 else f'are {runs} runs'}",
            f"Write {'2' if runs == 2 else f'2 to {runs}'}, or give acquisition.runs more runs."
            if runs > 1
            else "Give acquisition.runs more runs, or leave the effect out.",
        )
    for run in range(runs):
        acted(effects, scenario, run, act_on)
    for i, effect in enumerate(effects):
        _require_channels(scenario, i, effect)


def _begins_in(effect: Effect) -> int | None:
    """The run, counted from 1, that a change between runs begins with; None for one that has no such run."""
    if getattr(effect, "shape", "step") != "step":
        return None
    first = getattr(effect, "from_run", None)
    return first if isinstance(first, int) else None


def _require_channels(scenario: Scenario, i: int, effect: Effect) -> None:
    """InputError where effect ``i`` of a scenario is on sensors or channels that none of its runs has."""
    if not is_bundled(type(effect).__module__):
        return  # what words mean to it, it says itself
    runs = scenario.acquisition.run_nodes
    for key in ("channels", "sensors"):
        choice: str = getattr(effect, key, "")
        driven = choice != DRIVE or scenario.excitation.kind != "impact"
        if choice and not (driven and any(chosen_channels(scenario, r, choice, effect.name) for r in range(len(runs)))):
            raise _on_nothing(scenario, f"effect[{i}].{key}", effect, f"{choice!r}")
    keys = [key for key in ("node", "other_node") if getattr(effect, key, 0)]
    measured = {node for nodes in runs for node in nodes}
    if keys and measured.isdisjoint(getattr(effect, key) for key in keys):
        nodes = " or ".join(str(getattr(effect, key)) for key in keys)
        raise _on_nothing(scenario, f"effect[{i}].{keys[0]}", effect, f"node {nodes}")


def _on_nothing(scenario: Scenario, where: str, effect: Effect, what: str) -> InputError:
    known = ", ".join(map(str, dict.fromkeys(n for nodes in scenario.acquisition.run_nodes for n in nodes)))
    return InputError(
        f"scenario {scenario.name}: {where}",
        f"{effect.name}: no run has a channel of {what}",
        f"Choose another, or leave the effect out; nodes with a sensor are {known}.",
    )
