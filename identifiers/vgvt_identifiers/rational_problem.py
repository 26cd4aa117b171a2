"""The weighted rows of a rational fit and what they say of trial poles: cost, projected error, its slope.

Runs in which as many responses were measured are solved as one stack of equal
matrices, and what does not depend on the poles is made once.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

LEAKAGE_BACKGROUND = 2
_SINGULAR = 1e-10


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Rows that share their weights: values (R, K), weight (K,) = 1 / standard deviation, and row scales (R,).

    ``leakage`` (K,) is 1/F of the run, or None for responses free of leakage.
    """

    values: NDArray[np.complex128]
    weight: NDArray[np.float64]
    row_scale: NDArray[np.float64]
    leakage: NDArray[np.complex128] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Stack:
    """B blocks of R rows: weighted ``data`` (B, K, R), weights and weighted leakage (B, K, 1), fixed columns (B, K, m).

    Weighted columns of a design are in the order poles, mirror images, background, leaked poles, leaked background.
    """

    data: NDArray[np.complex128]
    weight: NDArray[np.float64]
    leakage: NDArray[np.complex128] | None
    background: NDArray[np.complex128]
    leaked_background: NDArray[np.complex128]

    def design(self, poles: NDArray[np.complex128], images: NDArray[np.complex128] | None) -> NDArray[np.complex128]:
        """Weighted columns (B, K, m) with those (K, N) of the poles and of their mirror images, if wanted."""
        parts = [self.weight * poles]
        if images is not None:
            parts.append(self.weight * images)
        parts.append(self.background)
        if self.leakage is not None:
            parts += [self.leakage * poles, self.leaked_background]
        return np.concatenate(parts, axis=2)


@dataclass(frozen=True, slots=True, eq=False)
class RationalProblem:
    """A window in the scaled variable x = (omega - centre) / half width, in which the poles are z."""

    x: NDArray[np.float64]
    blocks: tuple[Block, ...]
    background: int
    mirror_at: float | None
    stacks: tuple[Stack, ...]

    @classmethod
    def of(
        cls, x: NDArray[np.float64], blocks: tuple[Block, ...], background: int, mirror_at: float | None
    ) -> RationalProblem:
        """The problem of blocks over x (K,), neighbours of one size in one stack."""
        groups = groupby(blocks, key=lambda b: (b.values.shape[0], b.leakage is None))
        return cls(x, blocks, background, mirror_at, tuple(_stack(x, tuple(g), background) for _, g in groups))

    def designs(self, z: NDArray[np.complex128]) -> Iterator[tuple[Stack, NDArray[np.complex128]]]:
        """Every stack with its weighted columns (B, K, m)."""
        poles = pole_columns(self.x, z)
        images = None if self.mirror_at is None else pole_columns(self.x, mirror(z, self.mirror_at))
        return ((s, s.design(poles, images)) for s in self.stacks)

    def cost(self, z: NDArray[np.complex128]) -> float:
        """Weighted squared error with the best coefficients."""
        return sum(squared(s.data - projected(np.linalg.qr(d)[0], s.data)) for s, d in self.designs(z))

    def linearised(self, z: NDArray[np.complex128]) -> Iterator[tuple[NDArray[np.complex128], NDArray[np.complex128]]]:
        """Per stack the projected error (B, K, R) and its derivative (B, K, R, N) by the poles; it is analytic in z."""
        size, square = z.size, pole_columns(self.x, z) ** 2
        for stack, design in self.designs(z):
            basis, triangle = np.linalg.qr(design)
            inside = basis.conj().swapaxes(1, 2) @ stack.data
            found = _solved(triangle, inside).swapaxes(1, 2)[:, None]
            slopes = (stack.weight * square)[:, :, None, :] * found[..., :size]
            if stack.leakage is not None:
                start = found.shape[-1] - size - LEAKAGE_BACKGROUND
                slopes = slopes + (stack.leakage * square)[:, :, None, :] * found[..., start : start + size]
            flat = slopes.reshape(*slopes.shape[:2], -1)
            yield stack.data - basis @ inside, (projected(basis, flat) - flat).reshape(slopes.shape)

    def normal_equations(
        self, z: NDArray[np.complex128]
    ) -> tuple[float, NDArray[np.complex128], NDArray[np.complex128]]:
        """Cost, J^H J (N, N) and J^H r (N,)."""
        cost, gram, gradient = 0.0, np.zeros((z.size, z.size), complex), np.zeros(z.size, complex)
        for error, slopes in self.linearised(z):
            jacobian = slopes.reshape(-1, z.size)
            cost += squared(error)
            gram += jacobian.conj().T @ jacobian
            gradient += jacobian.conj().T @ error.reshape(-1)
        return cost, gram, gradient


def _stack(x: NDArray[np.float64], blocks: tuple[Block, ...], background: int) -> Stack:
    weight = np.array([b.weight for b in blocks])[:, :, None]
    data = np.asarray(np.array([(b.values * b.row_scale[:, None]).T for b in blocks]) * weight, complex)
    still = np.asarray(weight * legendre(x, background), complex)
    leaks = [b.leakage for b in blocks if b.leakage is not None]
    if not leaks:
        return Stack(data, weight, None, still, still[:, :, :0])
    leakage = np.asarray(weight * np.array(leaks)[:, :, None], complex)
    return Stack(data, weight, leakage, still, np.asarray(leakage * legendre(x, LEAKAGE_BACKGROUND)))


def projected(basis: NDArray[np.complex128], columns: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Part (B, K, n) of columns (B, K, n) that lies in the orthonormal basis (B, K, m)."""
    return np.asarray(basis @ (basis.conj().swapaxes(1, 2) @ columns))


def squared(values: NDArray[np.complex128]) -> float:
    """Sum of |value|^2 of an array of any shape."""
    flat = values.reshape(-1)
    return float(np.vdot(flat, flat).real)


def _solved(triangle: NDArray[np.complex128], right: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Solutions (B, m, R) of triangles (B, m, m), of smallest norm where they are singular."""
    size = np.abs(np.diagonal(triangle, axis1=1, axis2=2))
    if (size.min(axis=1) > _SINGULAR * size.max(axis=1)).all():
        return np.asarray(np.linalg.solve(triangle, right))
    return np.asarray(np.linalg.pinv(triangle, rcond=np.finfo(float).eps * triangle.shape[-1]) @ right)


def columns(
    x: NDArray[np.float64], z: NDArray[np.complex128], images: NDArray[np.complex128] | None, background: int
) -> NDArray[np.complex128]:
    """Columns (K, m) of the poles z (N,), of their mirror images if wanted, and of the background."""
    parts: Iterable[NDArray[np.complex128]] = (pole_columns(x, p) for p in (z, images) if p is not None)
    return np.hstack([*parts, legendre(x, background)])


def pole_columns(x: NDArray[np.float64], z: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Columns (K, N) of the poles z (N,)."""
    return np.asarray(1 / (1j * x[:, None] - z))


def legendre(x: NDArray[np.float64], terms: int) -> NDArray[np.float64]:
    """Legendre polynomials (K, terms) by their recurrence."""
    found = [np.ones_like(x), x]
    for n in range(1, terms - 1):
        found.append(((2 * n + 1) * x * found[n] - n * found[n - 1]) / (n + 1))
    return np.stack(found[:terms], axis=1)


def mirror(z: NDArray[np.complex128], centre: float) -> NDArray[np.complex128]:
    """Scaled positions (N,) of the conjugates of poles z (N,)."""
    return np.asarray((z + 1j * centre).conj() - 1j * centre)
