"""Where a calibration may have stopped on the wrong side of a resonance: looked at from there, score by score.

A mode of a fin that is stiff by one deviation looks, to a model whose fin is soft, like no mode at all: between the two
lies a hump, and no descent crosses it. Misfit that forgives shows the other valley from the first, where a fit to the
end would have to be made from every place to find it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.fitting.misfit import coarse_sigma, data_misfit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.problem import Problem

Array = NDArray[np.float64]

_GRID = np.linspace(-2.5, 2.5, 21)
# As FAR begins: what is no better by that is not gone down to.
_COARSE = 0.15
# Of the misfit here: how low the other side is with nothing else moved, and how high the hump between is at least.
_LOW, _HUMP = 1.1, 1.002
_MOST = 3


@dataclass(frozen=True, slots=True)
class Valley:
    """One unknown by its index, and the ``score`` where a way down begins; ``misfit`` there is a share of that here."""

    index: int
    score: float
    misfit: float


def other_valleys(
    problem: Problem, u: Array, progress: Callable[[float, str], None] | None = None
) -> tuple[Valley, ...]:
    """Valleys across a hump from scores u (problem.size,), where what peaks miss is about as little: lowest first.

    Each unknown of the aircraft by itself, the others as they are, by what is linear in the matrices. Three at most.
    """
    here = anchor(problem, u)
    sigma = coarse_sigma(problem, _COARSE)
    nothing = np.zeros(0)

    def misfit(trial: Array) -> float:
        try:
            predicted = here.predict(trial, nothing, ended=False)
        except NoStructureError:
            return np.inf
        missed = data_misfit(problem, predicted, sigma)
        return float(missed @ missed + trial @ trial)

    before, found = misfit(u), list[Valley]()
    for k in range(len(problem.unknowns)):
        if progress is not None:
            progress(k / len(problem.unknowns), "look for other valleys")
        trials = np.tile(u, (_GRID.size, 1))
        trials[:, k] = _GRID
        known = np.array([misfit(trial) for trial in trials]) / before
        found += [Valley(k, float(_GRID[i]), float(known[i])) for i in _across(known, float(u[k]))]
    return tuple(sorted(found, key=lambda valley: valley.misfit)[:_MOST])


def _across(known: Array, score: float) -> list[int]:
    """Indices of the grid where its misfit ``known`` (21,) is least of its surroundings, behind a hump from a score."""
    padded = np.concatenate([[np.inf], known, [np.inf]])
    least = np.flatnonzero((known < padded[:-2]) & (known < padded[2:]) & (known < _LOW))
    found = []
    for i in least:
        low, high = sorted((float(_GRID[i]), score))
        hump = float(known[(low <= _GRID) & (high >= _GRID)].max(initial=1.0))
        if hump > _HUMP * max(1.0, float(known[i])):
            found.append(int(i))
    return found
