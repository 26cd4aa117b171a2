"""Least squares of a discrete state-space model with common poles on frequency responses, by variable projection.

G_o(e^iw) = d_o + sum_n [c_on / (e^iw - z_n) + conj], z_n = exp(x_n): outputs o are
linear in c and d, so only the exponents x are searched for; Golub and Pereyra, SIAM J.
Numer. Anal. 10(2), 1973, with Kaufman's Jacobian, BIT 15(1), 1975.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_RELATIVE_STEP = 1e-5
_RELATIVE_FALL = 1e-8
_LARGEST_DAMPING = 1e10


@dataclass(frozen=True, slots=True, eq=False)
class Responses:
    """Frequency responses (R, K) with weights of responses (R,) and lines (K,); their product is 1 / deviation."""

    values: NDArray[np.complex128]
    row_weight: NDArray[np.float64]
    line_weight: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class OutputErrorFit:
    """Exponents x (n,) of the roots z = exp x, and their spread.

    ``covariance`` holds the variances (n,) of the real and of the imaginary parts
    and the covariance of the two; ``cost`` is the weighted squared error per degree of freedom.
    """

    exponents: NDArray[np.complex128]
    covariance: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
    cost: float
    converged: bool


@dataclass(frozen=True, slots=True, eq=False)
class _Normal:
    """Squared error, Gauss-Newton matrix (2n, 2n), gradient (2n,) and, if asked for, the squared scores (2n, 2n)."""

    cost: float
    matrix: NDArray[np.float64]
    gradient: NDArray[np.float64]
    scores: NDArray[np.float64]


def fit_output_error(
    angle: NDArray[np.float64], blocks: tuple[Responses, ...], start: NDArray[np.complex128], iterations: int
) -> OutputErrorFit:
    """Exponents of least error from ``start`` (n,), over K lines, each the mean over m places ``angle`` (K, m).

    Angles are in radians a sample. Means of neighbouring lines, of model and data alike, save work.
    Levenberg-Marquardt; roots stay inside the unit circle. Standard deviations are
    the larger of two: errors independent from response to response, or shared by the
    responses of a run, as noise of the force is (White, Econometrica 48, 1980).
    """
    x = _inside(start)
    here, damping, converged = _normal(angle, blocks, x), 1e-3, iterations == 0
    for _ in range(iterations):
        scale = np.maximum(np.diag(here.matrix), 1e-12 * np.diag(here.matrix).max())
        step = -np.linalg.solve(here.matrix + damping * np.diag(scale), here.gradient)
        move = step[: x.size] + 1j * step[x.size :]
        trial = x + move
        if trial.real.max() < 0 and trial.imag.min() > 0 and trial.imag.max() < np.pi:
            there = _normal(angle, blocks, trial)
            if there.cost <= here.cost:
                small = bool(np.all(np.abs(move) < _RELATIVE_STEP * np.abs(x.real)))
                converged = small or here.cost - there.cost < _RELATIVE_FALL * here.cost
                x, here, damping = trial, there, max(damping / 10, 1e-12)
                if converged:
                    break
                continue
        damping *= 10
        if damping > _LARGEST_DAMPING:
            break
    return _spread(angle, blocks, x, here, converged)


def _spread(
    angle: NDArray[np.float64], blocks: tuple[Responses, ...], x: NDArray[np.complex128], here: _Normal, converged: bool
) -> OutputErrorFit:
    unknowns = 2 * x.size + 1
    freedom = sum((2 * angle.shape[0] - unknowns) * b.row_weight.size for b in blocks) - 2 * x.size
    cost = here.cost / max(freedom, 1)
    inverse = np.linalg.pinv(here.matrix, hermitian=True)
    shared, n = inverse @ here.scores @ inverse, x.size
    plain = inverse * max(cost, np.finfo(float).tiny)
    larger = np.diag(shared) > np.diag(plain)
    spread = np.where(larger, np.diag(shared), np.diag(plain))
    # The sign and size of the correlation come along from the matrix that gives the larger variance.
    cross = np.where(larger[:n] & larger[n:], np.diag(shared, n), np.diag(plain, n))
    return OutputErrorFit(x, (spread[:n], spread[n:], cross), cost, converged)


def _inside(x: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Exponents with decay, at angles between 0 and pi."""
    decay = np.maximum(np.abs(x.real), 1e-6)
    return np.asarray(-decay + 1j * np.clip(np.abs(x.imag), 1e-4, np.pi - 1e-4))


def _normal(angle: NDArray[np.float64], blocks: tuple[Responses, ...], x: NDArray[np.complex128]) -> _Normal:
    """The normal equations of all blocks; those with the same line weights share one factorisation."""
    n = x.size
    total = _Normal(0.0, np.zeros((2 * n, 2 * n)), np.zeros(2 * n), np.zeros((2 * n, 2 * n)))
    columns, slopes = _columns(angle, x)
    for weight, data in _grouped(blocks):
        basis, triangle = np.linalg.qr(_stacked(columns * weight[:, None]))
        right = basis.T @ data
        error = data - basis @ right
        coefficients = np.linalg.lstsq(triangle, right, rcond=1e-13)[0]
        rest = _stacked(slopes * weight[:, None])
        rest -= basis @ (basis.T @ rest)
        part = _contracted(rest, coefficients[: 2 * n], error, n)
        total = _Normal(
            total.cost + float((error**2).sum()),
            total.matrix + part[0],
            total.gradient + part[1],
            total.scores + part[2],
        )
    return total


def _contracted(
    rest: NDArray[np.float64], coefficients: NDArray[np.float64], error: NDArray[np.float64], n: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Gauss-Newton matrix, gradient and squared scores, contracted over the responses.

    With the slopes ``rest`` (2K, 2n) of the two columns of a pole, less what the columns
    themselves explain, and its coefficients a and b: d(error)/d(Re x) = -(first a + second b) and
    d(error)/d(Im x) = -(second a - first b).
    """
    a, b = coefficients[:n], coefficients[n:]
    first, second = rest[:, :n], rest[:, n:]
    gram = rest.T @ rest
    g11, g12, g22 = gram[:n, :n], gram[:n, n:], gram[n:, n:]
    aa, ab, bb = a @ a.T, a @ b.T, b @ b.T
    rr = g11 * aa + g12 * ab + g12.T * ab.T + g22 * bb
    ii = g22 * aa - g12.T * ab - g12 * ab.T + g11 * bb
    ri = g12 * aa - g11 * ab + g22 * ab.T - g12.T * bb
    # The score of a line sums over the responses that share it.
    ea, eb = error @ a.T, error @ b.T
    score = -np.hstack([first * ea + second * eb, second * ea - first * eb])
    return np.block([[rr, ri], [ri.T, ii]]), score.sum(axis=0), score.T @ score


def _columns(
    angle: NDArray[np.float64], x: NDArray[np.complex128]
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Columns (K, 2n + 1) of the model, and the slopes (K, 2n) of a pole's two columns in its exponent."""
    z, turn = np.exp(x), np.exp(1j * angle.reshape(-1))[:, None]
    above, below = 1 / (turn - z), 1 / (turn - z.conj())
    rise, fall = (_mean(m, angle.shape) for m in (z * above**2, z.conj() * below**2))
    above, below = _mean(above, angle.shape), _mean(below, angle.shape)
    columns = np.hstack([above + below, 1j * (above - below), np.ones((angle.shape[0], 1))])
    return columns, np.hstack([rise + fall, 1j * (rise - fall)])


def _mean(matrix: NDArray[np.complex128], shape: tuple[int, ...]) -> NDArray[np.complex128]:
    """Rows (K m, n) averaged over the m places of each line."""
    return matrix if shape[1] == 1 else np.asarray(matrix.reshape(*shape, -1).mean(axis=1))


def _grouped(blocks: tuple[Responses, ...]) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Line weights (K,) and weighted real data (2K, R), blocks of equal line weights taken together."""
    groups: dict[bytes, list[Responses]] = {}
    for block in blocks:
        groups.setdefault(block.line_weight.tobytes(), []).append(block)
    for same in groups.values():
        weight = same[0].line_weight
        values = np.concatenate([b.values * b.row_weight[:, None] for b in same])
        yield weight, _stacked(np.asarray((values * weight).T, dtype=complex))


def _stacked(matrix: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Real over imaginary parts of the rows."""
    return np.vstack([matrix.real, matrix.imag])
