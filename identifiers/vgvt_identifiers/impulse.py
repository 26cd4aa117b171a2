"""Impulse responses of a frequency band: inverse Fourier transform of frequency responses that end at its edges.

A frequency response is known in a band only. Its inverse transform rings at
the band's edges, unless it is tapered there. Tapering multiplies by a smooth
window, so it convolves the impulse response with something that is short.
After that length the sampled impulse response is again an exact sum of the
structure's own exponentials: poles in the band keep their value, even in the
taper, and only their amplitude is scaled by the window. That is why the first samples are left out. The
inverse transform of a line spectrum is the periodic sum of the impulse
response, which has the same exponentials, so nothing has to decay within its length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError

_SKIP_PER_TAPER = 1.5  # the transform of a cosine taper of width b has fallen to a few thousandths after 1.5 / b
_HIGH_BAND = 0.25  # from here on the band is shifted towards 0 Hz, as most of the axis below it would be empty
_SHIFTED_EDGE = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class ImpulseResponses:
    """Real impulse responses (R, N) of accelerances, (m/s^2)/(N s), from ``start`` samples after the impulse.

    ``step_s`` is their sampling interval, ``period`` the number of samples after
    which the inverse transform repeats itself. Frequencies are lower than
    those of the structure by ``shift_hz``. ``lines`` (K,) are the places of the
    band's lines on the axis of the transform, ``window`` (K,) is the taper.
    """

    values: NDArray[np.float64]
    step_s: float
    start: int
    period: int
    shift_hz: float
    lines: NDArray[np.intp]
    window: NDArray[np.float64]

    def structure_poles(self, roots: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Poles in rad/s of the discrete roots z (n,), those with positive imaginary part."""
        return np.asarray(np.log(roots) / self.step_s + 2j * np.pi * self.shift_hz)


def impulse_responses(
    frequency_hz: NDArray[np.float64],
    accelerance: NDArray[np.complex128],
    samples: int = 601,
    low_taper: float = 0.1,
    high_taper: float = 0.25,
) -> ImpulseResponses:
    """Impulse responses of accelerances (R, K) on evenly spaced lines (K,), at most ``samples`` of them.

    The interval is that of the highest line: 70 samples a second for a band up
    to 35 Hz, so nothing is aliased. The tapers are raised cosines over those
    parts of the band. The line spectrum is that of a real signal, so negative
    frequencies mirror the band. InputError for fewer than 8 lines or uneven ones.
    """
    step = float(frequency_hz[-1] - frequency_hz[0]) / max(frequency_hz.size - 1, 1)
    if frequency_hz.size < 8 or np.abs(np.diff(frequency_hz) - step).max() > 1e-3 * step:
        raise InputError("impulse response", "needs eight or more evenly spaced lines", "widen the band")
    first = round(frequency_hz[0] / step)
    shift = 0
    if frequency_hz[0] > _HIGH_BAND * frequency_hz[-1]:
        shift = max(first - max(round(_SHIFTED_EDGE * frequency_hz.size), 1), 0)
    lines = first - shift + np.arange(frequency_hz.size)
    period = 2 * int(lines[-1] + 1)
    window = _taper(frequency_hz.size, low_taper, high_taper)
    half = np.zeros((accelerance.shape[0], period // 2 + 1), complex)
    half[:, lines] = accelerance * window
    interval = 1 / (period * step)
    narrowest = frequency_hz.size * step * min(low_taper, high_taper)
    start = max(1, int(np.ceil(_SKIP_PER_TAPER / (narrowest * interval)))) if narrowest else 1
    start = min(start, period // 8)
    # The far end of the period is the time before the impulse, where the window rings as well.
    stop = min(start + samples, period - start)
    values = np.fft.irfft(half, period, axis=1)[:, start:stop] / interval
    # The lines need not be multiples of their spacing: what is left over is part of the shift.
    moved = float(frequency_hz[0]) - float(lines[0]) * step
    return ImpulseResponses(values, interval, start, period, moved, lines, window)


def _taper(lines: int, low: float, high: float) -> NDArray[np.float64]:
    """Raised cosine flanks over parts of the band, 1 between them; never quite 0, so that every line counts."""
    place = (np.arange(lines) + 1) / (lines + 1)
    window = np.ones(lines)
    for part, distance in ((low, place), (high, 1 - place)):
        if part > 0:
            window *= np.sin(np.pi / 2 * np.minimum(distance / part, 1)) ** 2
    return window
