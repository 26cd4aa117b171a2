"""A calibration that may not bend: where data are met by tolerances far exceeded, what it cannot imitate stands out.

An effect that tens of standard deviations imitate leaves nothing to see: from where the unknowns stand, dozens of
others promise as much, and steps that forgive misplaced peaks forgive the whole of what it does. Held to a tenth of
their tolerances the unknowns leave it in the data. What the true aircraft is not as stated stays there, too, and is far
less than what had moved unknowns by ten tolerances.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, Problem
from vgvt.reconcile.search.screen import screen
from vgvt.reconcile.search.screened import Screened
from vgvt.reconcile.work.progress import Progress

_HELD = 0.1
_STAGES = ((0.05, 4), (0.0, 12))


def upright(current: Fit, start: Fit, left: Sequence[Hypothesis], tell: Progress) -> tuple[Screened, ...]:
    """What some hypotheses could buy of ``current`` if its unknowns were held to a tenth of their tolerances.

    The calibration begins where ``start`` is, another fit of the same, which forgave misplaced peaks. Scores to start
    from are those of the problem as it is. NoStructureError where there is no such aircraft.
    """
    stiff, shares = held(current.problem, _HELD)
    stand = fit(stiff, current.hypotheses, start.u / shares, start.e, _STAGES)
    all_shares = np.concatenate([shares, np.ones(current.e.size)])
    return tuple(
        replace(s, start=None if s.start is None else s.start * all_shares, upright=True)
        for s in screen(stand, left, tell)
    )


def held(problem: Problem, share: float) -> tuple[Problem, NDArray[np.float64]]:
    """The problem with its unknowns' tolerances at a share, and what a score (n,) of it is in scores of the problem.

    What the measuring chain leaves open, and how coarse a chain the data come from, stay as they are.
    """
    shares = np.array([1.0 if unknown is CELLS else share for unknown in problem.unknowns])
    unknowns = tuple(
        unknown if unknown is CELLS else replace(unknown, sd=share * unknown.sd) for unknown in problem.unknowns
    )
    centre = None if problem.centre is None else problem.centre / shares
    stiff = replace(problem, unknowns=unknowns, centre=centre)
    return stiff, np.concatenate([shares, np.ones(len(problem.nuisances))])
