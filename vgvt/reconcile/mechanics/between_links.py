"""What points of a beam do, read off a chain of straight links that twist as a whole: the curve between the links.

A link has the slope and the twist of its beam at one station, the edge of its cell, and lies on the beam there. Between
two stations a beam bends into a parabola that has both slopes, and twists from one to the other. A point that rides on
the nearer link misses the first by the square of a link's length, and the second by the length itself.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.mirror import part_name
from vgvt.simulation.assembly import MeasurementPoint, Plan
from vgvt.simulation.reduced import Structure, structure

Array = NDArray[np.float64]


def between_links(layout: Plan, near: Structure | None = None) -> tuple[Structure, Array]:
    """The structure of a layout, and rows (places + 1, n) of its grid points along their axes, then of its drive.

    ``near`` is a structure whose equilibrium is not far.
    """
    points = (*layout.grid, layout.drive)
    terms = [_terms(layout, point) for point in points]
    seats: dict[tuple[object, ...], MeasurementPoint] = {}
    for point, some in zip(points, terms, strict=True):
        for where, body, _ in some:
            seats.setdefault(_key(point, where, body), replace(point, position_m=where, carrier=body))
    named = [replace(seat, site=f"between-links-{k}") for k, seat in enumerate(seats.values())]
    index = {key: k for k, key in enumerate(seats)}
    weights = np.zeros((len(points), len(named)))
    for row, (point, some) in enumerate(zip(points, terms, strict=True)):
        for where, body, weight in some:
            weights[row, index[_key(point, where, body)]] += weight
    found = structure(layout, named, near)
    return found, weights @ found.axis


def _key(point: MeasurementPoint, where: Array, body: str) -> tuple[object, ...]:
    return point.axis.tobytes(), where.tobytes(), body


def _terms(layout: Plan, point: MeasurementPoint) -> list[tuple[Array, str, float]]:
    """What a point does as a sum over points of links: where each is (3,), its body, its weight."""
    parts, here = layout.parts, point.position_m
    carriers = parts.shares(point.part, here)
    if len(carriers) == 1:
        # On the body, before a beam's first station or behind its last.
        return [(here, carriers[0][0], 1.0)]
    chain = parts.chains[part_name(parts.airframe, point.part, float(here[1]))]
    arc = chain.table.nearest_arc_m(here)
    foot = chain.table.point_m(arc)
    link = chain.shares(arc)[0][0]
    station = chain.table.point_m(0.0 if link is None else link.twist_arc_m)
    (inner_body, _), (outer_body, outer) = carriers
    return [
        # The axis bends away from the inner link; at its station the outer one lies below by half of what it does.
        (foot, inner_body, 1.0),
        (station, outer_body, -(outer**2)), (station, inner_body, outer**2),
        # What is off the axis turns by as much of either link's turn.
        (here, inner_body, 1.0 - outer), (foot, inner_body, outer - 1.0),
        (here, outer_body, outer), (foot, outer_body, -outer),
    ]  # fmt: skip
