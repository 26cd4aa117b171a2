"""What sensors and the transducer weigh in the coordinates of a structure."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.simulation.reduced import Structure

Array = NDArray[np.float64]


def carried_by(
    s: Structure, rows: NDArray[np.intp], masses: Array, runs: tuple[NDArray[np.intp], ...], roving: bool
) -> Array:
    """Inertia (n, n) of the sensors: all of it where they stay, the mean across their axes where they rove."""
    chosen = np.concatenate(runs if roving else runs[:1])
    at, own = rows[chosen], masses[chosen]
    moved = s.jacobian[at]
    total = (moved * own[:, None, None]).reshape(-1, s.drive.size).T @ moved.reshape(-1, s.drive.size)
    if not roving:
        return np.asarray(total)
    axis = s.axis[at]
    return np.asarray(total - (axis.T * own) @ axis) / len(runs)


def riding(drive: Array, known: NDArray[np.bool_]) -> Array:
    """What a transducer of 1 kg adds to the inertia (n, n) by moving otherwise than the joints that are ``known`` (n,).

    On a mount that gives it goes where the push goes, not where the structure below it does.
    """
    bare = np.where(known, drive, 0.0)
    return np.asarray(np.outer(drive, drive) - np.outer(bare, bare))


def across_by_rows(axis: Array, moved: Array, masses_kg: Array) -> Array:
    """Change (m, m) of what roving sensors weigh across their axes (C, m) where these alone change by ``moved``.

    What cells lack turns the rows that sensors read, and not the links that carry them.
    """
    change = (axis.T * masses_kg) @ moved
    return np.asarray(-change - change.T)
