"""Clipping seen in the samples themselves: flat tops that a signal enters with a jump."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_LEAST_SAMPLES = 10
_LEAST_JUMP_STEPS = 5.0
# A flat side nearer to zero than this share of the largest sample is rest, as between a hammer's hits.
_REST = 0.05
# A single sample on top is clipped where the signal jumps there; around its top a sine moves less than elsewhere.
_LEAST_JUMP_MOVES = 0.5


def clipped_share(samples: NDArray[np.floating]) -> float:
    """Share of the samples (N,) that lie on a flat top or bottom, 0 when the extremes are not flat.

    Clipped samples repeat the extreme value exactly and are reached in one jump; the top of a smooth signal, however
    coarse its steps, is reached one step at a time. A flat side near zero is rest, and sines without noise may
    touch one value with single samples. Bendat and Piersol, Random Data, 4th ed., section 10.3.
    """
    return sum(_flat(side) for side in (samples, -samples)) / max(samples.size, 1)


def _flat(samples: NDArray[np.floating]) -> int:
    """How many samples lie on a flat top, 0 when there is none."""
    top = samples.max()
    on = samples == top
    count = int(np.count_nonzero(on))
    if count < _LEAST_SAMPLES or count == samples.size or abs(top) < _REST * abs(samples.min()):
        return 0
    enters = np.flatnonzero(on[1:] & ~on[:-1])
    below = np.unique(samples[~on])[-1000:]
    if not enters.size or below.size < 2:
        return 0
    step = float(np.median(np.diff(below)))
    beside = int(np.count_nonzero(samples >= top - 1.5 * step)) - count
    jumps = float(np.median(top - samples[enters]))
    if count < 1.5 * enters.size and jumps < _LEAST_JUMP_MOVES * float(np.sqrt(np.mean(np.diff(samples) ** 2))):
        return 0
    # A sine whose period is a whole number of samples repeats all its values, not its top alone.
    again = int(np.count_nonzero(np.abs(samples - below[-1]) <= 1e-9 * float(top - samples.min())))
    return count if jumps > _LEAST_JUMP_STEPS * step and count > 2 * max(beside, again) else 0
