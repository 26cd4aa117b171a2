"""Tendons that reach a point of a beam: it moves between two links, as sensors that sit there do.

What is tied to the nearer link alone misses the beam's twist in first order of the length of a link.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.simulation.airframe import AirframeParts
from vgvt.simulation.seats import seats_at

WORLD = "world"
"""What does not move."""
FAR_M = 1000.0
"""Far enough that a spring to the ground keeps its direction to 1e-5 for a centimetre across it."""


def reach(
    rod: mujoco.MjsTendon,
    spec: mujoco.MjSpec,
    parts: AirframeParts,
    name: str,
    place: tuple[str, Sequence[float]],
    away: tuple[str, NDArray[np.float64]],
) -> None:
    """Let a tendon grow by how far a ``place``, part and point (3,), comes from what is ``away`` of it.

    That is a body, or the world, and an offset (3,), far enough to keep its direction. One branch for each point that
    the place's motion is a sum of, by its weight.
    """
    part, point = place
    anchor, offset_m = away
    for k, seat in enumerate(seats_at(parts, part, np.array(point))):
        rod.wrap_pulley(1.0 / seat.weight)
        origin_m = 0.0 if anchor == WORLD else parts.origin_m[anchor]
        spec.body(anchor).add_site(name=f"{name}/far-{k}", pos=seat.position_m + offset_m - origin_m)
        spec.body(seat.carrier).add_site(name=f"{name}/near-{k}", pos=seat.position_m - parts.origin_m[seat.carrier])
        rod.wrap_site(f"{name}/far-{k}")
        rod.wrap_site(f"{name}/near-{k}")
