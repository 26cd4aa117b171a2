"""Peaks of a singular value of a spectral density matrix that the scatter of its estimate cannot make."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.output_spectra import Decomposition

_WIDTHS = (1, 3, 5, 9, 17)


def density_peaks(found: Decomposition, prominence_db: float, false_alarm: float) -> list[int]:
    """Lines of the peaks of the first singular value (K,), judged at several widths of smoothing, in order.

    The logarithm must rise by ``prominence_db`` over its saddle and by what chance makes of top and
    saddle somewhere among all lines with probability ``false_alarm``.
    """
    from scipy.ndimage import uniform_filter1d
    from scipy.signal import find_peaks
    from scipy.stats import norm

    values, lines = found.values[0], found.frequency_hz.size
    taken: list[tuple[int, int]] = []
    for width in (w for w in _WIDTHS if w <= lines // 6):
        smooth = np.log(uniform_filter1d(values, width, mode="nearest"))
        sigmas = float(norm.isf(false_alarm / (2 * max(lines / width, 2.0))))
        scatter = found.relative_std[0] * np.sqrt(min(1.0, found.shared_lines / width))
        tops, facts = find_peaks(smooth, prominence=prominence_db * np.log(10) / 10)
        for top, prominence in zip(tops, facts["prominences"], strict=True):
            if prominence < np.sqrt(2) * sigmas * scatter[top]:
                continue
            line = _raw_top(values, int(top), width)
            if all(abs(line - other) > (width + reach) / 2 + 1 for other, reach in taken):
                taken.append((line, width))
    return sorted(line for line, _ in taken)


def _raw_top(values: NDArray[np.float64], top: int, width: int) -> int:
    low = max(top - width // 2, 0)
    return low + int(np.argmax(values[low : top + width // 2 + 1]))
