"""The unknowns move along with an effect of some size: by steps of a stand's tangent, each response computed anew."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.fitting.misfit import data_misfit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import Anchor

Array = NDArray[np.float64]

_STEPS = 8
_LONGEST = 20.0  # at once, as far as the linearised matrices carry


@dataclass(frozen=True, slots=True, eq=False)
class Reached:
    """What is left when the unknowns have followed: ``cost``, a square sum of ``misfit`` (2 N,) and of scores."""

    cost: float
    misfit: Array
    scores: Array


@dataclass(frozen=True, slots=True, eq=False)
class Follower:
    """Where the unknowns of a fit go beside something else, by the ``inverse`` (scores, scores) of its normal matrix.

    The cost is of the misfit and of scores as they differ from ``centre`` (scores,).
    """

    fit: Fit
    inverse: Array
    centre: Array

    @classmethod
    def towards_data(cls, fit: Fit, inverse: Array) -> Follower:
        """Towards what was measured and stated."""
        return cls(fit, inverse, np.zeros(fit.scores.size))

    @classmethod
    def back(cls, fit: Fit, inverse: Array) -> Follower:
        """Back to what the fit itself foretells, noise left out: what stays is what an effect shows."""
        measured = replace(fit.problem.measured, values=fit.predicted)
        still = replace(fit, problem=replace(fit.problem, measured=measured))
        return cls(still, inverse, fit.scores)

    def at(self, tangent: Array, u: Array) -> Follower:
        """The same by a tangent (2 N, scores) that was taken at unknowns u, with the effect."""
        normal = tangent.T @ tangent + np.eye(tangent.shape[1])
        return replace(
            self,
            fit=replace(self.fit, u=u, tangent=tangent),
            inverse=np.asarray(np.linalg.inv(normal), dtype=np.float64),
        )

    def follow(self, here: Anchor, along: Callable[[], Array | None]) -> Reached | None:
        """From the fit's scores, at an anchor with the effect; None where there is no response.

        ``along`` tells what the effect does to the misfit (2 N,) by its slopes, None where these are not known.
        """
        null, scores = self.fit, self.fit.scores
        best = self._at(here, scores)
        if not np.isfinite(best.cost):
            return None
        # Where the unknowns had stood in for the effect, they give way by as much as its slope says, at once: at its
        # size and with them where they were, the response is too far off for its own misfit to lead anywhere.
        change = along()
        if change is not None:
            there = self._at(here, self._moved(scores, -self.inverse @ (null.tangent.T @ change)))
            best = there if there.cost < best.cost else best
        return self._stepped(here, best)

    def follow_on(self, here: Anchor, scores: Array) -> Reached | None:
        """From scores that it has reached, at an anchor there; None where there is no response."""
        start = self._at(here, scores)
        return self._stepped(here, start) if np.isfinite(start.cost) else None

    def _stepped(self, here: Anchor, best: Reached) -> Reached:
        share = 1.0
        for _ in range(_STEPS):
            scores = best.scores
            move = -self.inverse @ (self.fit.tangent.T @ best.misfit + scores - self.centre)
            move *= share * min(1.0, _LONGEST / max(float(np.abs(move).max()), 1e-300))
            there = self._at(here, self._moved(scores, move))
            if there.cost >= best.cost:
                share /= 3
                continue
            done = best.cost - there.cost < 1e-3 * there.cost
            best, share = there, min(1.0, 2 * share)
            if done:
                break
        return best

    def _moved(self, scores: Array, move: Array) -> Array:
        """Scores after a step of the tangent, which is linear in amounts."""
        there = scores + move
        for k, unknown in enumerate(self.fit.problem.unknowns):
            there[k] = unknown.moved(float(scores[k]), float(move[k]), float(self.fit.u[k]))
        return there

    def _at(self, here: Anchor, scores: Array) -> Reached:
        """The cost at some scores, infinite where there is no response."""
        count = self.fit.u.size
        try:
            predicted = here.predict(scores[:count], scores[count:])
        except NoStructureError:
            return Reached(np.inf, np.zeros(self.fit.points), scores)
        misfit = data_misfit(self.fit.problem, predicted, self.fit.sigma)
        apart = scores - self.centre
        with np.errstate(over="ignore"):  # infinitely bad is no worse
            return Reached(float(misfit @ misfit + apart @ apart), misfit, scores)
