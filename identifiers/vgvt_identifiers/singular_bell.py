"""The bell of one mode among singular values: chosen by shape, fitted with a second-order fraction.

The lines of a mode are those, counted outward from its peak, at which some singular vector
resembles the vector of the peak (MAC); their singular values are the density of one
degree of freedom. A second-order transfer function is fitted to them: denominator
|w_k^2 - w^2 + 2 i zeta w_k w|^2, w^4 for accelerations, and a numerator that may be
constant or a quadratic, which takes up what the neighbouring modes add.
Schulze, Thompson, Danowsky, Lee and Harris, System identification and modal
extraction from response data, AIAA Atmospheric Flight Mechanics, 2013.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.output_spectra import Decomposition

_FEWEST_LINES = 7
_RELATIVE_FLOOR = 1e-4
_GAP_LINES = 3
_NUMERATOR_FLOOR = 1e-12
_LEAST_WIDTH = 0.02  # half width in lines of a bell of which the lines say no more than that it is narrow


@dataclass(frozen=True, slots=True, eq=False)
class Bell:
    """Lines (L,) of one mode, which singular value was taken on each (L,), and the mode's vector (D,), unit length."""

    lines: NDArray[np.intp]
    order: NDArray[np.intp]
    vector: NDArray[np.complex128]


@dataclass(frozen=True, slots=True)
class FittedBell:
    """Natural frequency, damping ratio, their standard deviations, lines used, and errors.

    ``chi_square`` is the weighted error per degree of freedom, ``log_rms`` the plain one of the logarithm.
    A bell that is not ``resolved`` is far narrower than a line: any such damping fits, and its deviation is
    what a quarter of a line is worth.
    """

    natural_frequency_hz: float
    damping_ratio: float
    natural_frequency_std_hz: float
    damping_ratio_std: float
    lines: int
    chi_square: float
    log_rms: float
    converged: bool
    resolved: bool


def mode_bell(
    found: Decomposition, peak: int, least_mac: float, drop_db: float, order: int = 0, fewest: int = _FEWEST_LINES
) -> Bell:
    """The bell around line ``peak`` of singular value ``order``: MAC at least ``least_mac``, at most ``drop_db`` down.

    The vector is the dominant one over the upper 3 dB of the bell, so that no single noisy line decides.
    """
    vector = found.vectors[peak, :, order]
    top = float(found.values[order, peak])
    for drop in (3.0, drop_db):
        down, taken_down = _walk(found, vector, peak, -1, top, least_mac, drop, fewest // 2)
        up, taken_up = _walk(found, vector, peak, 1, top, least_mac, drop, fewest // 2)
        lines = np.array([*down[::-1], peak, *up])
        taken = np.array([*taken_down[::-1], order, *taken_up])
        high = found.values[taken, lines] >= 0.5 * top
        rows = found.vectors[lines[high], :, taken[high]] * np.sqrt(found.values[taken[high], lines[high]])[:, None]
        vector = np.linalg.svd(rows, full_matrices=False)[2][0]
    return Bell(lines, taken, np.asarray(vector))


def _walk(
    found: Decomposition,
    vector: NDArray[np.complex128],
    peak: int,
    step: int,
    top: float,
    least_mac: float,
    drop_db: float,
    fewest: int,
) -> tuple[list[int], list[int]]:
    """Lines from the peak outward, until the shape changes for good, the value has dropped, or it rises again."""
    lines: list[int] = []
    taken: list[int] = []
    strange, lowest = 0, top
    for line in range(peak + step, found.frequency_hz.size if step > 0 else -1, step):
        alike = np.abs(vector.conj() @ found.vectors[line]) ** 2 / float(np.vdot(vector, vector).real)
        best = int(np.argmax(alike))
        value = float(found.values[best, line])
        near = len(lines) + strange < fewest
        spread = 1 + 3 * float(found.relative_std[best, line])
        if not near and (value < top * 10 ** (-drop_db / 10) or value > 2 * spread * lowest):
            break
        if alike[best] < least_mac or value < 4 * found.noise[best, line]:
            strange += 1
            if strange >= _GAP_LINES:
                break
            continue
        strange = 0
        lowest = min(lowest, value)
        lines.append(line)
        taken.append(best)
    return lines, taken


def fit_bell(found: Decomposition, bell: Bell, general: bool = True) -> FittedBell | None:
    """Least squares of the fraction to the logarithm of the bell, weighted by its scatter; None for what is no bell.

    Standard deviations follow from the scatter of the lines, enlarged where the fit is worse than that scatter.
    """
    frequency = found.frequency_hz[bell.lines]
    value = found.values[bell.order, bell.lines] - found.noise[bell.order, bell.lines]
    sound = value > 0
    frequency, value = frequency[sound], value[sound]
    unknowns = 5 if general else 3
    if frequency.size < unknowns + 1:
        return None
    scatter = np.hypot(found.relative_std[bell.order, bell.lines][sound], _RELATIVE_FLOOR)
    step = float(found.frequency_hz[1] - found.frequency_hz[0])
    start = _start(frequency, value, step)
    problem = _Problem(frequency, np.log(value), scatter, start[0], start[1], found.window, general)
    return _solved(problem, found.shared_lines, step)


@dataclass(frozen=True, slots=True, eq=False)
class _Problem:
    """The bell to be fitted; parameters are (f - centre) / half, log(zeta centre / half), log level, tilt, rest."""

    frequency_hz: NDArray[np.float64]
    log_value: NDArray[np.float64]
    scatter: NDArray[np.float64]
    centre_hz: float
    half_hz: float
    window: tuple[NDArray[np.float64], NDArray[np.float64]] | None
    general: bool

    def error(self, parameters: NDArray[np.float64]) -> NDArray[np.float64]:
        """Weighted error of the logarithm (L,)."""
        model = self._averaged(self._density(self._lines(), parameters))
        return np.asarray((self.log_value - np.log(model) - parameters[2]) / self.scatter)

    def slope(self, parameters: NDArray[np.float64]) -> NDArray[np.float64]:
        """Derivative (L, 5) of the error."""
        lines = self._lines()
        density = self._density(lines, parameters)
        slopes = [self._averaged(density * part) for part in self._log_slopes(lines, parameters)]
        shape = np.stack(slopes, axis=1) / self._averaged(density)[:, None]
        columns = np.hstack([shape[:, :2], np.ones((shape.shape[0], 1)), shape[:, 2:]])
        return np.asarray(-columns / self.scatter[:, None])

    def _lines(self) -> NDArray[np.float64]:
        return self.frequency_hz if self.window is None else self.frequency_hz[:, None] + self.window[0]

    def _averaged(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return values if self.window is None else np.asarray(values @ self.window[1])

    def _parts(
        self, frequency_hz: NDArray[np.float64], parameters: NDArray[np.float64]
    ) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
        """Natural frequency, and the two parts of the denominator that are squared, spring over mass and damping."""
        natural = float(self.centre_hz + self.half_hz * parameters[0])
        half = self.half_hz * np.exp(parameters[1])  # zeta times the natural frequency
        return natural, (natural**2 - frequency_hz**2) / (2 * natural), half * frequency_hz / natural

    def _density(self, frequency_hz: NDArray[np.float64], parameters: NDArray[np.float64]) -> NDArray[np.float64]:
        _, elastic, damping = self._parts(frequency_hz, parameters)
        y = (frequency_hz - self.centre_hz) / self.half_hz
        numerator = 1.0 + np.zeros_like(y)
        if self.general:
            numerator = (1 + parameters[3] * y) ** 2 + parameters[4] * y**2
        return np.asarray(np.maximum(numerator, _NUMERATOR_FLOOR) * frequency_hz**4 / (elastic**2 + damping**2))

    def _log_slopes(
        self, frequency_hz: NDArray[np.float64], parameters: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], ...]:
        """Derivatives of the logarithm of the density by frequency, damping, tilt and rest."""
        natural, elastic, damping = self._parts(frequency_hz, parameters)
        size = elastic**2 + damping**2
        stiffer = elastic * (1 + (frequency_hz / natural) ** 2) - 2 * damping**2 / natural
        y = (frequency_hz - self.centre_hz) / self.half_hz
        tilted = 1 + parameters[3] * y
        numerator = tilted**2 + parameters[4] * y**2
        moves = np.where(numerator > _NUMERATOR_FLOOR, y / np.maximum(numerator, _NUMERATOR_FLOOR), 0.0)
        return -self.half_hz * stiffer / size, -2 * damping**2 / size, 2 * tilted * moves, y * moves


def _start(frequency: NDArray[np.float64], value: NDArray[np.float64], step_hz: float) -> tuple[float, float]:
    """Centre and half width in Hz: a parabola through f^4 / value over the upper lines (linear least squares)."""
    top = int(np.argmax(value))
    inverse = value[top] / value * (frequency / frequency[top]) ** 4
    high = value > 0.1 * value[top]
    if high.sum() < 4:
        high = np.abs(np.arange(value.size) - top) <= 3
    y = (frequency - frequency[top]) / step_hz
    a, b, c = np.linalg.lstsq(
        np.stack([y[high] ** 2, y[high], np.ones(int(high.sum()))], axis=1) / inverse[high][:, None],
        np.ones(int(high.sum())),
        rcond=None,
    )[0]
    if a > 0:
        shift = float(np.clip(-b / (2 * a), -2, 2))
        half = float(np.sqrt(max(c / a - (b / (2 * a)) ** 2, 0.01)))
    else:
        shift, half = 0.0, 1.0
    return float(frequency[top] + shift * step_hz), max(half, 0.05) * step_hz


def _solved(problem: _Problem, shared_lines: float, step_hz: float) -> FittedBell | None:
    from scipy.optimize import least_squares

    zero = problem.error(np.zeros(5))
    level = float(np.median(zero * problem.scatter))
    start = np.array([0.0, 0.0, level, 0.0, 1e-3])
    size = 5 if problem.general else 3
    widest = float(np.log(max(problem.centre_hz / problem.half_hz, 2.0)))
    low = np.array([-np.inf, -8.0, -np.inf, -np.inf, 0.0])[:size]
    high = np.array([np.inf, widest, np.inf, np.inf, np.inf])[:size]

    def error(parameters: NDArray[np.float64]) -> NDArray[np.float64]:
        return problem.error(np.concatenate([parameters, np.zeros(5 - size)]))

    def slope(parameters: NDArray[np.float64]) -> NDArray[np.float64]:
        return problem.slope(np.concatenate([parameters, np.zeros(5 - size)]))[:, :size]

    solution = least_squares(error, start[:size], jac=slope, bounds=(low, high), x_scale="jac", max_nfev=200)
    natural = problem.centre_hz + problem.half_hz * float(solution.x[0])
    half = problem.half_hz * float(np.exp(solution.x[1]))
    inside = problem.frequency_hz[0] <= natural <= problem.frequency_hz[-1]
    if not inside or half > 0.5 * natural:
        return None
    freedom = max(problem.frequency_hz.size - size, 1)
    chi_square = float(2 * solution.cost / freedom)
    resolved = half > _LEAST_WIDTH * step_hz and not solution.active_mask[1]
    jacobian = solution.jac.copy()
    if not resolved:
        jacobian[:, 1] = 0.0  # at its bound the damping has no slope left, which is no certainty
    covariance = np.linalg.pinv(jacobian.T @ jacobian) * max(chi_square, 1.0) * shared_lines
    damping = half / natural
    return FittedBell(
        natural_frequency_hz=natural,
        damping_ratio=damping,
        natural_frequency_std_hz=problem.half_hz * float(np.sqrt(covariance[0, 0])),
        damping_ratio_std=damping * float(np.sqrt(covariance[1, 1])) if resolved else step_hz / 4 / natural,
        lines=int(problem.frequency_hz.size),
        chi_square=chi_square,
        log_rms=float(np.sqrt(np.mean((solution.fun * problem.scatter) ** 2))),
        converged=bool(solution.success),
        resolved=resolved,
    )
