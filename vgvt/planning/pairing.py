"""Which found mode is which target: one to one, so that no mode stands for two targets."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment


def paired(
    targets_hz: Sequence[float],
    found_hz: Sequence[float] | NDArray[np.float64],
    tolerance: float,
    namesakes: NDArray[np.bool_] | None = None,
) -> list[int | None]:
    """For each target the index of its mode among those found at frequencies (F,), None where it has none.

    A mode may lie up to ``tolerance`` times the target's frequency away and belongs to one target at most.
    ``namesakes`` (T, F) marks modes of a target's own name: such a pair goes before all others. Of what is
    left the nearest pairs, all together, are taken.
    """
    wanted = np.asarray(targets_hz, dtype=np.float64)[:, None]
    share = np.abs(np.asarray(found_hz, dtype=np.float64)[None, :] / wanted - 1) / tolerance
    near = share < 1
    # Every pair gains something, so that none is refused for being far off; all of them gain less than one namesake.
    gain = np.where(near, 1 - share, 0.0)
    if namesakes is not None:
        gain = gain + len(wanted) * (near & namesakes)
    rows, columns = linear_sum_assignment(gain, maximize=True)
    result: list[int | None] = [None] * len(wanted)
    for row, column in zip(rows, columns, strict=True):
        if near[row, column]:
            result[int(row)] = int(column)
    return result


def named_alike(targets: Sequence[str], found: Sequence[str]) -> NDArray[np.bool_]:
    """Where a target (T) and a found mode (F) have the same label, (T, F)."""
    return np.array([[target == label for label in found] for target in targets], dtype=bool).reshape(
        len(targets), len(found)
    )
