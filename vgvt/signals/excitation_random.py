"""Random excitation: band-limited Gaussian noise, continuous or in bursts.

A random signal must be the same function of time whatever instants it is asked for. It is
drawn on a grid of its own, fine against its highest frequency, and read by a cubic spline.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vgvt.signals.excitation import fade

# Grid points in the shortest period: the spline's images then lie below 1e-6 of the signal.
OVERSAMPLING = 64


def continuous_random(
    time_s: ArrayLike,
    generator: np.random.Generator,
    low_hz: float,
    high_hz: float,
    duration_s: float,
    taper_s: float = 0.0,
) -> NDArray[np.float64]:
    """Gaussian noise of unit root mean square, flat from ``low_hz`` to ``high_hz`` and nothing outside.

    Shape of ``time_s``, zero outside 0..``duration_s``. For equal state of ``generator`` it is
    one function of time. ValueError when the band is narrower than two lines of 1 / (2 duration).
    Ewins, Modal Testing, 2nd ed., chapter 3.
    """
    time = np.asarray(time_s, dtype=float)
    # Noise repeats with its period: twice the record, so that the end does not know the start.
    period = 2 * duration_s
    lines = lines_in_band(low_hz, high_hz, period)
    parts = generator.standard_normal((2, lines.size))
    spectrum = (parts[0] + 1j * parts[1]) / np.sqrt(2 * lines.size)
    return periodic_signal(time, lines, spectrum * np.sqrt(2), period) * fade(time, duration_s, taper_s)


def burst_random(
    time_s: ArrayLike,
    generator: np.random.Generator,
    low_hz: float,
    high_hz: float,
    duration_s: float,
    blocks: int,
    burst_fraction: float,
    taper_s: float = 0.0,
) -> NDArray[np.float64]:
    """Blocks of equal length that begin with a burst of new noise and end in silence, shape of ``time_s``.

    ``burst_fraction`` of each block is noise of unit root mean square; a response that dies out
    in the silence leaves no leakage. Each burst fades in and out over ``taper_s``.
    Avitabile, Modal Testing: A Practitioner's Guide, 2017.
    """
    if not 0 < burst_fraction <= 1:
        raise ValueError(f"burst_fraction must lie in 0 to 1, got {burst_fraction}")
    time = np.asarray(time_s, dtype=float)
    block = duration_s / blocks
    noise = continuous_random(time, generator, low_hz, high_hz, duration_s)
    since_start = time - block * np.clip(np.floor(time / block), 0, blocks - 1)
    return np.asarray(noise * fade(since_start, burst_fraction * block, taper_s))


def lines_in_band(low_hz: float, high_hz: float, period_s: float) -> NDArray[np.intp]:
    """The harmonics of 1 / ``period_s`` from ``low_hz`` to ``high_hz``, without 0; ValueError for fewer than two."""
    first = max(1, int(np.ceil(low_hz * period_s - 1e-9)))
    lines = np.arange(first, int(np.floor(high_hz * period_s + 1e-9)) + 1)
    if lines.size < 2:
        raise ValueError(f"{low_hz:g} to {high_hz:g} Hz holds fewer than two multiples of {1 / period_s:g} Hz")
    return lines


def periodic_signal(
    time_s: NDArray[np.float64], lines: NDArray[np.intp], amplitudes: NDArray[np.complex128], period_s: float
) -> NDArray[np.float64]:
    """The sum of Re(a_k exp(2 pi i k t / period)) over harmonics k = ``lines`` (L,), shape of ``time_s``."""
    from scipy.interpolate import CubicSpline

    wave = one_period(lines, amplitudes)
    grid = np.arange(wave.size + 1) * (period_s / wave.size)
    spline = CubicSpline(grid, np.append(wave, wave[0]), bc_type="periodic")
    return np.asarray(spline(time_s % period_s), dtype=np.float64)


def one_period(lines: NDArray[np.intp], amplitudes: NDArray[np.complex128]) -> NDArray[np.float64]:
    """One period of a sum of harmonics ``lines`` (L,) on a fine even grid, shape (points,)."""
    from scipy.fft import irfft, next_fast_len

    size = next_fast_len(OVERSAMPLING * int(lines[-1]), real=True)
    spectrum = np.zeros(size // 2 + 1, dtype=complex)
    spectrum[lines] = amplitudes * (size / 2)
    return np.asarray(irfft(spectrum, n=size), dtype=np.float64)
