"""Excitation signals: the linear swept sine that shakes an aircraft, and the fade that all kinds share."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def linear_chirp_frequency(
    time_s: ArrayLike, start_hz: float, stop_hz: float, duration_s: float
) -> NDArray[np.float64]:
    """Instantaneous frequency in Hz, shape of ``time_s``: start before 0, stop after ``duration_s``."""
    swept = np.clip(np.asarray(time_s, dtype=float), 0.0, _positive(duration_s)) / duration_s
    return np.asarray(start_hz + (stop_hz - start_hz) * swept)


def linear_chirp_phase(time_s: ArrayLike, start_hz: float, stop_hz: float, duration_s: float) -> NDArray[np.float64]:
    """Phase in radians, shape of ``time_s``: zero at t = 0, the integral of the instantaneous frequency.

    It goes on at the start frequency before 0 and at the stop frequency after
    ``duration_s``, without a step, so that orders can be tracked through the whole record.
    """
    time = np.asarray(time_s, dtype=float)
    inside = np.clip(time, 0.0, _positive(duration_s))
    swept = start_hz * inside + 0.5 * (stop_hz - start_hz) / duration_s * inside**2
    outside = start_hz * np.minimum(time, 0.0) + stop_hz * np.maximum(time - duration_s, 0.0)
    return np.asarray(2 * np.pi * (swept + outside))


def linear_chirp(
    time_s: ArrayLike, start_hz: float, stop_hz: float, duration_s: float, taper_s: float = 0.0
) -> NDArray[np.float64]:
    """Linear swept sine of unit amplitude, up or down, shape of ``time_s``; zero outside 0..``duration_s``.

    ``taper_s`` is the length of the raised-cosine fade at either end. The
    phase is continuous and starts at zero: sin(2 pi (f0 t + (f1 - f0) t^2 / (2 T))).
    ValueError for a duration that is not positive or a taper longer than half of it.
    """
    time = np.asarray(time_s, dtype=float)
    return np.asarray(np.sin(linear_chirp_phase(time, start_hz, stop_hz, duration_s)) * fade(time, duration_s, taper_s))


def fade(time_s: NDArray[np.float64], duration_s: float, taper_s: float) -> NDArray[np.float64]:
    """The envelope of an excitation, shape of ``time_s``: 1 inside 0..``duration_s``, 0 outside.

    It rises and falls as a raised cosine over ``taper_s`` at either end. ValueError for a duration
    that is not positive or a taper longer than half of it.
    """
    if not 0 <= taper_s <= _positive(duration_s) / 2:
        raise ValueError(f"taper_s must lie between 0 and half the duration ({duration_s / 2} s), got {taper_s}")
    envelope = np.where((time_s < 0) | (time_s > duration_s), 0.0, 1.0)
    if taper_s > 0:
        nearest_end = np.clip(np.minimum(time_s, duration_s - time_s), 0.0, taper_s)
        envelope *= 0.5 - 0.5 * np.cos(np.pi * nearest_end / taper_s)
    return envelope


def _positive(duration_s: float) -> float:
    if not duration_s > 0:
        raise ValueError(f"duration_s must be positive, got {duration_s}")
    return duration_s
