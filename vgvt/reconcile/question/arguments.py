"""Are the arguments of a call what they should be? Said at once, with what to write, and not after minutes."""

from __future__ import annotations

from collections.abc import Mapping
from numbers import Integral, Real

import numpy as np

from vgvt.data import Campaign, InputError
from vgvt.reconcile.question.suitable import FEWEST_LINES
from vgvt.scenario.model import Scenario


def check_campaign(campaign: object) -> None:
    """InputError unless it is a campaign."""
    if isinstance(campaign, Campaign):
        return
    advice = "give what vgvt.files.open_campaign or vgvt.simulation.simulated_campaign returns"
    if isinstance(campaign, Scenario):
        advice = "write the campaign first and the scenario second"
    raise InputError("campaign", f"is {_shown(campaign)} and no Campaign", advice)


def check_scenario(scenario: object) -> None:
    """InputError unless it is a scenario: a name or a path is none until it is loaded."""
    if isinstance(scenario, Scenario):
        return
    advice = "give what vgvt.scenario.load_scenario returns"
    if isinstance(scenario, str):
        advice = f"write vgvt.scenario.load_scenario({scenario!r})"
    elif isinstance(scenario, Campaign):
        advice = "write the campaign first and the scenario second"
    raise InputError("scenario", f"is {_shown(scenario)} and no Scenario", advice)


def check_lines(lines: object) -> None:
    """InputError unless it is a whole number of lines that a response can be judged by."""
    # True is a whole number to Python, and here a slip.
    if isinstance(lines, bool) or not isinstance(lines, Integral) or int(lines) < FEWEST_LINES:
        raise InputError(
            "lines",
            f"is {_shown(lines)}, and a whole number of at least {FEWEST_LINES} is needed",
            "write about how many lines of each response to use: 500 are usual",
        )


def floor_for(scenario: Scenario, floor: float | None) -> float:
    """The relative model-form error to judge by: what was asked for, or what the scenario's tolerances say."""
    if floor is None:
        floor = scenario.tolerances.model_form
        check_floor(floor, f"scenario {scenario.name}: tolerances.model_form")
    return floor


def check_floor(floor: object, where: str = "floor") -> None:
    """InputError, naming ``where``, unless it is a relative error: a negative one would be squared, and count."""
    if isinstance(floor, bool) or not isinstance(floor, Real) or not 0 <= float(floor) <= 1:
        raise InputError(
            where,
            f"is {_shown(floor)}, and a relative model-form error from 0 to 1 is needed",
            "write a fraction of A/F, like 0.004 for 0.4 %, or leave it out",
        )


def check_effects(effects: object) -> None:
    """InputError unless it maps names of effects to classes of these names."""
    if not isinstance(effects, Mapping):
        raise InputError(
            "effects",
            f"is {_shown(effects)}, and a mapping of names to effect classes is needed",
            "write {name: available_effects()[name] for name in (…)}, or leave it out for all that are installed",
        )
    for name, cls in effects.items():
        where = f"effects[{name!r}]"
        if not isinstance(cls, type):
            raise InputError(
                where,
                f"is {_shown(cls)} and no class of an effect",
                "give the class, like available_effects()['added-mass']: its parameters are fitted",
            )
        own = getattr(cls, "name", None)
        if not isinstance(own, str):
            raise InputError(where, f"is {cls.__name__}, which is no effect: it has no name", "give an effect's class")
        if own != name:
            # Under another name it would escape what is asked by name: what the scenario has, what is a gain.
            raise InputError(where, f"is the effect {own!r}", f"write it as {{{own!r}: {cls.__name__}}}")


def starting_scores(start: object, size: int) -> np.ndarray:
    """The scores (size,) to start from; ValueError for any other number of them."""
    scores = np.asarray(start, dtype=np.float64)
    if scores.shape != (size,):
        raise ValueError(
            f"start is an array of shape {scores.shape}, and this problem has {size} scores: give the u of a fit of "
            "it, numpy.zeros(problem.size) for the values as stated, or leave it out"
        )
    return scores


def _shown(value: object) -> str:
    """A number or a text as it is, anything else by its type."""
    if value is None or isinstance(value, bool | Real | str):
        return repr(value) if isinstance(value, str) else str(value)
    name = value.__name__ if isinstance(value, type) else type(value).__name__
    return f"the class {name}" if isinstance(value, type) else f"{'an' if name[0] in 'AEIOUaeiou' else 'a'} {name}"
