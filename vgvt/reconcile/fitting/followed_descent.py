"""The last steps of a fit beside a joint that slips: along a valley as narrow as resonances are sharp, and bent.

Scores that data tell and scores that only priors hold differ by some ten thousand in slope, so that a tangent that is
wrong by per cents leads up the valley's side. Every step has its own: of the matrices and of what joints show, both
taken where it begins. What a step bends away from its tangent is probed on either side, which is two predictions where
slopes are one for each unknown, and is turned with (geodesic acceleration): a valley is then followed several times as
far at once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.fitting.descent import NOTHING, Slopes, arrived, moved
from vgvt.reconcile.fitting.misfit import data_misfit
from vgvt.reconcile.prediction.grouping import Group, NoStructureError
from vgvt.reconcile.prediction.level_following import Following
from vgvt.reconcile.prediction.local_slopes import Origin
from vgvt.reconcile.prediction.surrogate import Anchor, anchor

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# Share of a step at which its bend is probed: far above what time steps of a march make jump. And the longest turn, as
# a share of the step: beyond, its bend is not the whole story.
_PROBE, _TURN = 0.1, 1.5
# Of what a step promised, what it keeps where the next may be much freer, freer, and where it is held back more.
_KEEPS_MOST, _KEEPS, _KEEPS_LITTLE = 0.75, 0.5, 0.25
_MUCH_FREER, _FREER, _HELD_BACK, _REFUSED = 0.1, 0.3, 2.0, 5.0
# Least damping of a step after one that was refused, and steps refused before none is found: after some in a row ever
# more is held back, as slopes that peaks give to data without noise are steeper than those of priors by up to 1e5.
_HELD, _REFUSALS, _IN_A_ROW = 1e-2, 12, 4


@dataclass(frozen=True, slots=True, eq=False)
class _Place:
    """Scores u and e, what is predicted there (C, L), its misfit (2 N,), the cost and the structures."""

    u: Array
    e: Array
    predicted: ComplexArray
    misfit: Array
    cost: float
    groups: tuple[Group, ...]


def followed_down(
    here: Anchor, u: Array, e: Array, most: int, progress: Callable[[float, str], None] | None = None
) -> tuple[Array, Array, Anchor, ComplexArray, bool]:
    """Where at most ``most`` steps lead from u (problem.size,) and e with slopes that follow what joints show.

    Scores, an anchor there with slopes of there, the prediction (C, L), and whether it is the bottom: not where slopes
    of there lead down, but no step does.
    """
    here.structures.follows = Following()
    place, damping, idle = _place(here, u, e), 1.0, 0
    if place is None:
        raise NoStructureError("no such structure")
    for k in range(most + 1):
        here = _anchored(here, place)
        slopes = Slopes.of(here, place.u, place.e, place.predicted, None)
        if slopes is None:
            break
        if arrived(place.misfit.size, slopes.promised_freely, place.cost):
            return place.u, place.e, here, place.predicted, True
        if progress is not None:
            progress(min(k + 1, most) / most, "fit")
        # Two steps that gain nothing: what is left of a promise is as rough as time steps make it.
        step = _taken(here, place, slopes, damping) if k < most and idle < 2 else None
        if step is None:
            break
        idle = idle + 1 if place.cost - step[0].cost < NOTHING * place.cost else 0
        place, damping = step
    return place.u, place.e, here, place.predicted, False


def _taken(here: Anchor, place: _Place, slopes: Slopes, damping: float) -> tuple[_Place, float] | None:
    """Where a step leads that is held back until it leads down, and the next one's damping; None where none does."""
    for k in range(_REFUSALS):
        move = slopes.move(damping)
        turned = _turned(here, place, slopes, move, damping)
        there = None if turned is None else _beside(here, place, turned)
        if there is not None and there.cost < place.cost:
            kept = (place.cost - there.cost) / slopes.promised(move)
            if kept > _KEEPS:
                damping *= _MUCH_FREER if kept > _KEEPS_MOST else _FREER
            elif kept < _KEEPS_LITTLE:
                damping *= _HELD_BACK
            return there, damping
        damping = max(_REFUSED * 2.0 ** max(0, k - _IN_A_ROW) * damping, _HELD)
    return None


def _turned(here: Anchor, place: _Place, slopes: Slopes, move: Array, damping: float) -> Array | None:
    """A step (scores,) turned with the valley; None where that bends too much for it."""
    ahead, behind = (_beside(here, place, side * _PROBE * move) for side in (1, -1))
    if ahead is None or behind is None:
        return None
    bend = (ahead.misfit - 2 * place.misfit + behind.misfit) / _PROBE**2
    turn = slopes.towards(-slopes.tangent.T @ bend, damping) / 2
    return move + turn if np.linalg.norm(turn) <= _TURN / 2 * np.linalg.norm(move) else None


def _beside(here: Anchor, place: _Place, move: Array) -> _Place | None:
    """The place that a step (scores,) leads to; None where there is no such aircraft."""
    return _place(here, *moved(here.problem, here.hypotheses, place.u, place.e, move))


def _place(here: Anchor, u: Array, e: Array) -> _Place | None:
    try:
        there = anchor(here.problem, u, here.hypotheses, e, slopes=False, structures=here.structures)
        predicted = there.predict(u, e)
    except NoStructureError:
        return None
    misfit = data_misfit(here.problem, predicted)
    cost = float(misfit @ misfit + u @ u + e @ e)
    return _Place(u, e, predicted, misfit, cost, there.assembled) if np.isfinite(cost) else None


def _anchored(here: Anchor, place: _Place) -> Anchor:
    """The anchor at a place, with slopes that are taken there: of its matrices as of what its joints show."""
    known = here.structures
    assert known.follows is not None
    known.follows.forget()
    origin = Origin(place.u.copy(), place.e.copy(), known.whole)
    return anchor(here.problem, place.u, here.hypotheses, place.e, groups=place.groups, origin=origin, structures=known)
