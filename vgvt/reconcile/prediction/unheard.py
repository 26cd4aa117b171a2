"""Whether what still rings at the ends of records shows in any data.

What an end leaves out is found pole by pole for every run, and is half of the work of a prediction. Where data may be
wrong by a hundred times as much, a fit walks without it, and looks again where it arrived.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.prediction.surrogate import Anchor

# Standard deviations of the data, root mean square, by which ends must show: of fifty thousand real numbers no more
# than twenty of χ² then, were all of it misfit.
_UNHEARD = 0.02


def unheard(here: Anchor, u: NDArray[np.float64], e: NDArray[np.float64], predicted: NDArray[np.complex128]) -> bool:
    """Whether what ends of records leave out shows in no data: ``predicted`` (C, L) at scores u and e has it."""
    measured, keep = here.problem.measured, here.problem.split.train
    if not measured.endings:
        return False
    added = (predicted - here.predict(u, e, ended=False))[keep] / measured.sigma[keep]
    return bool(np.mean(np.abs(added) ** 2) < _UNHEARD**2)
