"""How far a fit took what is uncertain from its stated values, all of it together.

Each quantity may stay within its own tolerance while all of them lean on theirs, to imitate what is missing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from vgvt.reconcile.fit import Fit


def strain_sd(found: Fit) -> float:
    """By how many standard deviations the square sum of the unknowns' scores exceeds what it should be.

    Truths within the tolerances have scores u ~ N(0, 1), of which a fit recovers û with the covariance I - C, where C
    is that of the posterior: what data do not tell stays where it was stated. The square sum of û has the mean
    tr(I - C) and the variance 2 tr((I - C)²). An effect's own parameters do not count. Zero without unknowns.
    """
    count = found.u.size
    if count == 0:
        return 0.0
    told = np.eye(count) - found.covariance[:count, :count]
    spread = np.sqrt(2 * np.sum(told**2))
    return float((found.u @ found.u - np.trace(told)) / max(spread, np.finfo(float).tiny))
