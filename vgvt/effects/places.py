"""Are the places of a scenario's effects on its aircraft? An effect itself takes the nearest part, however far."""

from __future__ import annotations

from vgvt.data import InputError
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
