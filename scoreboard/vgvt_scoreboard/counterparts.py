"""Which resonance of the rig, shaker attached, is which mode of the aircraft as tested."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from vgvt.data import ModalModel, modal_assurance

_ALIKE = 0.8
"""Least MAC of a resonance and a mode that belong together."""
_NEAR = 1.3
"""Largest ratio of their frequencies."""
_SAME_POLE = 1e-3
"""Relative distance of two poles that are of one mode, whatever the sensors see of its shape."""


def counterparts(coupled: ModalModel, as_tested: ModalModel) -> NDArray[np.intp]:
    """For each resonance of the rig, (C,), the index of the mode as tested that it is, or -1; none is given twice.

    That is the mode with the same pole, which the shaker does not touch, else the one of like shape and
    frequency. A sensor on the axis of a torsion sees little of it: shapes alone say too much. A resonance of the
    shaker itself has none. Both models have the same DOFs.
    """
    found = np.full(len(coupled), -1, dtype=np.intp)
    if not len(coupled) or not len(as_tested):
        return found
    away = np.abs(np.log(coupled.natural_frequency_hz[:, None] / as_tested.natural_frequency_hz))
    mac = modal_assurance(coupled.shapes, as_tested.shapes)
    likeness = np.where((mac >= _ALIKE) & (away <= np.log(_NEAR)), mac - away, 0.0)
    likeness += 2.0 * (np.abs(coupled.poles[:, None] / as_tested.poles - 1.0) <= _SAME_POLE)
    for mine, theirs in zip(*linear_sum_assignment(-likeness), strict=True):
        if likeness[mine, theirs] > 0:
            found[mine] = theirs
    return found
