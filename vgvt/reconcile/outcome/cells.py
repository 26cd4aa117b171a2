"""How finely to cut the beams of what was found, so that its simulation errs as the fit says that the data do."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.beams import with_beams
from vgvt.reconcile.fitting.descent import moved, solved
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.fitting.misfit import data_misfit
from vgvt.reconcile.mechanics.refinement import MOST_CELLS
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.problem import CELLS
from vgvt.scenario.model import Scenario

Array = NDArray[np.float64]
# The chain as stated is at -1, where a score has no end.
_AS_STATED = 1 - 1e-6
# Two chains of nearly as many cells err by the share that 1/n² says only on average: of twelve and thirteen one has a
# mode a per cent off that the other has not, and a fit to data of twelve asks for thirteen now and then.
_NEARLY_AS_STATED = 1.25
# After the straight one: curvature is a few per cent of it.
_MORE_STEPS = 3


def with_cells(scenario: Scenario, fit: Fit) -> Scenario:
    """The scenario with as many times its cells as the fit asks for, its finest beam with 60 at most."""
    times = _times(fit)
    names = [b.name for b in scenario.airframe.beam]
    return with_beams(scenario, names, lambda b: b.model_copy(update={"cells": round(times * b.cells)}))


@lru_cache(maxsize=2)
def at_whole_cells(found: Fit) -> Fit:
    """A fit with all its other scores where they are likeliest beside the whole cells that a file of it has.

    A tenth of a cell is a per cent of a sharp peak, which stiffness, masses and gains take up at no cost: those that
    go with another number of cells must not be written beside this one. Errors and prediction stay those of the fit.
    """
    cells = found.problem.unknowns.index(CELLS)
    rate = CELLS.rate(float(found.u[cells]))
    if not found.problem.stated.airframe.beam or rate <= 0:
        return found
    there = max(-1 / _times(found) ** 2, -_AS_STATED)
    score = math.atanh(there) / CELLS.sd
    aside = (there - CELLS.amount(float(found.u[cells]))) / rate
    try:
        u, e = _likeliest(found, cells, score, aside)
    except NoStructureError:
        u, e = found.u.copy(), found.e
        u[cells] = score
    return replace(found, u=u, e=e)


def _times(fit: Fit) -> float:
    """By how many times the finest beam's cells are more than stated, a whole number of them.

    A chain of n cells errs by 1/n²: of the stated chain's error a fit finds all in data of the same chain, and next to
    none in those of an aircraft, which has no cells. What is nearly as many as stated is as many.
    """
    beams = fit.problem.stated.airframe.beam
    found = CELLS.amount(float(fit.u[fit.problem.unknowns.index(CELLS)]))
    finest = max((b.cells for b in beams), default=MOST_CELLS)
    most = max(1.0, MOST_CELLS / finest)
    times = min(most, 1 / math.sqrt(-found)) if found < 0 else most
    return 1.0 if times < _NEARLY_AS_STATED else round(times * finest) / finest


def _likeliest(found: Fit, cells: int, score: float, aside: float) -> tuple[Array, Array]:
    """Scores u and e of the least cost with that of the cells held at ``score``, which slopes see ``aside`` of its own.

    Where a fit was not at its bottom, as far from it as it was. NoStructureError where there is no such aircraft.
    """
    problem, tangent = found.problem, found.tangent
    others = np.arange(found.scores.size) != cells
    normal = tangent.T @ tangent + np.eye(others.size)
    inner = normal[np.ix_(others, others)]
    still = (tangent.T @ data_misfit(problem, found.predicted, found.sigma) + found.scores)[others]

    def reached(u: Array, e: Array) -> tuple[float, Array]:
        """Cost and the gradient (scores - 1,) of half of it, but for what the fit itself has of one."""
        u[cells] = score
        predicted = anchor(problem, u, found.hypotheses, e, slopes=False).predict(u, e)
        misfit, scores = data_misfit(problem, predicted, found.sigma), np.concatenate([u, e])
        rest = scores[others]
        cost = float(misfit @ misfit + rest @ rest - 2 * still @ rest)
        return cost if np.isfinite(cost) else np.inf, (tangent.T @ misfit + scores)[others] - still

    u, e = found.u.copy(), found.e
    best, _ = reached(u, e)
    at, gradient = (u, e), normal[others, cells] * aside
    for _ in range(1 + _MORE_STEPS):
        step = np.zeros(others.size)
        step[others] = -solved(inner, gradient)
        trial = moved(problem, found.hypotheses, *at, step)
        cost, gradient = reached(*trial)
        if cost >= best:
            break
        best, at = cost, trial
    return at
