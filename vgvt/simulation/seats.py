"""Where a sensor on a beam sits: between two links of its chain, as the beam between them moves.

A link has the slope and the twist of its beam at one station, the edge of its cell, and lies on the beam there. Between
two stations a beam bends into a parabola that has both slopes, and twists from one to the other. A point that rides on
the nearer link misses the first by the square of a link's length, and the second by the length itself. So a sensor
reads a sum of what points of both links do, in which a motion of both as one body counts once. Each link counts by how
near its station is, so that what turns, and what feels the weight along its axis, turns from one slope to the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Dof
from vgvt.scenario.mirror import part_name
from vgvt.simulation.airframe import AirframeParts

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Seat:
    """A point (3,) of a rigid body, by name, that counts with its ``weight`` in what a sensor reads."""

    carrier: str
    position_m: Array
    weight: float


@dataclass(frozen=True, slots=True, eq=False)
class MeasurementPoint:
    """A place for a sensor: its DOF, site name, part, position (3,) and the rigid body that carries it.

    ``axis`` (3,) is what it senses along: the DOF's direction, unless an effect leans it. ``seats`` are what a sensor
    between two links of a beam feels a sum of; with none it rides on its carrier.
    """

    dof: Dof
    site: str
    part: str
    position_m: NDArray[np.float64]
    carrier: str
    axis: NDArray[np.float64]
    seats: tuple[Seat, ...] = ()

    @property
    def seated(self) -> tuple[Seat, ...]:
        """The seats that a sensor feels a sum of: its own place alone where it rides on a link."""
        return self.seats or (Seat(self.carrier, self.position_m, 1.0),)

    @property
    def weighted_sites(self) -> tuple[tuple[str, float], ...]:
        """The sites that a sensor feels a sum of, and how much each counts: its own alone where it rides on a link."""
        names = (f"{self.site}-seat-{k + 1}" for k in range(len(self.seats)))
        found = tuple((name, seat.weight) for name, seat in zip(names, self.seats, strict=True))
        return found or ((self.site, 1.0),)


def seats_at(parts: AirframeParts, part: str, position_m: Array) -> tuple[Seat, ...]:
    """What a point (3,) of a part does as a sum over points of links; one seat where one rigid body carries it.

    Their weights add up to one.
    """
    carriers = parts.shares(part, position_m)
    if len(carriers) == 1:
        # On the body, before a beam's first station or behind its last.
        return (Seat(carriers[0][0], position_m, 1.0),)
    chain = parts.chains[part_name(parts.airframe, part, float(position_m[1]))]
    arc = chain.table.nearest_arc_m(position_m)
    (link, _), (further, outer) = chain.shares(arc)
    assert further is not None
    # Both links hang together at the hinge between their stations. With the inner one fixed, a point at the share s of
    # the way rises by s² of what the outer station does: s of what the outer link does that far from the hinge. What is
    # off the axis turns by a share of either link's turn.
    station = chain.table.point_m(0.0 if link is None else link.twist_arc_m)
    reach = further.position_m - station
    (inner_body, inner), (outer_body, _) = carriers
    return (
        Seat(inner_body, position_m - outer * reach, inner),
        Seat(outer_body, position_m + inner * reach, outer),
    )
