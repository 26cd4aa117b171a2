"""Fits the bell of one mode in a squared singular value, as curve-fitting frequency domain decomposition does.

Schulze, Thompson, Danowsky, Lee and Harris, System identification and modal
extraction from response data, AIAA Atmospheric Flight Mechanics, 2013.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError


@dataclass(frozen=True, slots=True)
class BellFit:
    """One mode: frequency, damping ratio, height of the bell, lines used, and the rms error of its logarithm."""

    natural_frequency_hz: float
    damping_ratio: float
    constant: float
    lines: int
    log_rms: float


def bell_fit(
    frequency_hz: NDArray[np.float64],
    power: NDArray[np.float64],
    near_hz: float,
    drop_db: float = 10.0,
    search_hz: float = 0.5,
    differentiations: int = 2,
) -> BellFit:
    """Fit of c w^(2d) / |w_k^2 - w^2 + 2 i zeta w_k w|^2 to the bell of ``power`` (K,) around ``near_hz``.

    ``power`` is a squared singular value, such as the square of the sigma plot;
    d = ``differentiations`` is 2 for accelerations. The bell reaches from the
    largest line within ``search_hz`` of ``near_hz`` down by ``drop_db`` on both
    sides or to the trough before the next rise. InputError when there is no bell of one mode there.
    """
    lines = _bell(frequency_hz, power, near_hz, drop_db, search_hz)
    if lines.size < 4:
        raise InputError("bell fit", f"only {lines.size} lines near {near_hz:g} Hz", "raise drop_db or look elsewhere")
    frequency, values = frequency_hz[lines], power[lines]
    top = float(frequency[np.argmax(values)])
    square, loss, constant = _fraction(frequency / top, values, differentiations)
    from scipy.optimize import least_squares

    def log_error(parameters: NDArray[np.float64]) -> NDArray[np.float64]:
        model = _bell_model(frequency / top, parameters[0], np.exp(parameters[1]), differentiations)
        return np.asarray(np.log(values) - np.log(model) - parameters[2])

    start = [np.sqrt(max(square, 1e-6)), 0.5 * np.log(max(loss, 1e-10)), np.log(max(constant, 1e-300))]
    solution = least_squares(log_error, start, x_scale=[1e-3, 0.1, 0.1], loss="soft_l1")
    ratio, log_loss, log_constant = solution.x
    if not (frequency[0] <= ratio * top <= frequency[-1] and 1e-6 < np.exp(log_loss) < 1):
        raise InputError(
            "bell fit", f"the lines around {top:.3f} Hz are not the bell of one mode", "lower drop_db or look elsewhere"
        )
    return BellFit(
        natural_frequency_hz=float(ratio * top),
        damping_ratio=float(np.exp(log_loss) / 2),
        constant=float(np.exp(log_constant) * top ** (4 - 2 * differentiations)),
        lines=int(lines.size),
        log_rms=float(np.sqrt(np.mean(log_error(solution.x) ** 2))),
    )


def _bell(
    frequency_hz: NDArray[np.float64], power: NDArray[np.float64], near_hz: float, drop_db: float, search_hz: float
) -> NDArray[np.intp]:
    """Lines of the bell: from its top down to ``drop_db`` below, each side for itself."""
    near = np.flatnonzero(np.abs(frequency_hz - near_hz) <= search_hz)
    if not near.size:
        raise InputError(
            "bell fit", f"no line within {search_hz:g} Hz of {near_hz:g} Hz", "give a frequency in the band"
        )
    top = int(near[np.argmax(power[near])])
    low = top - _reach(power[top::-1], drop_db)
    high = top + _reach(power[top:], drop_db)
    return np.arange(low, high + 1)


def _reach(flank: NDArray[np.float64], drop_db: float) -> int:
    """Lines from the top, first of ``flank``, to the drop or to the trough before a rise of 3 dB."""
    from scipy.ndimage import uniform_filter1d

    below = np.flatnonzero(flank < flank[0] * 10 ** (-drop_db / 10))
    end = int(below[0]) if below.size else flank.size
    calm = np.minimum(uniform_filter1d(flank, 3, mode="nearest"), flank[0])
    lowest = np.minimum.accumulate(calm)
    rises = np.flatnonzero(calm[:end] > 2 * lowest[:end])
    if rises.size:
        end = int(np.argmin(calm[: rises[0]])) + 1
    return max(end - 1, 0)


def _bell_model(ratio: NDArray[np.float64], natural: float, loss: float, differentiations: int) -> NDArray[np.float64]:
    receptance = 1 / ((natural**2 - ratio**2) ** 2 + (loss * natural * ratio) ** 2)
    return np.asarray(receptance * ratio ** (2 * differentiations))


def _fraction(ratio: NDArray[np.float64], power: NDArray[np.float64], differentiations: int) -> tuple[float, ...]:
    """Linear start: r^(2d)/power = (r^4 + a r^2 + b) / c, weighted by the power itself."""
    inverse = ratio ** (2 * differentiations) / power
    columns = np.stack([ratio**4, ratio**2, np.ones_like(ratio)], axis=1)
    u, v, w = np.linalg.lstsq(columns * power[:, None], inverse * power, rcond=None)[0]
    square = np.sqrt(max(w / u, 1e-12))
    return float(square), float(max(v / u + 2 * square, 0) / square), float(1 / max(u, 1e-300))
