"""Mass, centre of gravity and inertia of an airframe, exact for its station tables."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data.truth import RigidBodyProperties
from vgvt.scenario.airframe import Airframe, Beam
from vgvt.scenario.axis import beam_axis
from vgvt.scenario.mirror import expanded_beams, expanded_items

# Mass per length is linear and the moment arm squared quadratic in arc length;
# two Gauss points are exact for their product, a cubic.
_GAUSS_POINTS = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)


@dataclass(frozen=True, slots=True, eq=False)
class _Lumps:
    """Masses (K,) at positions (K, 3), each with an inertia (K, 3, 3) about its own centre of gravity."""

    mass_kg: NDArray[np.float64]
    position_m: NDArray[np.float64]
    inertia_kg_m2: NDArray[np.float64]


def rigid_body_properties(airframe: Airframe) -> RigidBodyProperties:
    """Mass, centre of gravity and inertia about it of the whole airframe, in aircraft axes, SI.

    Exact for tables that are linear between stations. A section is a thin strip
    in the surface: its inertia about its normal equals its pitch inertia and
    that about its chord is none.
    """
    lumps = [_beam_lumps(beam) for beam in expanded_beams(airframe)]
    body, items = airframe.body, expanded_items(airframe)
    lumps.append(
        _Lumps(
            np.array([body.mass_kg, *(i.mass_kg for i in items)]),
            np.array([body.centre_of_gravity_m, *(i.position_m for i in items)]),
            np.array([np.diag(body.inertia_kg_m2), *(np.diag(i.inertia_kg_m2) for i in items)]),
        )
    )
    return _assembled(lumps)


def beam_properties(beam: Beam) -> RigidBodyProperties:
    """Mass, centre of gravity and inertia of one expanded beam without what is fixed to it."""
    return _assembled([_beam_lumps(beam)])


def _beam_lumps(beam: Beam) -> _Lumps:
    """Gauss points of every segment; they have the exact mass, first and second moments of the table."""
    axis, table = beam_axis(beam), beam.stations
    weight = np.repeat(axis.segment_length_m, 2) / 2

    def at_points(column: tuple[float, ...]) -> NDArray[np.float64]:
        value = np.array(column)
        return np.asarray((value[:-1, None] + np.diff(value)[:, None] * _GAUSS_POINTS).ravel())

    aft = np.repeat(axis.aft, 2, axis=0)
    position = np.stack([at_points(tuple(column)) for column in axis.position_m.T], axis=1)
    position = position + at_points(table.cg_offset_m or (0.0,) * len(axis.position_m))[:, None] * aft
    thin_strip = np.eye(3) - aft[:, :, None] * aft[:, None, :]
    pitch = weight * at_points(table.pitch_inertia_kg_m)
    return _Lumps(weight * at_points(table.mass_kg_per_m), position, pitch[:, None, None] * thin_strip)


def _assembled(parts: list[_Lumps]) -> RigidBodyProperties:
    mass = np.concatenate([p.mass_kg for p in parts])
    position = np.concatenate([p.position_m for p in parts])
    total = float(mass.sum())
    centre = mass @ position / total
    arm = position - centre
    steiner = np.einsum("k,kl,kl->", mass, arm, arm) * np.eye(3) - np.einsum("k,ki,kj->ij", mass, arm, arm)
    inertia = steiner + sum(p.inertia_kg_m2.sum(axis=0) for p in parts)
    return RigidBodyProperties(total, centre, inertia)
