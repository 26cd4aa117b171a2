"""What a scenario declares uncertain, fitted to a campaign, and nothing else: the null model of every search."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.fitting.fit import FAR, STAGES, TO_THE_END, Fit, fit
from vgvt.reconcile.fitting.other_valleys import other_valleys
from vgvt.reconcile.fitting.rough_start import rough_start
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.local_slopes import SERVE
from vgvt.reconcile.question.arguments import starting_scores
from vgvt.reconcile.question.problem import Problem, recentred
from vgvt.reconcile.work.one_thread import one_thread

Array = NDArray[np.float64]
# Standard deviations from where slopes were taken that change nothing.
_THERE = 0.3


@one_thread
def calibrate(
    problem: Problem,
    start: Array | None = None,
    *,
    stages: tuple[tuple[float, int], ...] = STAGES,
    progress: Callable[[float, str], None] | None = None,
) -> Fit:
    """Fit what the scenario declares uncertain, and nothing else: the null model. ``start`` (scores,);
    ValueError for one of another length.

    Without a start it begins where peaks overlap, and goes down whatever other valley is seen across a hump, too.
    Its problem has the slopes of where the fit ended, for all that is fitted next to it, unless that is so far from the
    stated values that something is imitated: then these are what others start from.
    """
    at = rough_start(problem)[0] if start is None else starting_scores(start, problem.size)
    found = fit(problem, (), at, np.zeros(0), stages, progress, exact=True)
    if start is None:
        found = _lowest(found, progress)
    # How coarse a chain the data come from has no bottom where these tell nothing of it, and a slope of its own.
    known = slice(0, len(problem.unknowns) - 1)
    moved = np.abs(found.u[known] - problem.at[known]).max(initial=0.0)
    if moved < _THERE or np.abs(found.u[known]).max(initial=0.0) > SERVE:
        return found
    problem = recentred(problem, found.u)
    return fit(problem, (), found.u, np.zeros(0), TO_THE_END, progress, exact=True)


def _lowest(found: Fit, progress: Callable[[float, str], None] | None) -> Fit:
    """The lowest of a calibration and what is found down the valleys beside it."""
    lowest = found
    for valley in other_valleys(found.problem, found.u, progress):
        begun = found.u.copy()
        begun[valley.index] = valley.score
        try:
            other = fit(found.problem, (), begun, np.zeros(0), FAR, progress, exact=True)
        except NoStructureError:
            continue
        lowest = other if other.cost < lowest.cost else lowest
    return lowest
