"""Where to begin: the few scores that move peaks most, scanned on logarithmic magnitudes before anything is fitted."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.fitting.misfit import coarse_sigma, jacobian
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem

Array = NDArray[np.float64]
_SCANNED, _SWEEPS = 5, 2
_GRID = np.linspace(-2.5, 2.5, 21)
# Around what an effect's parameters are thought to be: a resonance of its own may be sharp.
_NEAR_BY = np.linspace(-0.15, 0.15, 13)


def rough_start(
    problem: Problem, hypotheses: tuple[Hypothesis, ...] = (), e: Array | None = None
) -> tuple[Array, Array]:
    """Scores u (problem.size,) and e from which peaks overlap: line searches along the scores that matter most.

    ``e`` are roughly those of the hypotheses.
    """
    u, found, _ = nearest(problem, hypotheses, e)
    return u, found


def nearest(
    problem: Problem, hypotheses: tuple[Hypothesis, ...] = (), e: Array | None = None
) -> tuple[Array, Array, float]:
    """:func:`rough_start`, and the distance that it leaves.

    That is the mean square of log|model / data|, which has no local minimum at every pair of peaks, plus the prior's
    share of it.
    """
    u, e = np.zeros(problem.size), np.zeros(0) if e is None else e.copy()
    here = anchor(problem, u, hypotheses, e)
    strength = np.linalg.norm(jacobian(here, u, e, here.predict(u, e), coarse_sigma(problem, 0.6)), axis=0)
    strongest = np.argsort(-strength[: len(problem.unknowns)])[:_SCANNED]
    scores = np.concatenate([u, e])

    def distance(trial: Array) -> float:
        predicted = here.predict(trial[: u.size], trial[u.size :], ended=False)
        return log_distance(problem, predicted) + 0.005 * float(trial @ trial)

    searched = [(u.size + k, e[k] + _NEAR_BY) for k in range(e.size)] + [(int(k), _GRID) for k in strongest]
    best = distance(scores)
    for _ in range(_SWEEPS):
        for k, grid in searched:
            trials = []
            for value in grid:
                trial = scores.copy()
                trial[k] = value
                trials.append((distance(trial), float(value)))
            lowest, value = min(trials)
            if lowest < best:
                best, scores[k] = lowest, value
    return scores[: u.size], scores[u.size :], best


def log_distance(problem: Problem, predicted: NDArray[np.complex128]) -> float:
    """Mean square of log|model/data| over the channels to fit, of a prediction (C, L)."""
    keep = problem.split.train
    return float(np.mean(np.log(np.abs(predicted[keep] / problem.measured.values[keep])) ** 2))
