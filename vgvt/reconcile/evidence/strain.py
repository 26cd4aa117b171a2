"""How far a fit took what is uncertain from its stated values, all of it together.

Each quantity may stay within its own tolerance while all of them lean on theirs, to imitate what is missing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from vgvt.reconcile.question.problem import CELLS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vgvt.reconcile.question.problem import Problem


class Fitted(Protocol):
    """Whatever took scores ``u`` of the unknowns from the stated values, with their ``covariance``."""

    @property
    def problem(self) -> Problem:
        """What it was made for."""
        ...

    @property
    def u(self) -> NDArray[np.float64]:
        """Scores of the unknowns."""
        ...

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Of all scores, those of the unknowns first."""
        ...


def strain_sd(found: Fitted) -> float:
    """By how many standard deviations the square sum of the unknowns' scores exceeds what it should be.

    Truths within the tolerances have scores u ~ N(0, 1), of which a fit recovers û with the covariance I - C, where C
    is that of the posterior: what data do not tell stays where it was stated. The square sum of û has the mean
    tr(I - C) and the variance 2 tr((I - C)²). An effect's own parameters do not count, nor does how coarse a chain the
    data come from, which no scenario states. Zero without unknowns.
    """
    stated = np.array([k for k, name in enumerate(found.problem.names) if name != CELLS.name], dtype=np.intp)
    if stated.size == 0:
        return 0.0
    u, told = found.u[stated], np.eye(stated.size) - found.covariance[np.ix_(stated, stated)]
    spread = np.sqrt(2 * np.sum(told**2))
    return float((u @ u - np.trace(told)) / max(spread, np.finfo(float).tiny))
