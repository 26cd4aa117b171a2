"""Could there be such a thing? A name for what is off the aircraft, or swings where nothing like it does, is none.

Data outweigh any prior: where the right effect is not in the catalogue, another one is bent until it does the same. A
gram half a metre behind the aircraft is an inertia, an absorber far above the band a mass.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.parameter import Parameter
from vgvt.reconcile.evidence.posterior import honest
from vgvt.scenario.airframe import Airframe
from vgvt.scenario.placement import LEAST_BOX_MARGIN_M, aircraft_box_m, place_problem
from vgvt.scenario.planform import part_at

if TYPE_CHECKING:
    from vgvt.reconcile.evidence.rivals import Rival
    from vgvt.reconcile.fitting.fit import Fit

AXES = {f"{prefix}{axis}_m": k for prefix in ("", "other_") for k, axis in enumerate("xy")}
"""What effects call their places, with the axis (0 aft, 1 right)."""
# The plausible range of a frequency ends at a score of two. Data that say little of it leave it well within.
_BEYOND = 3.0
PLACES = (("x_m", "y_m"), ("other_x_m", "other_y_m"))
# For half a place, of the aircraft's side in its direction: what surfaces and brackets reach beyond its box.
_OFF = 0.25
# Standard deviations by which something is surely beyond, and steps to either side in which a place is looked for.
_SURE, _STEPS = 2.0, 4


def implausible(fit: Fit, index: int = -1) -> tuple[str, ...]:
    """What of a hypothesis of a fit cannot be, in words; empty where nothing is of that kind.

    Places that are surely where a scenario may not state them; frequencies, and a place along one axis alone, where
    they lie surely beyond what is plausible, by the catalogue and the aircraft's box. How much there is of a thing, how
    stiff or how damped it is, is for the data to say.
    """
    index %= len(fit.hypotheses)
    hypothesis, airframe = fit.hypotheses[index], fit.problem.scenario.airframe
    parameters = hypothesis.parameters
    start = fit.u.size + sum(len(h.parameters) for h in fit.hypotheses[:index])
    scores, values = np.abs(fit.scores[start : start + len(parameters)]), fit.values(index)
    stated = dict(hypothesis.settings) | {name: value[0] for name, value in values.items()}
    whole = [pair for pair in PLACES if set(pair) <= set(stated) and not set(pair).isdisjoint(values)]
    lost = [pair for pair in whole if placed(fit, index, pair) is None]
    nowhere = tuple(_nowhere(airframe, pair, [stated[name] for name in pair]) for pair in lost)
    told = {name for pair in whole for name in pair}
    sides = {p.name: on_the_aircraft(airframe, p.name) for p in parameters if p.name in AXES and p.name not in told}
    off = {name: max(low - values[name][0], values[name][0] - high) for name, (low, high) in sides.items()}
    far = {p.name for p, score in zip(parameters, scores, strict=True) if p.unit == "Hz" and score > _BEYOND}
    asked = [p for p in parameters if off.get(p.name, 0.0) > 0 or (p.name in far and p.neutral is None)]
    if not asked:
        return nowhere
    wide = honest(fit).values(index)
    return nowhere + tuple(
        _words(p, values[p.name][0], *sides.get(p.name, (p.low, p.high)))
        for p in asked
        if off.get(p.name, np.inf) > _SURE * wide[p.name][1]
    )


def placed(fit: Fit, index: int, names: tuple[str, str]) -> tuple[float, float] | None:
    """Where a scenario may state a place (x, y) of a hypothesis of a fit: there, or where it is likeliest of what may.

    That is within two standard deviations, or nowhere: then None.
    """
    airframe, settings = fit.problem.scenario.airframe, fit.hypotheses[index].settings
    stated = {**settings, **{name: value[0] for name, value in fit.values(index).items()}}
    point = np.array([float(stated[name]) for name in names])
    if place_problem(airframe, names, "", point.tolist()) is None:
        return float(point[0]), float(point[1])
    wide = honest(fit).values(index)
    sd = np.array([wide[name][1] if name in wide else 0.0 for name in names])
    steps = np.linspace(-_SURE, _SURE, 2 * _STEPS + 1)
    for off in sorted(itertools.product(steps, steps), key=lambda off: off[0] ** 2 + off[1] ** 2):
        x, y = (point + off * sd).tolist()
        if place_problem(airframe, names, "", (x, y)) is None:
            return x, y
    return None


def _nowhere(airframe: Airframe, names: tuple[str, str], point: Sequence[float]) -> str:
    """That there can be nothing at a point (x, y), in words."""
    place = " and ".join(f"{name} of {value:.3g} m" for name, value in zip(names, point, strict=True))
    return f"{place}, farther from {part_at(airframe, point)!r}, the nearest part, than a scenario may say"


def on_the_aircraft(airframe: Airframe, name: str) -> tuple[float, float]:
    """From where to where a place by its parameter's name is on an aircraft, or near it, in m."""
    low, high = aircraft_box_m(airframe)[:, AXES[name]]
    margin = max(_OFF * (high - low), LEAST_BOX_MARGIN_M)
    return float(low - margin), float(high + margin)


def reach(parameters: Sequence[Parameter], box_m: NDArray[np.float64]) -> dict[str, tuple[float, float]]:
    """Ranges of an effect's places that hold the whole aircraft, by parameter; ``box_m`` is (2, 3), its corners."""
    return {
        p.name: (min(p.low, float(box_m[0, AXES[p.name]])), max(p.high, float(box_m[1, AXES[p.name]])))
        for p in parameters
        if p.name in AXES
    }


def likelier(confirmed: Sequence[Rival], equal: Sequence[Rival]) -> list[Rival]:
    """Rivals without those that are no plausible thing, where a plausible one is among the ``equal`` of the best."""
    kept = [r for r in confirmed if not implausible(r.fit)]
    return kept if any(r is e for r in kept for e in equal) else list(confirmed)


def _words(p: Parameter, value: float, low: float, high: float) -> str:
    unit = f" {p.unit}" if p.unit else ""
    return f"{p.name} of {value:.3g}{unit}, where {low:.3g} to {high:.3g}{unit} is plausible"
