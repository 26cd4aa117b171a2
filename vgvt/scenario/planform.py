"""The planform: which part of the aircraft a point is on, how far off it is, and how high the surface lies."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.airframe import Airframe, Beam, Damping, Stations
from vgvt.scenario.axis import Axis, beam_axis
from vgvt.scenario.mirror import expanded_beams
from vgvt.scenario.recent import Recent

# Of a station table what says where a surface is, and the rest.
_SHAPE = frozenset({"position_m", "forward_edge_m", "aft_edge_m"})
_OF_NO_SHAPE = tuple(name for name in Stations.model_fields if name not in _SHAPE)
_FLAT = 0.1
"""Least vertical part of a normal for a surface to have a height over (x, y)."""


def part_at(airframe: Airframe, position_m: Sequence[float]) -> str:
    """The part that a point is on: 'body' or the name of an expanded beam; the nearest one for a point off them all.

    ``position_m`` is (x, y, z), or (x, y) for a point on the surface itself.
    Parts without an outline take the points that no outline holds.
    """
    return _part_at(planform_of(airframe), tuple(float(c) for c in position_m))


def _planform_of(airframe: Airframe) -> Airframe:
    """The airframe with the same value in everything that moves no point; a field that does must stay as it is."""
    body = airframe.body.model_copy(
        update={
            "mass_kg": 1.0,
            "centre_of_gravity_m": (0.0, 0.0, airframe.body.centre_of_gravity_m[2]),
            "inertia_kg_m2": (1.0, 1.0, 1.0),
            "carry_through_stiffness_n_m_per_rad": None,
        }
    )
    beams = tuple(
        b.model_copy(
            update={
                "cells": 1,
                "root_bending_stiffness_n_m_per_rad": None,
                "root_torsional_stiffness_n_m_per_rad": None,
                "stations": b.stations.model_copy(update=dict.fromkeys(_OF_NO_SHAPE, None)),
            }
        )
        for b in airframe.beam
    )
    none = {"name": "", "configuration": "", "sources": (), "item": (), "hinged": (), "damping": Damping()}
    return airframe.model_copy(update={**none, "body": body, "beam": beams})


planform_of: Recent[Airframe, Airframe] = Recent(_planform_of)
"""An airframe of which nothing is left but its shape, where points are: stiffer, heavier or looser it is the same."""


# Effects ask again and again where the same few points are.
@lru_cache(maxsize=512)
def _part_at(airframe: Airframe, position_m: tuple[float, ...]) -> str:
    beams = expanded_beams(airframe)
    distance = {name: distance_off_m(airframe, name, position_m) for name in ("body", *(b.name for b in beams))}
    outlined = {name: off for name, off in distance.items() if off is not None}
    on = [name for name, off in outlined.items() if off == 0.0]
    if on:
        return min(on, key=lambda name: _height_off_m(airframe, name, position_m))
    bare = [b for b in beams if distance[b.name] is None]
    beside = [(off, b.name) for b in bare if (off := _distance_beside_axis_m(b, position_m)) is not None]
    if beside:
        return min(beside)[1]
    if distance["body"] is None:
        return "body"
    return min(outlined, key=lambda name: outlined[name])


def distance_off_m(airframe: Airframe, part: str, position_m: Sequence[float]) -> float | None:
    """How far a point lies outside the planform of a part, in its plane; 0 inside, None for a part without outline."""
    if part == "body":
        outline = np.array(airframe.body.outline_m)
        return None if len(outline) < 3 else _distance_to_polygon(np.array(position_m[:2], dtype=float), outline)
    beam = _beam(airframe, part)
    if not _has_outline(beam):
        return None
    axis, edges = beam_axis(beam), _edges(beam)
    return min(
        _distance_to_polygon(inside[:2], _segment_polygon(axis, edges, i))
        for i, inside in enumerate(_in_segments(axis, position_m))
    )


def chord_m(airframe: Airframe, part: str) -> float:
    """The longest chord of a beam, from forward to aft edge; 0 for the body and for a beam without edges."""
    return 0.0 if part == "body" else float(np.ptp(_edges(_beam(airframe, part)), axis=1).max())


def surface_height_m(airframe: Airframe, part: str, x_m: float, y_m: float) -> float:
    """Height z of a part over (x, y): its plane for a beam, its centre of gravity for the body.

    A vertical surface has no height over (x, y); it gives that of its nearest axis point.
    """
    return _surface_height_m(planform_of(airframe), part, x_m, y_m)


@lru_cache(maxsize=512)
def _surface_height_m(airframe: Airframe, part: str, x_m: float, y_m: float) -> float:
    if part == "body":
        return airframe.body.centre_of_gravity_m[2]
    axis = beam_axis(_beam(airframe, part))
    i = _nearest_segment(axis, (x_m, y_m))
    start, normal = axis.position_m[i], axis.normal[i]
    if abs(normal[2]) > _FLAT:
        return float(start[2] - (normal[0] * (x_m - start[0]) + normal[1] * (y_m - start[1])) / normal[2])
    along = np.clip(_in_segment(axis, i, (x_m, y_m))[0], 0.0, axis.segment_length_m[i])
    return float(start[2] + along * axis.tangent[i, 2])


def slid_m(
    airframe: Airframe, part: str, position_m: Sequence[float], dx_m: float, dy_m: float
) -> tuple[float, float, float]:
    """Where a point (3,) on a part comes to that is moved along its surface, m: aft, and to the right.

    As much higher or lower besides as the surface is there; up in place of to the right where it stands upright.
    KeyError for a part that the airframe does not have.
    """
    x, y, z = (float(c) for c in position_m)
    if not (dx_m or dy_m):
        return (x, y, z)
    if _stands_upright(planform_of(airframe), part, (x, y, z)):
        return (x + dx_m, y, z + dy_m)
    there, here = (surface_height_m(airframe, part, *at) for at in ((x + dx_m, y + dy_m), (x, y)))
    return (x + dx_m, y + dy_m, z + there - here)


@lru_cache(maxsize=512)
def _stands_upright(airframe: Airframe, part: str, position_m: tuple[float, float, float]) -> bool:
    if part == "body":
        return False
    axis = beam_axis(_beam(airframe, part))
    return bool(abs(axis.normal[_nearest_segment(axis, position_m)][2]) <= _FLAT)


def outlines_m(airframe: Airframe) -> tuple[NDArray[np.float64], ...]:
    """Closed outlines (P, 3) of every part that has one, body first; for drawings."""
    outlines = []
    if len(airframe.body.outline_m) >= 3:
        flat = np.array(airframe.body.outline_m)
        corners = np.column_stack([flat, np.full(len(flat), airframe.body.centre_of_gravity_m[2])])
        outlines.append(np.vstack([corners, corners[:1]]))
    outlines += [_beam_outline_m(beam) for beam in expanded_beams(airframe) if _has_outline(beam)]
    return tuple(outlines)


def edge_lines_m(beam: Beam) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Forward and aft edge of an expanded beam at its stations, each (N, 3); on the axis where it has no edges."""
    axis, edges = beam_axis(beam), _edges(beam)
    segment = np.minimum(np.arange(len(axis.position_m)), len(axis.tangent) - 1)
    across = np.array([axis.aft[i] + _slant(axis, i) * axis.tangent[i] for i in segment])
    return axis.position_m + edges[:, :1] * across, axis.position_m + edges[:, 1:] * across


def _beam(airframe: Airframe, part: str) -> Beam:
    beams = {b.name: b for b in expanded_beams(airframe)}
    if part not in beams:
        raise KeyError(f"no part {part!r}; the airframe has body, {', '.join(beams)}")
    return beams[part]


def _has_outline(beam: Beam) -> bool:
    return beam.stations.forward_edge_m is not None or beam.stations.aft_edge_m is not None


def _edges(beam: Beam) -> NDArray[np.float64]:
    """Forward (negative) and aft edge of every station, shape (N, 2), along ``aft``."""
    none = (0.0,) * len(beam.stations.position_m)
    forward = np.array(beam.stations.forward_edge_m or none)
    return np.column_stack([-forward, np.array(beam.stations.aft_edge_m or none)])


def _segment_polygon(axis: Axis, edges: NDArray[np.float64], i: int) -> NDArray[np.float64]:
    """Corners (4, 2) of a segment along (tangent, aft); its ends are cut streamwise, as ribs and tips are."""
    (forward_0, aft_0), (forward_1, aft_1) = edges[i], edges[i + 1]
    length, slant = axis.segment_length_m[i], _slant(axis, i)
    return np.array(
        [
            (forward_0 * slant, forward_0),
            (length + forward_1 * slant, forward_1),
            (length + aft_1 * slant, aft_1),
            (aft_0 * slant, aft_0),
        ]
    )


def _slant(axis: Axis, i: int) -> float:
    """How far a streamwise cut runs along the axis per distance across it; none for a beam along x."""
    return float(axis.tangent[i, 0] / axis.aft[i, 0]) if axis.aft[i, 0] > 0.5 else 0.0


def _beam_outline_m(beam: Beam) -> NDArray[np.float64]:
    forward, aft = edge_lines_m(beam)
    return np.vstack([forward, aft[::-1], forward[:1]])


def _in_segment(axis: Axis, i: int, position_m: Sequence[float]) -> NDArray[np.float64]:
    """The point along (tangent, aft, normal) from the start of a segment; (x, y) alone is put into its plane."""
    found: NDArray[np.float64] = _in_segments(axis, position_m)[i]
    return found


def _in_segments(axis: Axis, position_m: Sequence[float]) -> NDArray[np.float64]:
    """The point along (tangent, aft, normal) from the start of every segment, (N - 1, 3)."""
    start, tangent, normal = axis.position_m[:-1], axis.tangent, axis.normal
    if len(position_m) == 2:
        arm = np.zeros_like(start)
        arm[:, :2] = np.asarray(position_m, dtype=float) - start[:, :2]
        flat = np.abs(normal[:, 2]) > _FLAT
        steep = np.where(flat, normal[:, 2], 1.0)
        in_plane = -(normal[:, 0] * arm[:, 0] + normal[:, 1] * arm[:, 1]) / steep
        arm[:, 2] = np.where(flat, in_plane, tangent[:, 2] * axis.segment_length_m / 2)
    else:
        arm = np.asarray(position_m, dtype=float) - start
    return np.stack([(arm * direction).sum(axis=1) for direction in (tangent, axis.aft, normal)], axis=1)


def _nearest_segment(axis: Axis, position_m: Sequence[float]) -> int:
    along, across, _ = _in_segments(axis, position_m).T
    beyond = along - np.clip(along, 0.0, axis.segment_length_m)
    return int(np.argmin(np.hypot(beyond, across)))


def _distance_beside_axis_m(beam: Beam, position_m: Sequence[float]) -> float | None:
    """Distance from the axis of a beam without outline; None for a point beyond its ends."""
    axis = beam_axis(beam)
    i = _nearest_segment(axis, position_m)
    along, across, off = _in_segment(axis, i, position_m)
    inside = (along >= 0 or i > 0) and (along <= axis.segment_length_m[i] or i < len(axis.tangent) - 1)
    return float(np.hypot(across, off)) if inside else None


def _height_off_m(airframe: Airframe, part: str, position_m: Sequence[float]) -> float:
    """How far above or below a part a point lies; 0 for a point given by (x, y), and for the body, which is solid."""
    if part == "body" or len(position_m) == 2:
        return 0.0
    axis = beam_axis(_beam(airframe, part))
    return float(abs(_in_segment(axis, _nearest_segment(axis, position_m), position_m)[2]))


def _distance_to_polygon(point: NDArray[np.float64], corners: NDArray[np.float64]) -> float:
    """Distance of a point (2,) from a polygon (P, 2); 0 inside and on the edge."""
    start, end = corners, np.roll(corners, -1, axis=0)
    edge, arm = end - start, point - start
    crosses = (start[:, 1] > point[1]) != (end[:, 1] > point[1])
    rise = np.where(crosses, edge[:, 1], 1.0)
    if np.count_nonzero(crosses & (arm[:, 0] < arm[:, 1] * edge[:, 0] / rise)) % 2:
        return 0.0
    squared = np.maximum((edge**2).sum(axis=1), 1e-300)
    fraction = np.clip((arm * edge).sum(axis=1) / squared, 0.0, 1.0)
    return float(np.linalg.norm(arm - fraction[:, None] * edge, axis=1).min())
