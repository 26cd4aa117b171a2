"""Poles of several runs joined with all that each run knows of them together.

In one run the errors of two close modes go together, and differently in every run,
as its sensors see other parts of the shapes. A mean of one mode after the other
loses that: next to a neighbour 2 % away up to a tenth of the accuracy. This is the
generalised least-squares mean; Aitken, Proc. Royal Society of Edinburgh 55, 1935.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.common_modes import RunModes
from vgvt_identifiers.weighted_mean import weighted_mean


def joint_parameters(
    run_modes: tuple[RunModes, ...], groups: NDArray[np.intp]
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Means and standard deviations (2, M) of frequencies in Hz and damping ratios of modes, ``groups`` (M, runs).

    NaN where runs scatter beyond their deviations, or no run knows the mode by itself: what a mean
    of that number alone says stands there. None where a run states no covariance.
    """
    if len(run_modes) < 2 or any(m.covariance is None for m in run_modes):
        return None
    values, std = _table(run_modes, groups)
    between = np.zeros(2 * len(groups))
    for k in range(between.size):
        known = np.isfinite(std[k]) & (std[k] > 0)
        between[k] = weighted_mean(values[k, known], std[k, known])[2] ** 2 if known.any() else 0.0
    size = np.array([s[np.isfinite(s) & (s > 0)].min(initial=np.inf) for s in std])
    lost = ~np.isfinite(size)
    size = np.where(lost, 1.0, size)
    information, pull = np.zeros((size.size, size.size)), np.zeros(size.size)
    for run, modes in enumerate(run_modes):
        seen = np.flatnonzero(np.isfinite(std[:, run]) & (std[:, run] > 0))
        if seen.size and modes.covariance is not None:
            place = groups[seen % len(groups), run] + np.where(seen < len(groups), 0, modes.poles.size)
            matrix = modes.covariance[np.ix_(place, place)] + np.diag(between[seen])
            weight = np.linalg.pinv(matrix / size[seen, None] / size[seen], hermitian=True)
            information[np.ix_(seen, seen)] += weight
            pull[seen] += weight @ (values[seen, run] / size[seen])
    covariance = np.linalg.pinv(information, hermitian=True)
    alone = lost | (between > 0)
    mean = np.where(alone, np.nan, covariance @ pull * size)
    deviation = np.where(alone, np.nan, np.sqrt(np.diag(covariance)) * size)
    return mean.reshape(2, -1), deviation.reshape(2, -1)


def _table(
    run_modes: tuple[RunModes, ...], groups: NDArray[np.intp]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Values and standard deviations (2 M, runs), frequencies then damping ratios; infinite where a run has no say."""
    values = np.zeros((2 * len(groups), len(run_modes)))
    std = np.full(values.shape, np.inf)
    for run, modes in enumerate(run_modes):
        assert modes.covariance is not None  # the caller has looked
        count, size = modes.poles.size, np.abs(modes.poles)
        own = np.concatenate([size / (2 * np.pi), -modes.poles.real / size])
        spread = np.sqrt(np.maximum(np.diag(modes.covariance), 0.0))
        for mode in np.flatnonzero(groups[:, run] >= 0):
            at = groups[mode, run]
            for row, place in ((mode, at), (len(groups) + mode, count + at)):
                values[row, run] = own[place]
                if spread[place] > 0:
                    std[row, run] = spread[place]
    return values, std
