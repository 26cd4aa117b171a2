"""A beam as a chain: rigid links with the flexibility of each cell gathered at its centre.

The compliance of a cell, the integral of ds/EI, sits at the centroid of that
compliance; the mass between two such hinges moves as one rigid link. Inside a
uniform beam the errors of bending stiffness and of inertia cancel to fourth
order; the ends and torsion leave an error of second order in the cell length.
Where the axis bends, and where a shaker pushes, one cell ends and another begins; within
a cell that is too long for that, hinges turn about the mean of its directions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.airframe import Beam
from vgvt.scenario.cells import Cells, cells_of
from vgvt.simulation.inertia import NOTHING, MassMoments
from vgvt.simulation.stations import StationTable

# What the digits of the stations' coordinates make of a straight axis.
_ROUNDING_RAD = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class Hinge:
    """One spring of a link: its kind, the axis (3,) of a positive rotation and the stiffness."""

    kind: str
    axis: NDArray[np.float64]
    stiffness_n_m_per_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A rigid link, the hinges at its inner end (position (3,)) and the mass between this end and the next.

    It starts at ``start_arc_m`` and has the twist of the beam at ``twist_arc_m``,
    the outer edge of its cell. ``air`` is what it moves of that, without its weight.
    """

    name: str
    position_m: NDArray[np.float64]
    start_arc_m: float
    twist_arc_m: float
    hinges: tuple[Hinge, ...]
    moments: MassMoments
    air: MassMoments = NOTHING


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """The links of one beam from root to tip, and the stub that moves with the parent, with its air."""

    name: str
    parent: str
    table: StationTable
    links: tuple[Link, ...]
    stub: MassMoments
    stub_air: MassMoments = NOTHING

    def link_at(self, arc_m: float) -> Link | None:
        """The link that carries the point at an arc length; None on the stub."""
        carrying = [link for link in self.links if link.start_arc_m <= arc_m]
        return carrying[-1] if carrying else None

    def shares(self, arc_m: float) -> tuple[tuple[Link | None, float], ...]:
        """How a lump at an arc length is shared by the two links around it (None is the stub).

        Links twist in steps; the lever rule between their twist stations keeps
        the torsion of lumped items to second order in the cell length.
        """
        known: list[Link | None] = [*self.links] if self.links[0].twist_arc_m == 0 else [None, *self.links]
        stations = np.array([0.0 if link is None else link.twist_arc_m for link in known])
        i = int(np.clip(np.searchsorted(stations, arc_m, side="right") - 1, 0, len(known) - 2))
        outer = float((arc_m - stations[i]) / (stations[i + 1] - stations[i]))
        return tuple((known[i + k], share) for k, share in enumerate((1 - outer, outer)) if share > 0)


def cut(beam: Beam, pushed_m: tuple[float, ...] = ()) -> Chain:
    """Cut a beam (mirror image already written out) that is pushed at some arc lengths into its chain."""
    table = StationTable.of(beam)
    cells = cells_of(beam, pushed_m)
    edges = cells.edges_m
    arcs = table.compliances("bending_stiffness_n_m2", edges)[1]
    ends = np.array([0.0, *arcs, table.length_m])
    stub, *pieces = table.moments(ends)
    stub_air, *airs = table.air_moments(ends) or (NOTHING,) * (len(pieces) + 1)
    hinges = _cell_hinges(table, arcs, cells)
    positions = table.point_m(arcs)
    links = [
        Link(f"{beam.name}-{i + 1:02d}", positions[i], float(arcs[i]), float(edges[i + 1]), hinges[i], piece, air)
        for i, (piece, air) in enumerate(zip(pieces, airs, strict=True))
    ]
    root = _root_hinges(table)
    if root:
        links.insert(0, Link(f"{beam.name}-root", table.point_m(0.0), 0.0, 0.0, root, stub, stub_air))
        stub = stub_air = NOTHING
    return Chain(beam.name, beam.parent, table, tuple(links), stub, stub_air)


def _cell_hinges(table: StationTable, arcs_m: NDArray[np.float64], cells: Cells) -> list[tuple[Hinge, ...]]:
    """Hinges of the K cells, at arc lengths (K,)."""
    tangent, normal, aft = np.moveaxis(table.frames(arcs_m), 1, 0)
    axis = table.axis
    # A positive rotation lifts the tip along the normal (bending) or sweeps it aft (in-plane).
    turns = {
        "bending": ("bending_stiffness_n_m2", np.cross(tangent, normal), np.cross(axis.tangent, axis.normal)),
        "in-plane": ("in_plane_stiffness_n_m2", np.cross(tangent, aft), axis.normal),
        "torsion": ("torsional_stiffness_n_m2", tangent, axis.tangent),
    }
    kinds = [
        [
            Hinge(kind, about, 1.0 / compliance)
            for about, compliance in zip(
                _mean_of_bent(table, column, cells, there, along),
                table.compliances(column, cells.edges_m)[0].tolist(),
                strict=True,
            )
        ]
        for kind, (column, there, along) in turns.items()
        if getattr(table.beam.stations, column) is not None
    ]
    # A cell's last hinge turns about an axis that its first ones have tilted by all of the cell's static bend, where
    # half would be right. In turns, the errors of neighbours cancel; in one order they add up along the beam, and move
    # the torsion of a wing that sags by some hundredths of a per cent.
    return [tuple(reversed(cell)) if k % 2 else cell for k, cell in enumerate(zip(*kinds, strict=True))]


def _mean_of_bent(
    table: StationTable, column: str, cells: Cells, there: NDArray[np.float64], along: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Unit vectors ``there`` (K, 3), but in cells that bend the mean of what the segments have, ``along`` (N - 1, 3).

    Aft may change sides within a beam, and with it what turns about the normal: the mean faces as ``there`` does.
    """
    bent = cells.bent_rad > _ROUNDING_RAD
    if not bent.any():
        return there
    mean = table.mean_by_compliance(column, along, cells.edges_m)
    mean *= (np.sign(np.sum(mean * there, axis=1)) / np.linalg.norm(mean, axis=1))[:, None]
    return np.where(bent[:, None], mean, there)


def _root_hinges(table: StationTable) -> tuple[Hinge, ...]:
    tangent, normal, _ = table.frame(0.0)
    springs = (
        ("bending", np.cross(tangent, normal), table.beam.root_bending_stiffness_n_m_per_rad),
        ("torsion", tangent, table.beam.root_torsional_stiffness_n_m_per_rad),
    )
    return tuple(Hinge(kind, axis, stiffness) for kind, axis, stiffness in springs if stiffness is not None)
