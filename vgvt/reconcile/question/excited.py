"""Which lines a force excites, where it excites some only: the harmonics of a multisine over several periods."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# So many lines to either side hold two harmonics, or one of the odd ones of sixteen periods.
_AROUND = 32
_DARK = 0.25
# Of the lines of a random force three in ten are darker than a quarter of the loudest around. At every third line half
# are; at every other one as few as of a random force, and what leaks between two such is a third of either.
_COMB = 0.45
# Between two lines a harmonic has two thirds of its force on either, and a fifth on those next to them.
_SKIRT = 0.5
_WEAK = 0.03
_NARROWEST, _WIDEST = 4, 96


def excited_lines(force: Array) -> NDArray[np.bool_]:
    """The lines (K,) that every run's force excites, of magnitudes (R, K) on all lines of a band.

    All of them for a sweep, which dips smoothly, and for random forces, which scatter: no line of these is without
    force by design. Only a spectrum that is dark on more lines than scatter leaves so is taken for a comb.
    """
    found = np.ones(force.shape[1], dtype=bool)
    for size in force:
        spacing = _spacing(size)
        if spacing is not None:
            found &= _teeth(size, spacing)
    return found


def _spacing(size: Array) -> float | None:
    """Lines from harmonic to harmonic, roughly; None for what is no comb."""
    from scipy.ndimage import maximum_filter1d

    lit = float((size >= _DARK * maximum_filter1d(size, 2 * _AROUND + 1, mode="nearest")).mean())
    return 1 / lit if lit < 1 - _COMB else None


def _teeth(size: Array, spacing: float) -> NDArray[np.bool_]:
    """Lines nearer, by ratio, to the loudest around than to the dark ones; no skirts, and none beside the whole band.

    Where a resonance takes the force away its harmonic stays far above the lines between, and is what tells most.
    """
    from scipy.ndimage import maximum_filter1d, percentile_filter

    width = 2 * int(np.clip(np.ceil(2 * spacing), _NARROWEST, _WIDEST)) + 1
    dark, loud = percentile_filter(size, 25, width, mode="nearest"), maximum_filter1d(size, width, mode="nearest")
    # As far as half-way to the next harmonic: what a record leaks that is no whole number of periods is none.
    own = maximum_filter1d(size, 2 * max(1, int(spacing / 2)) + 1, mode="nearest")
    # What lies beside the excited band has loudest lines, too.
    level = np.sqrt((size**4).sum() / max((size**2).sum(), np.finfo(float).tiny))
    return np.asarray((size > np.sqrt(dark * loud)) & (size > _SKIRT * own) & (size > _WEAK * level))
