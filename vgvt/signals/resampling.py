"""What a sampled signal was between its samples: band-limited interpolation."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
REACH = 32
"""Samples to either side that a value between two samples is made of."""
# Kaiser's window of that reach lets 1e-5 wrong up to 0.45 of the rate (Oppenheim and Schafer, Discrete-Time Signal
# Processing, 3rd ed., section 7.5.3).
_BETA = 10.0
# Between so many times as many samples, and these about each instant, Lagrange's polynomial errs by less than that.
_FINER, _ABOUT = 8, range(-2, 4)


def between_samples(samples: Array, instants: Array) -> Array:
    """The samples (N,) at instants (M,) from 0 to N - 1, in samples.

    To 1e-4 of a sine's amplitude up to 0.45 of the sampling rate; what lies between there and half the rate is
    weakened. Beyond its ends a record is taken to go on as it came, turned about its last sample: within
    :data:`REACH` samples of them a value is as good as that guess.
    """
    from scipy.signal import upfirdn

    padded = np.pad(samples, REACH + 1, mode="reflect", reflect_type="odd")
    fine = upfirdn(_low_pass(), padded, up=_FINER)
    # The filter delays by its own reach: the first sample comes out behind that and what was put before it.
    place = instants * _FINER + (2 * REACH + 1) * _FINER
    whole = np.floor(place).astype(np.int64)
    part = place - whole
    out = np.zeros(instants.shape)
    for k in _ABOUT:
        weight = math.prod((part - j) / (k - j) for j in _ABOUT if j != k)
        out += weight * fine[whole + k]
    return out


@lru_cache(maxsize=1)
def _low_pass() -> Array:
    """A windowed low-pass at half the rate, for the finer samples: one at its middle, zero at all other whole ones."""
    fine = np.arange(-REACH * _FINER, REACH * _FINER + 1) / _FINER
    return np.asarray(np.sinc(fine) * np.kaiser(fine.size, _BETA))
