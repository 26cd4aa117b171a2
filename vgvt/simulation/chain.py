"""A beam as a chain: rigid links with the flexibility of each cell gathered at its centre.

The compliance of a cell, the integral of ds/EI, sits at the centroid of that
compliance; the mass between two such hinges moves as one rigid link. Inside a
uniform beam the errors of bending stiffness and of inertia cancel to fourth
order; the ends and torsion leave an error of second order in the cell length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.airframe import Beam
from vgvt.simulation.inertia import NOTHING, MassMoments
from vgvt.simulation.stations import StationTable


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


def cut(beam: Beam) -> Chain:
    """Cut a beam (mirror image already written out) into its chain."""
    table = StationTable.of(beam)
    edges = np.linspace(0.0, table.length_m, beam.cells + 1)
    arcs = table.compliances("bending_stiffness_n_m2", edges)[1]
    ends = np.array([0.0, *arcs, table.length_m])
    stub, *pieces = table.moments(ends)
    stub_air, *airs = table.air_moments(ends) or (NOTHING,) * (len(pieces) + 1)
    hinges = _cell_hinges(table, arcs, edges)
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


def _cell_hinges(
    table: StationTable, arcs_m: NDArray[np.float64], edges_m: NDArray[np.float64]
) -> list[tuple[Hinge, ...]]:
    """Hinges of the cells between edges (K + 1,), at arc lengths (K,)."""
    tangent, normal, aft = np.moveaxis(table.frames(arcs_m), 1, 0)
    # A positive rotation lifts the tip along the normal (bending) or sweeps it aft (in-plane).
    axes = {
        "bending": ("bending_stiffness_n_m2", np.cross(tangent, normal)),
        "in-plane": ("in_plane_stiffness_n_m2", np.cross(tangent, aft)),
        "torsion": ("torsional_stiffness_n_m2", tangent),
    }
    kinds = [
        [
            Hinge(kind, axis, 1.0 / compliance)
            for axis, compliance in zip(turns, table.compliances(column, edges_m)[0].tolist(), strict=True)
        ]
        for kind, (column, turns) in axes.items()
        if getattr(table.beam.stations, column) is not None
    ]
    return list(zip(*kinds, strict=True))


def _root_hinges(table: StationTable) -> tuple[Hinge, ...]:
    tangent, normal, _ = table.frame(0.0)
    springs = (
        ("bending", np.cross(tangent, normal), table.beam.root_bending_stiffness_n_m_per_rad),
        ("torsion", tangent, table.beam.root_torsional_stiffness_n_m_per_rad),
    )
    return tuple(Hinge(kind, axis, stiffness) for kind, axis, stiffness in springs if stiffness is not None)
