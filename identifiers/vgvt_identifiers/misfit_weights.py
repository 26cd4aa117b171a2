"""Residues of one run for poles that may not be all there are: lines count for what the fit leaves on them.

Weighted by their noise alone, the lines of a mode without a pole, where force and response are
large, would bend the residues of all others to explain it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.residues import Residues, fit_residues
from vgvt_identifiers.spectra import RunSpectra, running_median

_ROUNDS = 3


def residues_beside_others(
    run: RunSpectra, frequency_hz: NDArray[np.float64], poles_rad_s: NDArray[np.complex128]
) -> Residues:
    """Residues of the poles (M,) in the ratios of ``run`` on ``frequency_hz`` (K,), every line weighted by its misfit.

    The variance of a line is its noise, or the median over 25 lines of the squared error of the
    fit before where that is more (iteratively reweighted least squares).
    """
    fit = fit_residues(run, frequency_hz, poles_rad_s)
    power = np.maximum(np.abs(run.force), 1e-12 * np.abs(run.force).max()) ** 2
    for _ in range(_ROUNDS):
        left = running_median(np.abs(fit.errors) ** 2 * power) / np.log(2) / power
        fit = fit_residues(run, frequency_hz, poles_rad_s, variance=np.maximum(run.variance, left))
    return fit
