"""Stochastic subspace realisation of output covariances, and what their scatter does to its poles.

Output covariances of a structure under white forces obey R_k = C A^(k-1) G, so a Hankel matrix of
them has the observability matrix as its column space: Peeters and De Roeck, Reference-based stochastic
subspace identification for output-only modal analysis, Mechanical Systems and Signal Processing 13(6), 1999.
Standard deviations: covariances of single blocks of time are carried to the poles to first order,
Doehler and Mevel, Efficient multi-order uncertainty computation for stochastic subspace
identification, Mechanical Systems and Signal Processing 38(2), 2013.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

_ABOVE_ERRORS = 4.0  # of white noise the largest singular value stands 2.7 above its own errors, as it was chosen


@dataclass(frozen=True, slots=True, eq=False)
class BlockCovariances:
    """Covariances (L, D, R) of D outputs with R references at lags 1 to L, and those of every block (B, L, D, R)."""

    mean: NDArray[np.float64]
    blocks: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Realisation:
    """Hankel matrix of covariances: left (p D, m) and right (R p, m) singular vectors and the singular values (m,)."""

    covariances: BlockCovariances
    left: NDArray[np.float64]
    values: NDArray[np.float64]
    right: NDArray[np.float64]
    outputs: int
    step_s: float

    def truncated(self, order: int) -> Realisation:
        """The same with its leading ``order`` states."""
        return replace(self, left=self.left[:, :order], values=self.values[:order], right=self.right[:, :order])


@dataclass(frozen=True, slots=True, eq=False)
class Poles:
    """Poles (n,) rad/s of one order in the upper half plane with their shapes (n, D) and the state matrix's own terms.

    ``state`` (order, order); its ``roots`` (n,), ``right`` (order, n) and ``left`` (n, order) vectors, left right = 1.
    """

    order: int
    poles_rad_s: NDArray[np.complex128]
    shapes: NDArray[np.complex128]
    state: NDArray[np.float64]
    roots: NDArray[np.complex128]
    right: NDArray[np.complex128]
    left: NDArray[np.complex128]


def block_covariances(samples: NDArray[np.float64], references: int, lags: int, blocks: int) -> BlockCovariances:
    """Covariances of outputs (D, N) with their ``references`` strongest principal components, of all and per block.

    ValueError when a block is not longer than the lags.
    """
    length = (samples.shape[1] - lags) // blocks
    if length <= lags:
        raise ValueError(f"{blocks} blocks of {length} samples cannot hold {lags} lags")
    centred = samples - samples.mean(axis=1, keepdims=True)
    components = np.linalg.svd(centred @ centred.T, hermitian=True)[0][:, :references]
    reference = components.T @ centred
    out = np.empty((blocks, lags, samples.shape[0], reference.shape[0]))
    for block in range(blocks):
        start, stop = block * length, (block + 1) * length
        now = reference[:, start:stop].T / length
        for lag in range(1, lags + 1):
            out[block, lag - 1] = centred[:, start + lag : stop + lag] @ now
    return BlockCovariances(out.mean(axis=0), out)


def realise(covariances: BlockCovariances, step_s: float, largest_order: int) -> Realisation:
    """Singular value decomposition of the block Hankel matrix, kept up to ``largest_order``."""
    left, values, right = np.linalg.svd(_hankel(covariances.mean), full_matrices=False)
    keep = min(largest_order, values.size)
    return Realisation(covariances, left[:, :keep], values[:keep], right[:keep].T, covariances.mean.shape[1], step_s)


def significant_order(found: Realisation, most: int) -> int:
    """States, up to ``most``, whose singular values exceed what errors alone make beside the states before them.

    The blocks with alternating signs have no signal in common but the errors of the mean.
    """
    blocks = found.covariances.blocks
    count = blocks.shape[0] // 2 * 2
    signs = np.where(np.arange(count) % 2, -1.0, 1.0)
    errors = found.left.T @ _hankel(np.tensordot(signs, blocks[:count], axes=1) / count) @ found.right
    order = 0
    for states in range(0, min(found.values.size - 1, most), 2):
        level = float(np.linalg.norm(errors[states:, states:], 2))
        if found.values[states] > _ABOVE_ERRORS * level:
            order = states + 2
    return order


def poles_at(found: Realisation, order: int) -> Poles:
    """Poles and shapes of the model of ``order`` states."""
    upper, lower = found.left[: -found.outputs, :order], found.left[found.outputs :, :order]
    state = np.asarray(np.linalg.lstsq(upper, lower, rcond=None)[0], dtype=np.float64)
    values, vectors = np.linalg.eig(state)
    roots, right = values.astype(np.complex128), vectors.astype(np.complex128)
    left = np.asarray(np.linalg.inv(right), dtype=np.complex128)
    with np.errstate(divide="ignore"):
        poles = np.asarray(np.log(roots) / found.step_s, dtype=np.complex128)
    keep = (roots.imag > 0) & np.isfinite(poles)
    shapes = (found.left[: found.outputs, :order] @ right[:, keep]).T
    return Poles(order, poles[keep], shapes, state, roots[keep], right[:, keep], left[keep])


def block_changes(found: Realisation) -> NDArray[np.float64]:
    """What the covariances of every block do to the column space (B, p D, m): dH V / S, its own part not yet off."""
    weighted = found.right / found.values
    blocks = found.covariances.blocks - found.covariances.mean
    return np.array([_hankel(block) @ weighted for block in blocks])


def pole_std(found: Realisation, changes: NDArray[np.float64], poles: Poles, which: list[int]) -> NDArray[np.float64]:
    """Standard deviations (n, 2) of the natural frequency in Hz and of the damping ratio of some poles of one order.

    A change of the Hankel matrix turns its column space by (I - U U^T) dH V / S; the part inside the
    space only changes the basis, which moves no pole.
    """
    order, count, cut = poles.order, changes.shape[0], found.outputs
    space = found.left[:, :order]
    upper, lower = space[:-cut], space[cut:]
    inverse = np.linalg.pinv(upper)
    gram = np.linalg.inv(upper.T @ upper)
    rest = lower - upper @ poles.state
    right, left = poles.right[:, which], poles.left[which]
    pole, size = poles.poles_rad_s[which], np.abs(poles.poles_rad_s[which])
    moved = np.empty((count, 2, len(which)))
    for block in range(count):
        change = changes[block][:, :order]
        change = change - space @ (space.T @ change)
        state = inverse @ (change[cut:] - change[:-cut] @ poles.state) + gram @ (change[:-cut].T @ rest)
        shift = np.einsum("ni,ij,jn->n", left, state, right) / (poles.roots[which] * found.step_s)
        along = (pole.conj() * shift).real / size
        moved[block] = along / (2 * np.pi), -shift.real / size + pole.real * along / size**2
    return np.asarray(np.sqrt((moved**2).sum(axis=0) / (count * (count - 1))).T)


def _hankel(covariances: NDArray[np.float64]) -> NDArray[np.float64]:
    """Block Hankel matrix (p D, q R) of covariances (L, D, R) with p + q - 1 = L, as square as L allows."""
    lags, outputs, references = covariances.shape
    rows = lags // 2 + 1
    columns = lags - rows + 1
    windows = np.lib.stride_tricks.sliding_window_view(covariances, columns, axis=0)
    return np.asarray(windows.transpose(0, 1, 3, 2).reshape(rows * outputs, columns * references))
