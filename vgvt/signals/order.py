"""Order tracking: the phase of a swept or dwelling drive, and what a response holds at its multiples.

Vold and Leuridan, High resolution order tracking at extreme slew rates using Kalman
tracking filters, SAE 931288, 1993, for the idea; here the phase is known, so that a
demodulation with its multiple and a low pass are enough.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_SMOOTHING_S = 0.25
_LEAST_LEVEL = 0.1
_LARGEST_ROUGHNESS = 0.15
_LEAST_SHARE = 0.2


@dataclass(frozen=True, slots=True, eq=False)
class DriveTrack:
    """Phase in rad and frequency in Hz of a drive, (N,) each, and where it is on, (N,)."""

    phase_rad: NDArray[np.float64]
    frequency_hz: NDArray[np.float64]
    alive: NDArray[np.bool_]

    def passes(self, frequency_hz: float, sample_rate_hz: float) -> float | None:
        """Time in seconds at which the drive comes closest to a frequency, None when it never comes within 2 %."""
        distance = np.where(self.alive, np.abs(self.frequency_hz - frequency_hz), np.inf)
        nearest = int(np.argmin(distance))
        if distance[nearest] > 0.02 * frequency_hz:
            return None
        return nearest / sample_rate_hz


def track_drive(samples: NDArray[np.floating], sample_rate_hz: float) -> DriveTrack | None:
    """The track of a drive (N,) that is one sine at any time; None for random or other broad-band drives.

    The phase is that of the analytic signal, Gabor, Theory of communication, J. IEE 93, 1946.
    """
    from scipy.ndimage import uniform_filter1d
    from scipy.signal import hilbert

    signal = np.asarray(samples, dtype=np.float64)
    signal = signal - signal.mean()
    if not np.isfinite(signal).all() or np.ptp(signal) == 0:
        return None
    analytic = hilbert(signal)
    width = max(int(_SMOOTHING_S * sample_rate_hz), 3)
    level = uniform_filter1d(np.abs(analytic), width)
    alive = level > _LEAST_LEVEL * level.max()
    phase = np.unwrap(np.angle(analytic))
    raw = np.gradient(phase) * sample_rate_hz / (2 * np.pi)
    frequency = uniform_filter1d(raw, width)
    weight = np.where(alive, np.abs(analytic) ** 2, 0.0)
    inner = slice(width, -width)
    if weight[inner].sum() == 0:
        return None
    error = np.sqrt((weight * (raw - frequency) ** 2)[inner].sum() / (weight * frequency**2)[inner].sum())
    if error > _LARGEST_ROUGHNESS or alive.mean() < _LEAST_SHARE:
        return None
    return DriveTrack(phase, frequency, alive)


def order_envelope(
    samples: NDArray[np.floating], track: DriveTrack, order: float, bandwidth_hz: float, sample_rate_hz: float
) -> NDArray[np.complex128]:
    """Complex amplitude (..., N) of what signals (..., N) hold at ``order`` times the drive's phase.

    A component A cos(order phase + p) gives A exp(i p). The low pass, a zero-phase
    Butterworth of fourth order, lets changes up to ``bandwidth_hz`` through; keep
    it well below the distance to the neighbouring order.
    """
    from scipy.signal import butter, sosfiltfilt

    if not 0 < bandwidth_hz < sample_rate_hz / 2:
        raise ValueError(f"bandwidth_hz must lie between 0 and half the sample rate, got {bandwidth_hz}")
    turned = 2 * np.asarray(samples, dtype=np.float64) * np.exp(-1j * order * track.phase_rad)
    filters = butter(4, bandwidth_hz, fs=sample_rate_hz, output="sos")
    return np.asarray(sosfiltfilt(filters, turned.real) + 1j * sosfiltfilt(filters, turned.imag))
