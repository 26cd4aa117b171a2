"""Maximum-likelihood fit of poles common to many frequency responses, over the whole band at once.

A_o(s) = s^2 sum_m [R_om / (s - p_m) + conj] + rest_o(s) + T_o(s) / F(s) + noise

Residues, rest and transient of every response are linear and projected out
(Golub and Pereyra, SIAM J. Numer. Anal. 10(2), 1973), so that only the poles
are searched for. The tails of a mode far from its peak fix its residue, and a
residue that is known better leaves more of the peak to its pole: a fit in a window with a free
background would know damping up to half as well again as this one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

_STEPS = 30
_FACTOR = 2.0  # no pole changes its damping by more, or moves by more of its own widths, in one step
_RANK = 1e-13
_NARROWEST = 1e-6
_LEAST_TILT = 0.15  # least imaginary over real part: a damping ratio of 0.99


@dataclass(frozen=True, slots=True, eq=False)
class FitRows:
    """Responses of one run: ratios (R, K), weights 1/std of a real or imaginary part (R or 1, K), inverse force (K,).

    One row of weights serves all responses, whose ratios are then scaled by
    ``row_scale`` (R,). Weight zero leaves a line out. Without ``inverse_force`` no transient is fitted;
    ``ringing`` (N,) tells which poles have one, all if left out.
    """

    values: NDArray[np.complex128]
    weight: NDArray[np.float64]
    row_scale: NDArray[np.float64]
    inverse_force: NDArray[np.complex128] | None = None
    ringing: NDArray[np.bool_] | None = None

    def transients(self, count: int) -> NDArray[np.intp]:
        """Which of ``count`` poles ring at the ends of the record."""
        if self.inverse_force is None:
            return np.arange(0)
        return np.arange(count) if self.ringing is None else np.flatnonzero(self.ringing)


@dataclass(frozen=True, slots=True, eq=False)
class PoleProblem:
    """What is fitted: lines (K,) in Hz, the runs, and how many real terms stand for modes below and above."""

    frequency_hz: NDArray[np.float64]
    rows: tuple[FitRows, ...]
    lower_terms: int = 2
    upper_terms: int = 2


@dataclass(frozen=True, slots=True, eq=False)
class PoleState:
    """A set of poles (N,) and what follows from it.

    ``cost`` is the weighted sum of squares; ``information`` (2 N, 2 N) and
    ``gradient`` (2 N,) belong to all real parts, then all imaginary parts;
    ``gain`` (N,) is what the cost rises by if a mode is left out of every response. Per
    run: ``ring_gain`` (N,) is the same for the transients, ``residues`` (R, N) receptance,
    ``smooth`` (R, K) without and ``errors`` (R, K) with the transient taken off.
    """

    poles: NDArray[np.complex128]
    cost: float
    gradient: NDArray[np.float64]
    information: NDArray[np.float64]
    gain: NDArray[np.float64]
    ring_gain: tuple[NDArray[np.float64], ...]
    residues: tuple[NDArray[np.complex128], ...]
    smooth: tuple[NDArray[np.complex128], ...]
    errors: tuple[NDArray[np.complex128], ...]
    converged: bool = False

    def covariance(self, free: NDArray[np.bool_] | None = None) -> NDArray[np.float64]:
        """Inverse information (2 N, 2 N), (rad/s)^2: the covariance if the weights are right.

        Poles that are not ``free`` (N,) count as known: their rows and columns are zero.
        """
        moving = np.arange(2 * self.poles.size) if free is None else np.flatnonzero(np.tile(free, 2))
        matrix = self.information[np.ix_(moving, moving)]
        size = _sizes(matrix)
        whole = np.zeros_like(self.information)
        scaled = np.linalg.pinv(matrix / size[:, None] / size, rcond=_RANK, hermitian=True)
        whole[np.ix_(moving, moving)] = scaled / size[:, None] / size
        return whole


def fit_poles(
    problem: PoleProblem,
    start: NDArray[np.complex128],
    steps: int = _STEPS,
    free: NDArray[np.bool_] | None = None,
) -> PoleState:
    """The poles of largest likelihood near ``start`` (N,), rad/s in the upper left quarter plane.

    Levenberg-Marquardt with steps limited to a few widths of each pole; poles that are not
    ``free`` (N,) stay. ``converged`` is False when ``steps`` were not enough.
    """
    state = evaluate(problem, np.asarray(start, dtype=np.complex128))
    damping = 1e-3
    for _ in range(steps):
        step = limited_step(state.poles, _newton_step(state, damping, free))
        expected = _expected_fall(state, step)
        trial = evaluate(problem, state.poles + step)
        if trial.cost <= state.cost:
            small = expected < 1e-4 or bool(np.all(np.abs(step) < 1e-8 * np.abs(state.poles.real)))
            state, damping = trial, max(damping / 10, 1e-9)
            if small:
                return _with(state, True)
        else:
            # Round-off of the cost hides falls this small: there is nothing left to gain.
            if expected < 1e-4 + 1e-12 * state.cost:
                return _with(state, True)
            damping *= 10
            if damping > 1e8:
                return state
    return state


def evaluate(problem: PoleProblem, poles: NDArray[np.complex128]) -> PoleState:
    """Cost, derivatives and linear unknowns for poles (N,) rad/s; nothing is moved."""
    columns = _Columns(problem, poles)
    count = poles.size
    cost, gradient, information = 0.0, np.zeros(2 * count), np.zeros((2 * count, 2 * count))
    gain = np.zeros(count)
    ring_gain, residues, smooth, errors = [], [], [], []
    for rows in problem.rows:
        part = _solve(columns, rows)
        cost += part.cost
        gradient += part.gradient
        information += part.information
        gain += part.gain
        ring_gain.append(part.ring_gain)
        residues.append(part.residues)
        smooth.append(part.smooth)
        errors.append(part.errors)
    runs = (tuple(ring_gain), tuple(residues), tuple(smooth), tuple(errors))
    return PoleState(poles, cost, gradient, information, gain, *runs)


def projected_slopes(problem: PoleProblem, state: PoleState) -> Iterator[tuple[int, int, NDArray[np.complex128]]]:
    """Run, response and the derivative (2 N, K) of its weighted fit by the poles, linear unknowns taken out."""
    columns = _Columns(problem, state.poles)
    for which, rows in enumerate(problem.rows):
        linear, slopes = _run_columns(columns, rows)
        solved = None
        for row in range(rows.values.shape[0]):
            weight = rows.weight[min(row, rows.weight.shape[0] - 1)]
            target = _real(rows.values[[row]] * rows.row_scale[[row], None] * weight)
            if solved is None or rows.weight.shape[0] > 1:
                solved = _Projection(_real(linear * weight), _real(slopes * weight), target)
            coefficients = solved.solve(target)
            wide, ringing = columns.smooth.shape[0], rows.transients(columns.count)
            turned = _slope_factors(coefficients, columns.count, wide, ringing)[0]
            yield which, row, (turned.T @ solved.projected).view(np.complex128)


class _Columns:
    """The functions of frequency that every run shares, (..., K), before force and weights."""

    __slots__ = ("bare", "count", "line", "scale", "slope", "smooth", "smooth_slope")

    def __init__(self, problem: PoleProblem, poles: NDArray[np.complex128]) -> None:
        s = 2j * np.pi * problem.frequency_hz
        self.count = poles.size
        above, below = 1 / (s - poles[:, None]), 1 / (s - poles.conj()[:, None])
        self.bare = _pair(above, below)
        self.slope = _pair(above**2, below**2)
        self.scale = 1 / np.abs(poles) ** 2
        size = s.imag**2 * -np.tile(self.scale, 2)[:, None]
        self.line = s / abs(s[s.size // 2])
        powers = [*-np.arange(problem.lower_terms), *np.arange(1, problem.upper_terms + 1)]
        self.smooth = np.vstack([size * self.bare, *(self.line**n for n in powers)])
        self.smooth_slope = size * self.slope


def _pair(above: NDArray[np.complex128], below: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Rows (2 N, K) for the real and the imaginary part of a complex factor of ``above``, conjugate with below."""
    return np.vstack([above + below, 1j * (above - below)])


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    cost: float
    gradient: NDArray[np.float64]
    information: NDArray[np.float64]
    gain: NDArray[np.float64]
    ring_gain: NDArray[np.float64]
    residues: NDArray[np.complex128]
    smooth: NDArray[np.complex128]
    errors: NDArray[np.complex128]


def _solve(columns: _Columns, rows: FitRows) -> _Part:
    """Project one run: rows that share their weights at once, others one by one."""
    linear, slopes = _run_columns(columns, rows)
    shared = rows.weight.shape[0] == 1
    groups = [slice(None)] if shared else [slice(i, i + 1) for i in range(rows.values.shape[0])]
    found = np.zeros((rows.values.shape[0], linear.shape[0]))
    cost, size = 0.0, 2 * columns.count
    gradient, information = np.zeros(size), np.zeros((size, size))
    gain, ring_gain, ringing = np.zeros(columns.count), np.zeros(columns.count), rows.transients(columns.count)
    wide = columns.smooth.shape[0]
    for group in groups:
        weight = rows.weight[0 if shared else group.start]
        target = _real(rows.values[group] * rows.row_scale[group, None] * weight)
        solved = _Projection(_real(linear * weight), _real(slopes * weight), target)
        found[group] = solved.coefficients.T
        cost += float((solved.error**2).sum())
        turned = _slope_factors(solved.coefficients, columns.count, wide, ringing)
        gradient += np.einsum("rcq,cr->q", turned, solved.projected @ solved.error.T)
        information += np.einsum("rcp,cd,rdq->pq", turned, solved.schur, turned, optimize=True)
        gain += _gains(solved, 0, columns.count)
        ring_gain[ringing] += _gains(solved, wide, ringing.size)
    found = found / rows.row_scale[:, None]
    smooth = (found[:, :wide] @ _real(columns.smooth)).view(np.complex128)
    errors = rows.values - smooth
    if rows.inverse_force is not None:
        errors = errors - (found[:, wide:] @ _real(linear[wide:])).view(np.complex128)
    complete = found[:, : columns.count] + 1j * found[:, columns.count : size]
    residues = np.asarray(complete * columns.scale, complex)
    return _Part(cost, gradient, information, gain, ring_gain, residues, smooth, errors)


def _run_columns(columns: _Columns, rows: FitRows) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Linear functions (m, K) of a run and its slopes (c, K), transient included."""
    if rows.inverse_force is None:
        return columns.smooth, columns.smooth_slope
    inverse = rows.inverse_force
    own = rows.transients(columns.count)
    pairs = np.concatenate([own, columns.count + own])
    ends = np.vstack([columns.bare[pairs], np.ones_like(inverse), columns.line]) * inverse
    return np.vstack([columns.smooth, ends]), np.vstack([columns.smooth_slope, columns.slope[pairs] * inverse])


def _real(rows: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Complex rows (m, K) as real ones (m, 2 K), real and imaginary parts by turns; nothing is copied."""
    return np.ascontiguousarray(rows).view(np.float64)


class _Projection:
    """Weighted least squares of targets (R, 2 K) on functions (m, 2 K).

    ``projected`` (c, 2 K) are the slopes without what the functions can imitate, ``schur`` (c, c) their Gram matrix.
    """

    __slots__ = ("_functions", "_inverse", "_size", "coefficients", "error", "inverse", "projected", "schur")

    def __init__(
        self, functions: NDArray[np.float64], slopes: NDArray[np.float64], target: NDArray[np.float64]
    ) -> None:
        self._functions = functions
        gram = functions @ functions.T
        self._size = np.sqrt(np.diag(gram))
        self._size[self._size == 0] = 1.0
        self._inverse = np.linalg.pinv(gram / self._size[:, None] / self._size, rcond=_RANK, hermitian=True)
        self.coefficients = self.solve(target)
        self.error = target - self.coefficients.T @ functions
        # The difference of two Gram matrices would lose what is known of a pole that the functions nearly imitate.
        self.projected = slopes - self.solve(slopes).T @ functions
        self.schur = self.projected @ self.projected.T
        self.inverse = self._inverse / self._size[:, None] / self._size

    def solve(self, target: NDArray[np.float64]) -> NDArray[np.float64]:
        """Coefficients (m, R) of targets (R, 2 K)."""
        found = self._solved(target)
        # Normal equations lose half the digits; one correction brings them back.
        return found + self._solved(target - found.T @ self._functions)

    def _solved(self, target: NDArray[np.float64]) -> NDArray[np.float64]:
        moments = (self._functions @ target.T) / self._size[:, None]
        return np.asarray((self._inverse @ moments) / self._size[:, None])


def _slope_factors(
    coefficients: NDArray[np.float64], count: int, wide: int, ringing: NDArray[np.intp]
) -> NDArray[np.float64]:
    """What each row (R, c, 2 N) makes of the slope columns when a real (first N) or imaginary part of a pole moves.

    ``ringing`` are the poles whose transients follow after ``wide`` columns.
    """
    turned = np.zeros((coefficients.shape[1], 2 * (count + ringing.size), 2 * count))
    for start, place, poles in ((0, 0, np.arange(count)), (wide, 2 * count, ringing)):
        size = poles.size
        real, imaginary = coefficients[start : start + size].T, coefficients[start + size : start + 2 * size].T
        first, second = place + np.arange(size), place + size + np.arange(size)
        turned[:, first, poles], turned[:, second, poles] = real, imaginary
        # i (r + i q) = -q + i r
        turned[:, first, count + poles], turned[:, second, count + poles] = -imaginary, real
    return turned


def _gains(solved: _Projection, start: int, count: int) -> NDArray[np.float64]:
    """Rise of the cost (count,) when both parts of a pair of columns are forced to zero in all rows of the group."""
    real, imaginary = start + np.arange(count), start + count + np.arange(count)
    first, second = solved.coefficients[real], solved.coefficients[imaginary]
    # The quadratic form of a pair's coefficients with the inverse of their covariance, two by two.
    own, cross, other = (solved.inverse[i, j] for i, j in ((real, real), (real, imaginary), (imaginary, imaginary)))
    squares = other * (first**2).sum(axis=1) - 2 * cross * (first * second).sum(axis=1) + own * (second**2).sum(axis=1)
    size = own * other - cross**2
    # A pair that nothing tells apart from the rest has no evidence of its own.
    known = size > 1e-14 * own * other
    return np.asarray(np.divide(squares, size, out=np.zeros(count), where=known))


def _newton_step(state: PoleState, damping: float, free: NDArray[np.bool_] | None) -> NDArray[np.complex128]:
    moving = np.arange(2 * state.poles.size) if free is None else np.flatnonzero(np.tile(free, 2))
    matrix = state.information[np.ix_(moving, moving)]
    size = _sizes(matrix)
    matrix = matrix / size[:, None] / size + damping * np.eye(size.size)
    step = np.zeros(2 * state.poles.size)
    step[moving] = np.linalg.solve(matrix, state.gradient[moving] / size) / size
    return np.asarray(step[: state.poles.size] + 1j * step[state.poles.size :])


def _sizes(information: NDArray[np.float64]) -> NDArray[np.float64]:
    """Roots of the diagonal, one where nothing is known."""
    diagonal = np.diag(information)
    return np.asarray(np.sqrt(np.where(diagonal > 0, diagonal, 1.0)))


def limited_step(poles: NDArray[np.complex128], step: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """A step (N,) of poles (N,) with each kept stable, its damping within a factor and its move within its width."""
    width = -poles.real
    # What is a millionth as wide as it is high in frequency no record resolves.
    most = np.maximum(np.minimum((1 - 1 / _FACTOR) * width, width - _NARROWEST * np.abs(poles)), 0.0)
    real = np.clip(step.real, -(_FACTOR - 1) * width, most)
    # On the real axis a pole meets its conjugate: their residues grow without bounds, and digits are lost.
    lowest = _LEAST_TILT * (width - real) - poles.imag
    return np.asarray(real + 1j * np.maximum(np.clip(step.imag, -_FACTOR * width, _FACTOR * width), lowest))


def _expected_fall(state: PoleState, step: NDArray[np.complex128]) -> float:
    vector = np.concatenate([step.real, step.imag])
    return float(abs(2 * vector @ state.gradient - vector @ state.information @ vector))


def _with(state: PoleState, converged: bool) -> PoleState:
    return replace(state, converged=converged)
