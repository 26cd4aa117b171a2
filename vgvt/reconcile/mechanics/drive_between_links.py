"""The drive of a beam as it moves between the links of its chain: sensors sit there, a simulated shaker on a link.

The two are one where a cell ends at the drive, as it does unless the beam ends or bends next to it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.simulation.assembly import Plan
from vgvt.simulation.attached import sensed_at
from vgvt.simulation.reduced import Structure
from vgvt.simulation.seats import seats_at

Array = NDArray[np.float64]


def drive_between_links(found: Structure, layout: Plan) -> Array:
    """The row (n,) of the beam at the drive point, of a structure of this layout."""
    drive = layout.drive
    seats = seats_at(layout.parts, drive.part, drive.position_m)
    return found.drive if len(seats) == 1 else sensed_at(found, layout, replace(drive, seats=seats))[1]
