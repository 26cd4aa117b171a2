"""Periodic multisine: harmonics of equal amplitude with random phases, all of them or the odd ones."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vgvt.signals.excitation import fade
from vgvt.signals.excitation_random import lines_in_band, one_period, periodic_signal

# The clip level, as a share of the peak, falls less and less: hard clipping early, polishing late.
_FIRST_CLIP, _LAST_CLIP = 0.80, 0.98


def multisine_lines(low_hz: float, high_hz: float, period_s: float, lines: Literal["full", "odd"]) -> NDArray[np.intp]:
    """The excited harmonics of 1 / ``period_s``: all in the band, or the odd ones; ValueError for fewer than two.

    Odd harmonics alone leave the even lines free to show an even nonlinearity.
    """
    every = lines_in_band(low_hz, high_hz, period_s)
    chosen = every if lines == "full" else every[every % 2 == 1]
    if chosen.size < 2:
        raise ValueError(f"{low_hz:g} to {high_hz:g} Hz holds fewer than two {lines} multiples of {1 / period_s:g} Hz")
    return chosen


def multisine(
    time_s: ArrayLike,
    generator: np.random.Generator,
    low_hz: float,
    high_hz: float,
    duration_s: float,
    periods: int,
    lines: Literal["full", "odd"] = "full",
    crest_iterations: int = 0,
    taper_s: float = 0.0,
) -> NDArray[np.float64]:
    """Random-phase multisine of unit root mean square, shape of ``time_s``, zero outside 0..``duration_s``.

    The period is ``duration_s / periods``; phases are drawn from ``generator`` and, with
    ``crest_iterations``, then moved for a lower peak. Pintelon and Schoukens, System
    Identification: A Frequency Domain Approach, 2nd ed., chapters 2 and 4.
    """
    time = np.asarray(time_s, dtype=float)
    period = duration_s / periods
    excited = multisine_lines(low_hz, high_hz, period, lines)
    phase = generator.uniform(0.0, 2 * np.pi, excited.size)
    amplitudes = np.sqrt(2 / excited.size) * np.exp(1j * phase)
    amplitudes = lower_crest(excited, amplitudes, crest_iterations)
    return periodic_signal(time, excited, amplitudes, period) * fade(time, duration_s, taper_s)


def crest_factor(lines: NDArray[np.intp], amplitudes: NDArray[np.complex128]) -> float:
    """Peak over root mean square of a sum of harmonics ``lines`` (L,) with complex ``amplitudes`` (L,)."""
    wave = one_period(lines, amplitudes)
    return float(np.abs(wave).max() / np.sqrt((wave**2).mean()))


def lower_crest(lines: NDArray[np.intp], amplitudes: NDArray[np.complex128], iterations: int) -> NDArray[np.complex128]:
    """The same amplitudes (L,) with phases that lower the peak: clip, keep the phases, restore the amplitudes.

    The best of all iterations. Van der Ouderaa, Schoukens, Renneboog, Peak factor minimization using
    a time-frequency domain swapping algorithm, IEEE Trans. Instrum. Meas. 37(1), 1988.
    """
    size = np.abs(amplitudes)
    best, lowest, current = amplitudes, crest_factor(lines, amplitudes), amplitudes
    for level in np.linspace(_FIRST_CLIP, _LAST_CLIP, iterations):
        wave = one_period(lines, current)
        limit = level * np.abs(wave).max()
        current = size * np.exp(1j * np.angle(np.fft.rfft(np.clip(wave, -limit, limit))[lines]))
        crest = crest_factor(lines, current)
        if crest < lowest:
            best, lowest = current, crest
    return best
