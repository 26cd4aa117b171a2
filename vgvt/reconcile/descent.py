"""One accepted step of a fit, by Levenberg and Marquardt, that finds its way along narrow, bent valleys."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from vgvt.reconcile.grouping import NoStructureError
from vgvt.reconcile.misfit import data_misfit, jacobian
from vgvt.reconcile.surrogate import Anchor, anchor

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Scores = tuple[Array, Array]

# Standard deviations at once: from where scores are tens of them away, a share of that.
_LONGEST_STEP, _LONGEST_SHARE = 1.5, 0.2
_REJECTIONS = 5
# Of a step that led too far.
_SHORTER = 0.3
# How often a step that climbed is taken back towards the floor, how much further up the first time may lead, and what
# each later time must leave at most of what it found: a way back that is as long as that is found sooner by a shorter
# step.
_CORRECTIONS, _WORSE, _CONTRACTING = 4, 2.0, 0.7


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """Where a step has arrived: scores, the anchor and the prediction (C, L) there, and the damping to go on with.

    ``gain`` is what it took off the cost and ``promised`` what a free step promised to, as shares of the cost.
    """

    u: Array
    e: Array
    here: Anchor
    predicted: ComplexArray
    damping: float
    gain: float
    promised: float


@dataclass(frozen=True, slots=True, eq=False)
class _Slopes:
    """Derivatives (2 N, scores) of the misfit at a point, their normal matrix with the priors', the longest step."""

    here: Anchor
    tangent: Array
    normal: Array
    longest: float

    def step(self, u: Array, e: Array, misfit: Array, damping: float, share: float = 1.0) -> Scores:
        """Scores after a ``share`` of a damped Gauss-Newton step from u and e, where the misfit (2 N,) is."""
        gradient = self.tangent.T @ misfit + np.concatenate([u, e])
        # Scores are in units of their priors: damping by the identity spares the well-determined directions.
        move = -solved(self.normal + damping * np.eye(gradient.size), gradient)
        return _moved(self.here, u, e, share * move * min(1.0, self.longest / max(np.abs(move).max(), 1e-300)))


def taken(
    here: Anchor, u: Array, e: Array, predicted: ComplexArray, sigma: Array, damping: float, rough: bool
) -> Step | None:
    """One accepted step from u and e with the slopes of ``here``, or None where none is found.

    ``predicted`` (C, L) is the prediction there, ``sigma`` (fitted channels, L) what it is judged by; ``rough`` keeps
    the slopes of the stated values.
    """
    misfit = data_misfit(here.problem, predicted, sigma)
    tangent = jacobian(here, u, e, predicted, sigma)
    if not np.isfinite(tangent).all():
        # Beside a joint whose march runs away.
        return None
    scores = np.concatenate([u, e])
    cost = float(misfit @ misfit + scores @ scores)
    normal = tangent.T @ tangent + np.eye(scores.size)
    gradient = tangent.T @ misfit + scores
    promised = float(gradient @ solved(normal, gradient)) / cost
    slopes = _Slopes(here, tangent, normal, max(_LONGEST_STEP, _LONGEST_SHARE * float(np.abs(scores).max())))
    for _ in range(_REJECTIONS):
        # A way back is the shorter, the freer the steps are that lead it.
        back = partial(slopes.step, damping=min(damping, 1.0))
        reached = _downhill(here, slopes.step(u, e, misfit, damping), sigma, cost, back)
        if reached is None:
            # Along the floor a valley may only be followed for a part of the way, where more damping leads up its side.
            reached = _downhill(here, slopes.step(u, e, misfit, damping, _SHORTER), sigma, cost)
        if reached is not None:
            new_u, new_e, there, trial, new_cost = reached
            there = anchor(
                here.problem, new_u, here.hypotheses, new_e, groups=there.assembled, origin=here.origin, rough=rough,
                structures=here.structures,
            )  # fmt: skip
            return Step(new_u, new_e, there, trial, damping / 10, (cost - new_cost) / cost, promised)
        damping = max(10 * damping, 1.0)
    return None


def _downhill(
    here: Anchor,
    start: Scores,
    sigma: Array,
    cost: float,
    back: Callable[[Array, Array, Array], Scores] | None = None,
) -> tuple[Array, Array, Anchor, ComplexArray, float] | None:
    """Where a step arrives below ``cost``: at its end, or ``back`` from there on the floor of the valley; or None.

    A valley that is narrow and bent throws a straight step far up its side: the same slopes lead from there back to
    its floor (simplified Newton), further along it than any step that is short enough to stay inside.
    """
    (u, e), first, last = start, np.inf, np.inf
    for k in range(_CORRECTIONS + 1):
        try:
            there = anchor(here.problem, u, here.hypotheses, e, slopes=False, structures=here.structures)
            trial = there.predict(u, e)
        except NoStructureError:
            return None
        misfit = data_misfit(here.problem, trial, sigma)
        reached = float(misfit @ misfit + u @ u + e @ e)
        if reached < cost:
            return u, e, there, trial, reached
        first = reached if k == 0 else first
        if back is None or not reached < _WORSE * first or (k > 1 and reached > _CONTRACTING * last):
            return None
        last = reached
        u, e = back(u, e, misfit)
    return None


def solved(normal: Array, right: Array) -> Array:
    """Solution (n,) of a symmetric positive definite system (n, n), however different the sizes of its rows.

    Cholesky's factors do not mind scaling, where a condition number would warn of it.
    """
    try:
        return np.asarray(scipy.linalg.cho_solve(scipy.linalg.cho_factor(normal), right), dtype=np.float64)
    except np.linalg.LinAlgError:
        # Slopes so steep that the priors are lost in round-off: the shortest of all solutions.
        return np.asarray(np.linalg.lstsq(normal, right, rcond=None)[0], dtype=np.float64)


def _moved(here: Anchor, u: Array, e: Array, move: Array) -> Scores:
    """Scores after a step that is straight in amounts, as the valley is where an effect and an unknown trade places."""
    new_u, new_e = u + move[: u.size], e + move[u.size :]
    for k, unknown in enumerate(here.problem.unknowns):
        new_u[k] = unknown.moved(float(u[k]), float(move[k]), float(u[k]))
    start = 0
    for hypothesis in here.hypotheses:
        stop = start + len(hypothesis.parameters)
        new_e[start:stop] = hypothesis.moved(e[start:stop], move[u.size + start : u.size + stop])
        start = stop
    return new_u, new_e
