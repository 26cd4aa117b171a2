"""Fewer points for the same picture: what a line drawing needs and no more."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vgvt.data import ModalModel


def peak_keeping_index(values: NDArray[np.floating], points: int) -> NDArray[np.intp]:
    """Indices of about ``points`` samples that keep every visible peak and dip, in order.

    The curve (N,) is cut into points / 2 pieces and the smallest and largest of each are kept, with
    both ends; a short curve is kept whole. ValueError for fewer than four points.
    """
    if points < 4:
        raise ValueError(f"a curve needs at least 4 points, got {points}")
    size = values.size
    if size <= points:
        return np.arange(size)
    edges = np.linspace(0, size, points // 2 + 1).astype(int)
    keep = {0, size - 1}
    for start, stop in pairwise(edges):
        piece = values[start:stop]
        keep.add(int(start + np.argmin(piece)))
        keep.add(int(start + np.argmax(piece)))
    return np.array(sorted(keep), dtype=np.intp)


def resonance_grid(model: ModalModel, band_hz: tuple[float, float], points: int = 240) -> NDArray[np.float64]:
    """Frequencies within a band for drawing the FRFs of a model: even, and dense around each resonance."""
    low, high = band_hz
    grid = [np.linspace(max(low, 1e-3), high, points)]
    spread = np.sinh(np.linspace(-3, 3, 31))
    for frequency, ratio in zip(model.natural_frequency_hz, model.damping_ratio, strict=True):
        width = frequency * (min(max(ratio, 1e-3), 0.1) if np.isfinite(ratio) else 0.01)
        grid.append(frequency + width * spread)
    joined = np.unique(np.concatenate(grid))
    return np.asarray(joined[(joined >= low) & (joined <= high) & (joined > 0)])


def break_wraps(
    frequency_hz: NDArray[np.floating], phase_deg: NDArray[np.floating]
) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """The phase curve with a gap (NaN) wherever it wraps by more than half a turn."""
    jumps = np.flatnonzero(np.abs(np.diff(phase_deg)) > 180) + 1
    return np.insert(frequency_hz, jumps, frequency_hz[jumps]), np.insert(phase_deg, jumps, np.nan)
