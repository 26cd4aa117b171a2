"""Noise of the force is an error that all responses of a run share: seen on four of them it is seen once.

Where the shaker drops out, A/F of a whole run is wrong by one factor. Taken for noise of every channel it looks like
news of that run: evidence for whatever changes runs. (Errors in variables, as in Pintelon and
Schoukens, System Identification, 2nd edition, 2012.)
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from vgvt.reconcile.question.data import Measured

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
# Of a line's variance, at most: where more were shared, differences of channels would count ever so much.
_MOST = 0.9
# Shares of all channels at all lines that change nothing.
_NOTHING = 1e-3


def apart(measured: Measured, keep: NDArray[np.bool_], standardised: ComplexArray) -> ComplexArray:
    """Differences (C, L) or (C, L, k) of the channels ``keep`` in standard deviations, made independent of each other.

    The correlation of the channels of a run, of each what it shares with them in phase with its response, is taken out
    by the inverse of its root, so that a square sum is χ²: the transform that moves the channels least.
    """
    if measured.of_force is None:
        return standardised
    out = standardised
    for rows, roots in _roots(measured, keep.tobytes()):
        if out is standardised:
            out = standardised.copy()
        together = standardised[rows].reshape(rows.size, roots.shape[0], -1).swapaxes(0, 1)
        out[rows] = (roots @ together).swapaxes(0, 1).reshape(standardised[rows].shape)
    return out


@lru_cache(maxsize=8)
def _roots(measured: Measured, kept: bytes) -> Sequence[tuple[NDArray[np.intp], ComplexArray]]:
    """For each run whose channels share something: their rows among those kept, and the inverse roots (L, n, n)."""
    keep = np.frombuffer(kept, dtype=bool)
    assert measured.of_force is not None, "nothing is shared without it"
    shared, noise, sigma = measured.of_force[keep], measured.noise[keep], measured.sigma[keep]
    share = np.minimum(np.abs(shared) ** 2 * noise / sigma**2, _MOST)
    together = in_phase(share, shared)
    run = np.array([c.run for c, mine in zip(measured.channels, keep, strict=True) if mine])
    found = []
    for r in np.unique(run):
        rows = np.flatnonzero(run == r)
        if rows.size < 2 or share[rows].max() < _NOTHING:
            continue
        w = together[rows].T
        correlation = w[:, :, None] * w[:, None, :].conj()
        own = np.arange(rows.size)
        correlation[:, own, own] = 1.0
        power, turns = np.linalg.eigh(correlation)
        found.append((rows, (turns / np.sqrt(power)[:, None, :]) @ turns.conj().swapaxes(1, 2)))
    return tuple(found)


def in_phase(share: Array, values: ComplexArray) -> ComplexArray:
    """Roots of shares (C, L) of a variance, turned as accelerances (C, L): a factor on the force turns with them."""
    size = np.abs(values)
    return np.asarray(np.sqrt(share) * np.where(size > 0, values, 1.0) / np.where(size > 0, size, 1.0))
