"""Do a scenario's effects mean a place on its aircraft, and runs and sensors that its test has?

An effect is told of neither before it acts: who is given a scenario asks, before any time is spent on it.
"""

from __future__ import annotations

from vgvt.data import InputError
from vgvt.effects.acting import acted
from vgvt.effects.protocol import Effect
from vgvt.effects.registry import effects_of
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

    That is one that begins after the last of them, which would be simulated as nothing, and one that refuses to act: on
    a sensor that no run has, or on the shaker of a hammer test. Not asked where a campaign brings its own runs, nor
    where effects are fitted: procedures may repeat fewer runs.
    """
    runs, effects = len(scenario.acquisition.run_nodes), effects_of(scenario)
    for i, effect in enumerate(effects):
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


def _begins_in(effect: Effect) -> int | None:
    """The run, counted from 1, that a change between runs begins with; None for one that has no such run."""
    if getattr(effect, "shape", "step") != "step":
        return None
    first = getattr(effect, "from_run", None)
    return first if isinstance(first, int) else None
