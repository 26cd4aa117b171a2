"""Weighted least squares of many rows on one design, which is factored once.

Rows that measure the same lines differ in their weights only. With D W0 = Q R for
the mean weights W0, the design of a row is (W / W0) Q R: its normal matrix
Q' (W / W0)^2 Q is no worse conditioned than the square of the ratios of weights, and costs one
product instead of a factorisation. Rows whose ratios span too much, or a design
near the loss of rank, are factored each on their own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_RANK = 1e-12
_WELL_CONDITIONED = 1e9
_LARGEST_RATIO = 1e6  # of squared weights: loses six of sixteen digits, at most


@dataclass(frozen=True, slots=True, eq=False)
class SolvedRows:
    """``coefficients`` (R, m), their ``variance`` (R, m) if the stated one is right, ``chi_square`` (R,) a freedom."""

    coefficients: NDArray[np.float64]
    variance: NDArray[np.float64]
    chi_square: NDArray[np.float64]


def solve_rows(
    design: NDArray[np.complex128], values: NDArray[np.complex128], variance: NDArray[np.float64]
) -> SolvedRows:
    """Real coefficients of ``design`` (K, m) for complex ``values`` (R, K) with variance E|error|^2 (R, K).

    Infinite variance switches a line off.
    """
    weights = _weights(values, variance)
    shared = _Shared.of(design, np.sqrt((weights**2).mean(axis=0))) if len(values) > 1 else None
    solved = []
    for value, weight in zip(values, weights, strict=True):
        both = None if shared is None else shared.solve(value, weight)
        solved.append(_alone(design, value, weight) if both is None else both)
    coefficients = np.array([s[0] for s in solved]).reshape(-1, design.shape[1])
    errors = weights * np.abs(values - coefficients @ design.T)
    freedom = np.maximum(2 * (weights > 0).sum(axis=1) - design.shape[1], 1)
    spread = np.array([s[1] for s in solved]).reshape(coefficients.shape)
    return SolvedRows(coefficients, spread, (errors**2).sum(axis=1) / freedom)


def _weights(values: NDArray[np.complex128], variance: NDArray[np.float64]) -> NDArray[np.float64]:
    # Half of E|e|^2 belongs to each part of a complex error.
    floor = 1e-24 * (np.abs(values) ** 2).max(axis=1, initial=0.0, keepdims=True) + np.finfo(float).tiny
    known = np.isfinite(variance)
    return np.where(known, 1 / np.sqrt(np.maximum(np.where(known, variance, 1.0), floor) / 2), 0.0)


_Solution = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Coefficients (m,) and their variance (m,)."""


@dataclass(frozen=True, slots=True, eq=False)
class _Shared:
    """Orthonormal ``basis`` (2, K, m), real and imaginary lines, of the design at ``weight`` (K,); ``back`` (m, m)."""

    weight: NDArray[np.float64]
    basis: NDArray[np.float64]
    back: NDArray[np.float64]

    @classmethod
    def of(cls, design: NDArray[np.complex128], weight: NDArray[np.float64]) -> _Shared | None:
        """None where the design is near the loss of rank."""
        matrix, size = _real_columns(design, weight)
        basis, triangle = np.linalg.qr(matrix)
        if not np.linalg.cond(triangle) < _WELL_CONDITIONED:
            return None
        return cls(weight, basis.reshape(2, weight.size, -1), np.linalg.inv(triangle) / size[:, None])

    def solve(self, values: NDArray[np.complex128], weight: NDArray[np.float64]) -> _Solution | None:
        """None where the weights differ too much from the shared ones."""
        used = self.weight > 0
        ratio = np.divide(weight, self.weight, out=np.zeros_like(weight), where=used) ** 2
        if not 0 < ratio[used].max() <= _LARGEST_RATIO * ratio[used].min():
            return None
        real, imag = self.basis
        normal = (real * ratio[:, None]).T @ real + (imag * ratio[:, None]).T @ imag
        right = (values.real * ratio * self.weight) @ real + (values.imag * ratio * self.weight) @ imag
        inverse = self.back @ np.linalg.inv(np.linalg.cholesky(normal)).T
        return self.back @ np.linalg.solve(normal, right), (inverse**2).sum(axis=1)


def _alone(design: NDArray[np.complex128], values: NDArray[np.complex128], weight: NDArray[np.float64]) -> _Solution:
    matrix, size = _real_columns(design, weight)
    right = np.concatenate([values.real * weight, values.imag * weight])
    # The triangle of [matrix | right] holds the projected right side too, so that no basis is formed.
    triangle = np.asarray(np.linalg.qr(np.hstack([matrix, right[:, None]]), mode="r"))
    columns = size.size
    inverse = np.linalg.pinv(triangle[:columns, :columns], rcond=_RANK)
    return inverse @ triangle[:columns, columns] / size, (inverse**2).sum(axis=1) / size**2


def _real_columns(
    design: NDArray[np.complex128], weight: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Weighted real over imaginary lines (2 K, m) with columns of size one, and the sizes (m,) they had."""
    matrix = np.empty((2 * weight.size, design.shape[1]))
    np.multiply(design.real, weight[:, None], out=matrix[: weight.size])
    np.multiply(design.imag, weight[:, None], out=matrix[weight.size :])
    size = np.sqrt(np.einsum("ij,ij->j", matrix, matrix))
    size[size == 0] = 1.0
    matrix /= size
    return matrix, size
