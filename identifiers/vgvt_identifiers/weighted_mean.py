"""The mean of what several runs say of one number, each with its standard deviation, and their scatter beyond that."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_LEAST_FREEDOM = 3  # two runs alone would say that nothing is known
_FALSE_SCATTER = 0.01  # chance that runs of one and the same number count as scattered


def weighted_mean(values: NDArray[np.float64], std: NDArray[np.float64]) -> tuple[float, float, float]:
    """Mean, its standard deviation, and the scatter between the values (n,) beyond their own; NaN std: unknown.

    Weights 1 / std^2, or 1 / (std^2 + scatter^2) where the runs scatter more than that (DerSimonian and
    Laird, Controlled Clinical Trials 7(3), 1986), with the standard deviation
    from the scatter (Hartung and Knapp, Statistics in Medicine 20(12), 2001).
    """
    from scipy.special import chdtri, stdtrit

    known = np.isfinite(std) & (std > 0)
    if not known.any():
        scatter = float(values.std(ddof=1)) if values.size > 1 else float("nan")
        return float(values.mean()), scatter / np.sqrt(values.size), scatter
    values, std = values[known], std[known]
    weight, freedom = 1 / std**2, values.size - 1
    mean = float(weight @ values / weight.sum())
    misfit = float(weight @ (values - mean) ** 2)
    if freedom == 0 or misfit < chdtri(freedom, _FALSE_SCATTER):
        return mean, float(1 / np.sqrt(weight.sum())), 0.0
    between = (misfit - freedom) / float(weight.sum() - (weight**2).sum() / weight.sum())
    weight = 1 / (std**2 + between)
    mean = float(weight @ values / weight.sum())
    spread = float(weight @ (values - mean) ** 2) / freedom / float(weight.sum())
    # Few runs know their own scatter badly: Student's factor keeps 1.96 standard deviations at 95 %.
    student = float(stdtrit(max(freedom, _LEAST_FREEDOM), 0.975)) / 1.96
    return mean, student * float(np.sqrt(spread)), float(np.sqrt(between))
