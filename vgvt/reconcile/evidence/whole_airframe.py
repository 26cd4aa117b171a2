"""The whole airframe as one place for a thing of any law: what is the same everywhere sits nowhere.

A material that warms, ages or loses energy in another way than it is said to multiplies every stiffness of the
airframe by the same factor. At a point it is imitated by none; relatives that act on all of it, too, imitate it well.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from vgvt.reconcile.evidence.free_places import FreePlace
from vgvt.reconcile.prediction.grouping import Group
from vgvt.reconcile.prediction.surrogate import Anchor
from vgvt.simulation.airframe import elastic_joints

Array = NDArray[np.float64]
# Modes up to so many times the highest line: what stiffer ones give way is none of a law's business, and dear.
_REACH = 4.0
WHOLE = "stiffness of the whole airframe"
"""What the place is called."""


def whole_airframe(here: Anchor) -> list[FreePlace]:
    """The one place that is everywhere, its law relative to every stiffness there; none where nothing bends."""
    highest = 2 * np.pi * _REACH * float(here.problem.measured.frequency_hz[-1])
    rows = tuple(_strains(group, highest) for group in here.assembled)
    return [FreePlace(WHOLE, "airframe", None, rows, None)] if all(r.size for r in rows) else []


def _strains(group: Group, highest_rad_per_s: float) -> Array:
    """Rows (J, n) whose square sum is twice the energy in a group's beams, roots and carry-through.

    Modes of these above ``highest_rad_per_s``, the body held, are left out. Of whatever else holds elastic joints, a
    stinger and gravity, the rows have a share: thousandths of it.
    """
    s, elastic = group.structure, frozenset(elastic_joints(group.plan.parts))
    index = np.array([k for k, name in enumerate(s.joints) if name in elastic], dtype=np.intp)
    if not index.size:
        return np.zeros((0, len(s.joints)))
    block = np.ix_(index, index)
    # What a gauge feels of a moment is on one side alone.
    stiffness = 0.5 * (s.stiffness[block] + s.stiffness[block].T)
    try:
        square, shapes = scipy.linalg.eigh(stiffness, s.mass[block])
    except np.linalg.LinAlgError:
        # More was taken off somewhere than there is: no such aircraft, and no modes of it.
        return np.zeros((0, len(s.joints)))
    kept = (square > 0) & (square < highest_rad_per_s**2)
    rows = np.zeros((int(kept.sum()), len(s.joints)))
    rows[:, index] = np.sqrt(square[kept])[:, None] * (shapes[:, kept].T @ s.mass[block])
    return rows
