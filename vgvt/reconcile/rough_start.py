"""Where to begin: the few scores that move peaks most, scanned on logarithmic magnitudes before anything is fitted."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.misfit import coarse_sigma, jacobian
from vgvt.reconcile.problem import Problem
from vgvt.reconcile.surrogate import anchor

Array = NDArray[np.float64]
_SCANNED, _SWEEPS = 5, 2
_GRID = np.linspace(-2.5, 2.5, 21)


def rough_start(problem: Problem) -> Array:
    """Scores (problem.size,) from which peaks overlap: line searches along the scores that matter most.

    The distance is the mean square of log|model / data|, which has no local minimum at every pair of peaks, plus the
    prior's share of it.
    """
    none = np.zeros(0)
    u = np.zeros(problem.size)
    keep = problem.split.train
    here = anchor(problem, u)
    strength = np.linalg.norm(jacobian(here, u, none, here.predict(u, none), coarse_sigma(problem, 0.6)), axis=0)
    strongest = np.argsort(-strength[: len(problem.unknowns)])[:_SCANNED]
    size = np.log(np.abs(problem.measured.values[keep]))

    def distance(scores: Array) -> float:
        model = np.abs(here.predict(scores, none)[keep])
        return float(np.mean((np.log(model) - size) ** 2) + 0.005 * scores @ scores)

    best = distance(u)
    for _ in range(_SWEEPS):
        for k in strongest:
            trials = []
            for value in _GRID:
                trial = u.copy()
                trial[k] = value
                trials.append((distance(trial), float(value)))
            lowest, value = min(trials)
            if lowest < best:
                best, u[k] = lowest, value
    return u
