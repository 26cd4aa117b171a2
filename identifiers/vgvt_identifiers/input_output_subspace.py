"""State-space poles of one run from its samples: past inputs and outputs, projected along the future inputs.

Verhaegen, Identification of the deterministic part of MIMO state space models
given in innovations form from input-output data, Automatica 30(1), 1994; with
Larimore's canonical variate weighting and the oblique projection of N4SID in the unifying
frame of Van Overschee and De Moor, Automatica 31(12), 1995, and Subspace Identification for
Linear Systems, 1996, theorem 12. The past is the instrument, so white noise on the
responses does not bias the poles, and coloured noise takes states of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.stabilisation import PolesAtOrder
from vgvt_identifiers.too_few import TooFewError

_OVERSAMPLING = 2.56
_RIDGE = 1e-11  # of a channel's power: round-off of the squared data, far below any sensor's noise


@dataclass(frozen=True, slots=True, eq=False)
class DecimatedRun:
    """Force and responses (1 + R, N) of a run at a rate that just holds the band, over their rms ``scale`` (1 + R,)."""

    samples: NDArray[np.float64]
    scale: NDArray[np.float64]
    step_s: float

    @property
    def responses(self) -> int:
        """Number of responses."""
        return int(self.samples.shape[0]) - 1


@dataclass(frozen=True, slots=True, eq=False)
class Observability:
    """Extended observability matrix (R i, largest order), columns by falling weight, and its shift solved by QR."""

    matrix: NDArray[np.float64]
    responses: int
    step_s: float

    def poles(self, orders: tuple[int, ...]) -> tuple[PolesAtOrder, ...]:
        """Continuous poles in the upper half plane and shapes (n, R) of every order, in states."""
        upper, lower = self.matrix[: -self.responses], self.matrix[self.responses :]
        basis, triangle = np.linalg.qr(upper)
        shifted = basis.T @ lower
        found = []
        for order in orders:
            # The leading columns of a QR are the QR of the leading columns.
            transition = np.linalg.solve(triangle[:order, :order], shifted[:order, :order])
            roots, vectors = np.linalg.eig(transition)
            keep = (roots.imag > 0) & (np.abs(roots) > 1e-6)
            shapes = self.matrix[: self.responses, :order] @ vectors[:, keep]
            found.append(PolesAtOrder(order, np.log(roots[keep]) / self.step_s, shapes.T.astype(complex)))
        return tuple(found)


def decimated(samples: NDArray[np.floating], sample_rate_hz: float, highest_hz: float) -> DecimatedRun:
    """Samples (1 + R, N), the force first, at the lowest whole fraction of their rate that holds ``highest_hz``."""
    from scipy.signal import resample_poly

    factor = max(1, int(sample_rate_hz / (_OVERSAMPLING * highest_hz)))
    signals = np.asarray(samples, dtype=np.float64)
    signals = signals - signals.mean(axis=1, keepdims=True)
    if factor > 1:
        signals = np.asarray(resample_poly(signals, 1, factor, axis=1))
    scale = np.sqrt((signals**2).mean(axis=1))
    return DecimatedRun(signals / scale[:, None], scale, factor / sample_rate_hz)


def observability(run: DecimatedRun, block_rows: int, largest_order: int, weighting: str) -> Observability:
    """Observability matrix from the run, with ``block_rows`` rows of past and of future.

    ``weighting`` says what of the past's part O in the future outputs is decomposed, an oblique projection along the
    future inputs U: "n4sid" O itself, "moesp" what of O is orthogonal to U, "cva" that with the future outputs,
    orthogonal to U, made white.
    TooFewError when the record is shorter than the rows or they cannot hold the order.
    """
    responses = run.responses
    if run.samples.shape[1] < 4 * block_rows * (1 + responses):
        raise TooFewError(f"{run.samples.shape[1]} samples are too few for {block_rows} block rows")
    if responses * (block_rows - 1) < largest_order:
        raise TooFewError(f"{block_rows} block rows of {responses} responses cannot hold order {largest_order}")
    gram = hankel_gram(run.samples, 2 * block_rows)
    past, future = np.arange(block_rows), np.arange(block_rows, 2 * block_rows)
    place = np.arange(2 * block_rows * (1 + responses)).reshape(2 * block_rows, 1 + responses)
    order = [place[future, 0], place[past].ravel(), place[future, 1:].ravel()]
    index = np.concatenate(order)
    arranged = gram[np.ix_(index, index)]
    ridge = _RIDGE * run.samples.shape[1] * index.size
    factor = np.linalg.cholesky(arranged + ridge * np.eye(index.size))
    first, second = order[0].size, order[0].size + order[1].size
    known, rest = factor[second:, first:second], factor[second:, second:]
    weight = np.eye(known.shape[0])
    if weighting == "cva":
        weight = np.linalg.cholesky(known @ known.T + rest @ rest.T)
    decomposed = np.linalg.solve(weight, known)
    if weighting == "n4sid":
        # The past Z is [beside, own] times orthonormal rows, those of the future inputs first, and O = known own^-1 Z.
        beside, own = factor[first:second, :first], factor[first:second, first:second]
        decomposed = np.hstack([known @ np.linalg.solve(own, beside), known])
    left, values, _ = np.linalg.svd(decomposed, full_matrices=False)
    matrix = weight @ (left[:, :largest_order] * np.sqrt(values[:largest_order]))
    return Observability(np.asarray(matrix), responses, run.step_s)


def hankel_gram(signals: NDArray[np.float64], rows: int) -> NDArray[np.float64]:
    """H H^T of the block Hankel matrix with ``rows`` block rows of the signals (C, N), (rows C, rows C).

    A block differs from its upper left neighbour by what enters and leaves at the ends.
    """
    channels, length = signals.shape[0], signals.shape[1] - rows + 1
    gram = np.empty((rows, channels, rows, channels))
    for lag in range(rows):
        gram[0, :, lag] = signals[:, :length] @ signals[:, lag : lag + length].T
    for row in range(rows - 1):
        entering = np.einsum("a,bl->abl", signals[:, length + row], signals[:, length + row : length + rows - 1])
        leaving = np.einsum("a,bl->abl", signals[:, row], signals[:, row : rows - 1])
        gram[row + 1, :, row + 1 :] = gram[row, :, row:-1] + (entering - leaving).transpose(0, 2, 1)
        gram[row + 1 :, :, row] = gram[row, :, row + 1 :].transpose(1, 2, 0)
    return gram.reshape(rows * channels, rows * channels)
