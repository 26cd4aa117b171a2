"""A few steps first, and on to the end only where a fit is not far behind the best there is."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem

HOPELESS = 4.0
"""What is too far behind, as a multiple of χ²."""


def fit_unless_behind(
    problem: Problem,
    hypotheses: tuple[Hypothesis, ...],
    u: NDArray[np.float64],
    e: NDArray[np.float64],
    first: tuple[tuple[float, int], ...],
    best: float,
    progress: Callable[[float, str], None] | None = None,
) -> Fit:
    """A fit from u (scores,) and e by ``first`` stages, then near by unless ``HOPELESS`` times ``best``, a χ², is left.

    NoStructureError where the start describes no aircraft.
    """
    begun = fit(problem, hypotheses, u, e, first, progress)
    if begun.converged or begun.chi2 > HOPELESS * best:
        return begun
    return fit(problem, hypotheses, begun.u, begun.e, NEAR, progress)
