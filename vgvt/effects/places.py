"""Do a scenario's effects mean a place on its aircraft, and a run that it has? An effect itself asks for neither."""

from __future__ import annotations

from vgvt.data import InputError
from vgvt.effects.protocol import Effect
from vgvt.effects.registry import effects_of
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
    """InputError for an effect that begins after the scenario's last run: it would be simulated as nothing.

    Not asked where a campaign brings its own runs, nor where effects are fitted: procedures may repeat fewer runs.
    """
    runs = len(scenario.acquisition.run_nodes)
    for i, effect in enumerate(effects_of(scenario)):
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


def _begins_in(effect: Effect) -> int | None:
    """The run, counted from 1, that a change between runs begins with; None for one that has no such run."""
    if getattr(effect, "shape", "step") != "step":
        return None
    first = getattr(effect, "from_run", None)
    return first if isinstance(first, int) else None
