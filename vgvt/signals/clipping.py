"""Clipping seen in the samples themselves: flat tops that a signal enters with a jump."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_LEAST_SAMPLES = 10
_LEAST_JUMP_STEPS = 5.0


def clipped_share(samples: NDArray[np.floating]) -> float:
    """Share of the samples (N,) that lie on a flat top or bottom, 0 when the extremes are not flat.

    Clipped samples repeat the extreme value exactly and are reached in one jump; the top of a smooth signal, however
    coarse its steps, is reached one step at a time. Bendat and Piersol, Random Data, 4th ed., section 10.2.
    """
    return sum(_flat(side) for side in (samples, -samples)) / max(samples.size, 1)


def _flat(samples: NDArray[np.floating]) -> int:
    """How many samples lie on a flat top, 0 when there is none."""
    top = samples.max()
    on = samples == top
    count = int(np.count_nonzero(on))
    if count < _LEAST_SAMPLES or count == samples.size:
        return 0
    enters = np.flatnonzero(on[1:] & ~on[:-1])
    below = np.unique(samples[~on])[-1000:]
    if not enters.size or below.size < 2:
        return 0
    step = float(np.median(np.diff(below)))
    beside = int(np.count_nonzero(samples >= top - 1.5 * step)) - count
    jumps = float(np.median(top - samples[enters]))
    # A sine whose period is a whole number of samples repeats all its values, not its top alone.
    again = int(np.count_nonzero(np.abs(samples - below[-1]) <= 1e-9 * float(top - samples.min())))
    return count if jumps > _LEAST_JUMP_STEPS * step and count > 2 * max(beside, again) else 0
