"""Groups sigma-plot peaks that lean on each other and gives every group its window of lines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.sigma_plot import SigmaPeak

_MINIMUM_HALF_LINES = 20


@dataclass(frozen=True, slots=True)
class Window:
    """Lines ``low`` to ``high`` (exclusive), the peaks fitted in them, and those of them that belong to it."""

    low: int
    high: int
    peaks: tuple[SigmaPeak, ...]
    own: tuple[int, ...]


def fit_windows(peaks: tuple[SigmaPeak, ...], frequency_hz: NDArray[np.float64], widths: float) -> tuple[Window, ...]:
    """One window per group of peaks whose cores (one width each side) touch.

    A window reaches ``widths`` half-power widths, and at least 20 lines, beyond
    its outer peaks; peaks of other groups inside, or just outside, are fitted with it.
    """
    step = float(frequency_hz[1] - frequency_hz[0])
    groups: list[list[SigmaPeak]] = []
    for peak in peaks:
        last = groups[-1][-1] if groups else None
        if last is not None and peak.frequency_hz - last.frequency_hz < 2 * (peak.width_hz + last.width_hz):
            groups[-1].append(peak)
        else:
            groups.append([peak])
    windows = []
    for group in groups:
        low = min(p.line - _reach(p, widths, step) for p in group)
        high = max(p.line + _reach(p, widths, step) for p in group) + 1
        low, high = max(low, 0), min(high, frequency_hz.size)
        near = _MINIMUM_HALF_LINES
        inside = tuple(p for p in peaks if low - near <= p.line < high + near)
        windows.append(Window(low, high, inside, tuple(inside.index(p) for p in group)))
    return tuple(windows)


def _reach(peak: SigmaPeak, widths: float, step: float) -> int:
    return max(_MINIMUM_HALF_LINES, round(widths * peak.width_hz / step))
