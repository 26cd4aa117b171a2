"""One accepted step of a fit, by Levenberg and Marquardt: damped by what steps keep of their promises.

Slopes of the stated values serve until they mislead, and are then taken anew: along a narrow, bent valley one that is
wrong by a tenth leads up its side at every step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from vgvt.reconcile.fitting.misfit import data_misfit, jacobian
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.local_slopes import Origin, from_elsewhere
from vgvt.reconcile.prediction.surrogate import Anchor, anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Scores = tuple[Array, Array]

# Standard deviations at once: from where scores are tens of them away, a share of that.
_LONGEST_STEP, _LONGEST_SHARE = 1.5, 0.2
_REJECTIONS = 9
# Of what a step promised, what it keeps where the next may be freer, and where it has to be held back more: as freely
# as data that miss much let it, a step would cross the valley's floor and come back at the next, over and over.
_KEEPS_MOST, _KEEPS_LITTLE = 0.75, 0.25
_FREER, _HELD_BACK, _REFUSED = 0.2, 2.0, 4.0
# A free step that was refused: to be held back at all.
_FREE, _HELD = 1e-2, 1.0
TRUE = 0.5
"""Where a step keeps less of its promise, slopes that were taken elsewhere are taken anew."""
# What a free step promises where the bottom is reached: relative to the cost while data miss much, in nats where they
# are nearly met. A share of the cost is the more nats the more data there are.
_ENOUGH, _ENOUGH_NATS = 1e-3, 0.5
NEARLY_MET = 1.5
"""A value's share of the cost where data are nearly met."""
NOTHING = 1e-4
"""Relative to the cost: what a step gains where no step leads anywhere any more."""


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """Where a step has arrived: scores, the anchor and the prediction (C, L) there, and the damping to go on with.

    ``gain`` is what it took off the ``cost`` there was and ``promised`` what a free step promised to, as shares of it.
    """

    u: Array
    e: Array
    here: Anchor
    predicted: ComplexArray
    damping: float
    gain: float
    promised: float
    cost: float


@dataclass(frozen=True, slots=True, eq=False)
class Slopes:
    """Gradient (scores,) of half the cost where a step begins, and half its curvature as a ``tangent`` has it.

    The tangent (2 N, scores) is of the data's misfit. No step is longer than ``longest``.
    """

    tangent: Array
    gradient: Array
    normal: Array
    longest: float

    @classmethod
    def of(cls, here: Anchor, u: Array, e: Array, predicted: ComplexArray, sigma: Array | None) -> Slopes | None:
        """By the slopes of ``here``; None beside a joint whose march runs away."""
        tangent = jacobian(here, u, e, predicted, sigma)
        if not np.isfinite(tangent).all():
            return None
        scores = np.concatenate([u, e])
        gradient = tangent.T @ data_misfit(here.problem, predicted, sigma) + scores
        return cls(tangent, gradient, tangent.T @ tangent + np.eye(scores.size), longest_step(scores))

    def move(self, damping: float) -> Array:
        """A damped Gauss-Newton step (scores,)."""
        move = self.towards(-self.gradient, damping)
        return move * min(1.0, self.longest / max(float(np.abs(move).max()), 1e-300))

    def towards(self, pull: Array, damping: float) -> Array:
        """Where a ``pull`` (scores,) leads that is held back by the curvature, and by a damping."""
        # Scores are in units of their priors: damping by the identity spares the well-determined directions.
        return solved(self.normal + damping * np.eye(pull.size), pull)

    def promised(self, move: Array) -> float:
        """What a step (scores,) takes off the cost where slopes stay as they are."""
        return -float(2 * self.gradient @ move + move @ self.normal @ move)

    @property
    def promised_freely(self) -> float:
        """What a free step, however long, takes off the cost where slopes stay as they are."""
        return float(self.gradient @ solved(self.normal, self.gradient))


def taken(
    here: Anchor, u: Array, e: Array, predicted: ComplexArray, sigma: Array | None, damping: float, rough: bool
) -> Step | None:
    """One accepted step from u and e with the slopes of ``here``, or None where none is found.

    ``predicted`` (C, L) is the prediction there, ``sigma`` (fitted channels, L) what it is judged by; ``rough`` keeps
    the slopes, whatever they promise.
    """
    slopes = Slopes.of(here, u, e, predicted, sigma)
    cost = _cost(here, u, e, predicted, sigma)
    for _ in range(_REJECTIONS):
        if slopes is None:
            return None
        move = slopes.move(damping)
        reached = _reached(here, moved(here.problem, here.hypotheses, u, e, move), sigma)
        if reached is not None and reached.cost < cost:
            kept = (cost - reached.cost) / slopes.promised(move)
            damping = after_a_step(damping, kept)
            anew = not rough and kept < TRUE and misled(here, reached.u, reached.e)
            there = sloped(here, reached.here, reached.u, reached.e, anew=anew)
            gain, free = (cost - reached.cost) / cost, slopes.promised_freely / cost
            return Step(reached.u, reached.e, there, reached.predicted, damping, gain, free, cost)
        if not rough and misled(here, u, e):
            here = sloped(here, here, u, e, anew=True)
            slopes = Slopes.of(here, u, e, predicted, sigma)
        else:
            damping = after_a_refusal(damping)
    return None


def after_a_step(damping: float, kept: float) -> float:
    """The damping to go on with after a step that ``kept`` so much of what it had promised."""
    if kept > _KEEPS_MOST:
        return _FREER * damping
    return _HELD_BACK * damping if kept < _KEEPS_LITTLE else damping


def after_a_refusal(damping: float) -> float:
    """The damping to try again with after a step that took nothing off."""
    return max(_REFUSED * damping, _HELD if damping < _FREE else 0.0)


def longest_step(scores: Array) -> float:
    """How far any of these scores (n,) may move at once."""
    return max(_LONGEST_STEP, _LONGEST_SHARE * float(np.abs(scores).max(initial=0.0)))


@dataclass(frozen=True, slots=True, eq=False)
class _Reached:
    """Scores, the anchor and the prediction (C, L) there, and the cost."""

    u: Array
    e: Array
    here: Anchor
    predicted: ComplexArray
    cost: float


def _reached(here: Anchor, scores: Scores, sigma: Array | None) -> _Reached | None:
    """What is found at some scores; None where there is no such aircraft."""
    u, e = scores
    try:
        there = anchor(here.problem, u, here.hypotheses, e, slopes=False, structures=here.structures)
        trial = there.predict(u, e)
    except NoStructureError:
        return None
    left = _cost(here, u, e, trial, sigma)
    return _Reached(u, e, there, trial, left) if np.isfinite(left) else None


def _cost(here: Anchor, u: Array, e: Array, predicted: ComplexArray, sigma: Array | None) -> float:
    """Square sum of misfit and scores."""
    misfit = data_misfit(here.problem, predicted, sigma)
    return float(misfit @ misfit + u @ u + e @ e)


def misled(here: Anchor, u: Array, e: Array) -> bool:
    """Whether slopes of ``here`` may be to blame for a broken promise, and others are to be had at u and e."""
    return not here.structures.whole and from_elsewhere(here.problem, u, e, here.origin, here.hypotheses)


def sloped(here: Anchor, there: Anchor, u: Array, e: Array, *, anew: bool) -> Anchor:
    """The anchor at scores u and e, whose groups ``there`` has, with slopes from where those of ``here`` are, or new.

    Those of the stated values are kept until they mislead.
    """
    origin = Origin(u.copy(), e.copy()) if anew else here.origin
    return anchor(
        here.problem, u, here.hypotheses, e, groups=there.assembled, origin=origin,
        rough=origin is None and not here.structures.whole, structures=here.structures,
    )  # fmt: skip


def arrived(points: int, promised: float, cost: float) -> bool:
    """Whether what a free step ``promised`` to take off a cost is little, for that many points of data, 0 if coarse."""
    return promised / 2 < _ENOUGH_NATS if cost < NEARLY_MET * points else promised < _ENOUGH * cost


def solved(normal: Array, right: Array) -> Array:
    """Solution (n,) of a symmetric positive definite system (n, n), however different the sizes of its rows.

    Cholesky's factors do not mind scaling, where a condition number would warn of it.
    """
    try:
        return np.asarray(scipy.linalg.cho_solve(scipy.linalg.cho_factor(normal), right), dtype=np.float64)
    except np.linalg.LinAlgError:
        # Slopes so steep that the priors are lost in round-off: the shortest of all solutions.
        return np.asarray(np.linalg.lstsq(normal, right, rcond=None)[0], dtype=np.float64)


def moved(problem: Problem, hypotheses: Sequence[Hypothesis], u: Array, e: Array, move: Array) -> Scores:
    """Scores after a step that is straight in amounts, as the valley is where an effect and an unknown trade places.

    From u (scores of the problem,) and e (of the hypotheses,) by ``move`` (both together,).
    """
    new_u, new_e = u + move[: u.size], e + move[u.size :]
    for k, unknown in enumerate(problem.unknowns):
        new_u[k] = unknown.moved(float(u[k]), float(move[k]), float(u[k]))
    start = 0
    for hypothesis in hypotheses:
        stop = start + len(hypothesis.parameters)
        new_e[start:stop] = hypothesis.moved(e[start:stop], move[u.size + start : u.size + stop])
        start = stop
    return new_u, new_e
