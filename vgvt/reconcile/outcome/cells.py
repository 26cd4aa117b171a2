"""How finely to cut the beams of what was found, so that its simulation errs as the fit says that the data do."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.effects.beams import with_beams
from vgvt.reconcile.fitting.descent import moved, solved
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.fitting.misfit import data_misfit
from vgvt.reconcile.mechanics.refinement import MOST_CELLS, Refinement
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.problem import CELLS, Nominal, Problem
from vgvt.reconcile.question.thresholds import FAR_OFF
from vgvt.reconcile.question.uncertain import prepared
from vgvt.scenario.model import Scenario
from vgvt.simulation.reduced import Layouts, structure

Array = NDArray[np.float64]
# The chain as stated is at -1, where a score has no end.
_AS_STATED = 1 - 1e-6
# Two chains of nearly as many cells err by the share that 1/n² says only on average: of twelve and thirteen one has a
# mode a per cent off that the other has not, and a fit to data of twelve asks for thirteen now and then.
_NEARLY_AS_STATED = 1.25
# A nat, in cost.
_AS_LIKELY = 2.0
# Curvature is a few per cent of a step; what the last one gains is next to nothing.
_STEPS, _SETTLED = 6, 0.01


def with_cells(scenario: Scenario, fit: Fit) -> Scenario:
    """The scenario with as many times its cells as a fit has, of whole ones say, its finest beam with 60 at most."""
    times = _times(fit)
    names = [b.name for b in scenario.airframe.beam]
    return with_beams(scenario, names, lambda b: b.model_copy(update={"cells": round(times * b.cells)}))


@lru_cache(maxsize=2)
def at_whole_cells(found: Fit) -> Fit:
    """A fit with all its other scores where they are likeliest beside the whole cells that a file of it has.

    A tenth of a cell is a per cent of a sharp peak, which stiffness, masses and gains take up at no cost: those that
    go with another number of cells must not be written beside this one. Errors and prediction stay those of the fit.

    Halfway between the stated chain and a continuum there is no chain that errs by half in every mode. So the cells as
    stated, those that the fit asks for and as many as stand for a continuum are tried as they are, as a simulation has
    them, and of the likeliest the fewest are had.
    """
    problem = found.problem
    cells = problem.unknowns.index(CELLS)
    if not problem.stated.airframe.beam or CELLS.rate(float(found.u[cells])) <= 0:
        return found
    asked = _times(found)
    if not found.converged and found.chi2_per_dof > FAR_OFF:
        # What cells make of a fit that is on its way, and far, is nothing to what it leaves: it is written as it is.
        return replace(found, u=_with_score(found.u, cells, asked))
    # Of one that is nearly there costs compare how far it is: it has the cells that it asks for.
    choices = {1.0, asked, _most_times(found)} if found.converged else {asked}
    tried = [_beside(found, times) for times in sorted(choices)]
    least = min(cost for cost, _ in tried)
    if math.isfinite(least):
        return next(written for cost, written in tried if cost <= least + _AS_LIKELY)
    return replace(found, u=_with_score(found.u, cells, asked))


def _beside(found: Fit, times: float) -> tuple[float, Fit]:
    """The least cost beside so many times the stated cells, infinite where there is no such aircraft, and the fit."""
    cells = found.problem.unknowns.index(CELLS)
    try:
        cost, u, e = _likeliest(found, _as_they_are(found.problem, times), _amount(times))
    except (InputError, RuntimeError, np.linalg.LinAlgError):
        # Cut like that it cannot be, or does not hang; anything else is a fault of the code, and shows.
        return math.inf, found
    return cost, replace(found, u=_with_score(u, cells, times), e=e)


def _with_score(u: Array, cells: int, times: float) -> Array:
    """Scores u with that of the cells where it says so many times those that are stated."""
    out = u.copy()
    out[cells] = math.atanh(_amount(times)) / CELLS.sd
    return out


def _amount(times: float) -> float:
    """How far so many times the stated cells are from a continuum towards the chain as stated, by what they err."""
    return max(-1 / times**2, -_AS_STATED)


def _as_they_are(problem: Problem, times: float) -> Problem:
    """A problem of the stated beams cut into so many times their cells, and nothing that makes up for these.

    To be predicted with, not fitted: its slopes are those of another aircraft.
    """
    names = [b.name for b in problem.stated.airframe.beam]
    cut = with_beams(problem.stated, names, lambda b: b.model_copy(update={"cells": round(times * b.cells)}))
    start = prepared(cut)
    layouts = Layouts.of(start)
    layout = layouts.plan(start)
    own = structure(layout, layout.grid)
    none = Refinement.none(own)
    return replace(problem, scenario=cut, start=Nominal(start, layouts, own), refinement=none, coarseness=none)


def _times(fit: Fit) -> float:
    """By how many times the finest beam's cells are more than stated by a fit, a whole number of them.

    A chain of n cells errs by 1/n²: of the stated chain's error a fit finds all in data of the same chain, and next to
    none in those of an aircraft, which has no cells. What is nearly as many as stated is as many.
    """
    found = CELLS.amount(float(fit.u[fit.problem.unknowns.index(CELLS)]))
    finest, most = _finest(fit), _most_times(fit)
    times = min(most, 1 / math.sqrt(-found)) if found < 0 else most
    return 1.0 if times < _NEARLY_AS_STATED else round(times * finest) / finest


def _finest(fit: Fit) -> int:
    """The stated cells of the beam that has the most."""
    return max((b.cells for b in fit.problem.stated.airframe.beam), default=MOST_CELLS)


def _most_times(fit: Fit) -> float:
    """Times the stated cells that stand for a continuum."""
    most = max(1.0, MOST_CELLS / _finest(fit))
    return 1.0 if most < _NEARLY_AS_STATED else most


def _likeliest(found: Fit, chain: Problem, amount: float) -> tuple[float, Array, Array]:
    """The least cost, and scores u and e of it, where a chain as it is foretells; that of its cells counts nothing.

    From the fit, or from where its slopes lead with an ``amount`` of cells, which is nearer to it far away. Where a fit
    was not at its bottom, as far from it as it was. Infinite where there is no such aircraft at either start.
    """
    tangent = found.tangent
    cells = found.problem.unknowns.index(CELLS)
    others = np.arange(found.scores.size) != cells
    normal, here = tangent.T @ tangent + np.eye(others.size), float(found.u[cells])
    inner, aside = normal[np.ix_(others, others)], (amount - CELLS.amount(here)) / CELLS.rate(here)
    still = (tangent.T @ data_misfit(found.problem, found.predicted, found.sigma) + found.scores)[others]

    def reached(u: Array, e: Array) -> tuple[float, Array]:
        """Cost and the gradient (scores - 1,) of half of it, but for what the fit itself has of one."""
        try:
            predicted = anchor(chain, u, found.hypotheses, e, slopes=False).predict(u, e)
        except NoStructureError:
            return np.inf, np.zeros(others.size - 1)
        misfit, scores = data_misfit(chain, predicted, found.sigma), np.concatenate([u, e])
        rest = scores[others]
        cost = float(misfit @ misfit + rest @ rest - 2 * still @ rest)
        return cost if np.isfinite(cost) else np.inf, (tangent.T @ misfit + scores)[others] - still

    def stepped(u: Array, e: Array, gradient: Array, share: float = 1.0) -> tuple[Array, Array]:
        step = np.zeros(others.size)
        step[others] = -share * solved(inner, gradient)
        return moved(chain, found.hypotheses, u, e, step)

    starts = [(found.u, found.e), stepped(found.u, found.e, normal[others, cells] * aside)]
    (best, gradient), at = min(((reached(*start), start) for start in starts), key=lambda s: s[0][0])
    share = 1.0
    for _ in range(_STEPS):
        trial = stepped(*at, gradient, share)
        cost, there = reached(*trial)
        if cost < best:
            settled = best - cost < _SETTLED
            best, gradient, at, share = cost, there, trial, 1.0
            if settled:
                break
        else:
            share /= 2
    return best, *at
