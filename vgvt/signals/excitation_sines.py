"""Swept sines beside the linear chirp: logarithmic, and stepped as an analyser does it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vgvt.signals.excitation import fade


def logarithmic_chirp(
    time_s: ArrayLike, start_hz: float, stop_hz: float, duration_s: float, taper_s: float = 0.0
) -> NDArray[np.float64]:
    """Swept sine of unit amplitude with a constant number of octaves a second, up or down, shape of ``time_s``.

    sin(2 pi f0 T / ln(f1/f0) ((f1/f0)^(t/T) - 1)), zero outside 0..``duration_s``. ValueError for
    frequencies that are not positive or alike, and for a taper longer than half the duration.
    Ewins, Modal Testing, 2nd ed., chapter 3.
    """
    if not (start_hz > 0 and stop_hz > 0) or start_hz == stop_hz:
        raise ValueError(f"a logarithmic sweep needs two positive frequencies, got {start_hz} and {stop_hz}")
    time = np.asarray(time_s, dtype=float)
    octaves = np.log(stop_hz / start_hz)
    inside = np.clip(time, 0.0, duration_s)
    phase = 2 * np.pi * start_hz * duration_s / octaves * np.expm1(octaves * inside / duration_s)
    return np.asarray(np.sin(phase) * fade(time, duration_s, taper_s))


def stepped_frequencies(start_hz: float, stop_hz: float, points: int) -> NDArray[np.float64]:
    """The frequencies that a stepped sine dwells at, evenly spaced, both ends included, shape (points,)."""
    return np.linspace(start_hz, stop_hz, points)


def stepped_sine(
    time_s: ArrayLike, start_hz: float, stop_hz: float, duration_s: float, points: int, taper_s: float = 0.0
) -> NDArray[np.float64]:
    """Sine of unit amplitude that dwells ``duration_s / points`` at each frequency, shape of ``time_s``.

    The phase goes on without a step from dwell to dwell; zero outside 0..``duration_s``.
    ValueError for fewer than two points or a taper longer than half the duration. The swept-sine
    mode of the HP 35670A analyser in Moreno et al., American Control Conference 2014, section III.
    """
    if points < 2:
        raise ValueError(f"a stepped sine needs at least two points, got {points}")
    time = np.asarray(time_s, dtype=float)
    dwell = duration_s / points
    frequency = stepped_frequencies(start_hz, stop_hz, points)
    inside = np.clip(time, 0.0, duration_s)
    step = np.minimum((inside / dwell).astype(int), points - 1)
    cycles = np.concatenate([[0.0], np.cumsum(frequency)[:-1] * dwell])
    phase = 2 * np.pi * (cycles[step] + frequency[step] * (inside - step * dwell))
    return np.asarray(np.sin(phase) * fade(time, duration_s, taper_s))
