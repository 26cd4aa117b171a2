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
WHOLE = "stiffness of the whole airframe"
"""What the place is called."""


def whole_airframe(here: Anchor) -> list[FreePlace]:
    """The one place that is everywhere, its law relative to every stiffness there; none where nothing bends."""
    rows = tuple(_strains(group) for group in here.assembled)
    return [FreePlace(WHOLE, "airframe", None, rows, None)] if all(r.size for r in rows) else []


def _strains(group: Group) -> Array:
    """Rows (J, n) whose square sum is twice the energy in a group's beams, roots and carry-through.

    Of whatever else holds elastic joints, a stinger and gravity, they have a share: thousandths of it.
    """
    s = group.structure
    index = np.array([k for k, name in enumerate(s.joints) if name in _elastic(group)], dtype=np.intp)
    rows = np.zeros((index.size, len(s.joints)))
    if index.size:
        sizes, sides = scipy.linalg.eigh(s.stiffness[np.ix_(index, index)])
        rows[:, index] = np.sqrt(np.maximum(sizes, 0.0))[:, None] * sides.T
    return rows


def _elastic(group: Group) -> frozenset[str]:
    return frozenset(elastic_joints(group.plan.parts))
