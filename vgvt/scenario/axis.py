"""The axis of a beam: its straight segments and the directions of their sections."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.airframe import Beam


@dataclass(frozen=True, slots=True, eq=False)
class Axis:
    """The elastic axis between the stations of one beam: N stations, N - 1 straight segments.

    ``position_m`` (N, 3) and ``arc_length_m`` (N,) belong to the stations,
    ``segment_length_m`` (N - 1,), ``tangent``, ``normal`` and ``aft`` (N - 1, 3) to the segments. ``aft`` lies
    in the surface at right angles to the axis and is the positive direction of
    ``cg_offset_m`` and ``aft_edge_m``.
    """

    position_m: NDArray[np.float64]
    arc_length_m: NDArray[np.float64]
    segment_length_m: NDArray[np.float64]
    tangent: NDArray[np.float64]
    normal: NDArray[np.float64]
    aft: NDArray[np.float64]


def beam_axis(beam: Beam) -> Axis:
    """The axis of an expanded beam, to be read and not changed; ValueError where its normal lies along a segment."""
    axis = _axis(beam.stations.position_m, beam.normal)
    if axis is None:
        raise ValueError(f"beam {beam.name!r}: normal {beam.normal} lies along the axis; it is the bending direction")
    return axis


# Thousands of variants of one aircraft differ in stiffness and mass, not in where their beams lie.
@lru_cache(maxsize=128)
def _axis(stations_m: tuple[tuple[float, float, float], ...], up: tuple[float, float, float]) -> Axis | None:
    position = np.array(stations_m)
    step = np.diff(position, axis=0)
    length = np.linalg.norm(step, axis=1)
    tangent = step / length[:, None]
    across = np.array(up) - (tangent @ np.array(up))[:, None] * tangent
    size = np.linalg.norm(across, axis=1)
    if np.any(size < 1e-6 * max(float(np.linalg.norm(up)), 1e-300)):
        return None
    normal = across / size[:, None]
    aft = np.cross(normal, tangent)
    middle_y = (position[1:, 1] + position[:-1, 1]) / 2
    sign = np.array([_aft_sign(a, y) for a, y in zip(aft, middle_y, strict=True)])
    arc = np.concatenate([[0.0], np.cumsum(length)])
    return Axis(position, arc, np.diff(arc), tangent, normal, aft * sign[:, None])


def _aft_sign(across: NDArray[np.float64], y_m: float) -> float:
    """+1 or -1 so that the direction points aft; outboard or up where the axis itself runs fore and aft."""
    if abs(across[0]) > 1e-9:
        return float(np.sign(across[0]))
    if abs(across[1]) > 1e-9:
        return float(np.sign(across[1])) * (-1.0 if y_m < 0 else 1.0)
    return float(np.sign(across[2]))
