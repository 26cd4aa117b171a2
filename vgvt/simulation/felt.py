"""What sensors feel of a structure: rows of displacement and gravity over its coordinates, all points at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.recent import Recent
from vgvt.simulation.rig import GRAVITY_M_PER_S2
from vgvt.simulation.seats import MeasurementPoint

Array = NDArray[np.float64]
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class _Places:
    """The seats of points one after another: whose they are (S,), their carriers, position and axis (S, 3), weight."""

    point: NDArray[np.intp]
    carriers: tuple[str, ...]
    position_m: Array
    axis: Array
    weight: Array
    rides_on: tuple[str, ...]
    rides_at_m: Array


def felt_by(
    points: Sequence[MeasurementPoint],
    origin_m: Mapping[str, Array],
    names: Sequence[str],
    bodies: Array,
    attitude: Array,
) -> tuple[Array, Array, Array]:
    """Displacement of what carries sensors in world axes (P, 3, n), and what they feel along their axes (P, n) of
    displacement and of gravity.

    Of bodies by their names, ``bodies`` (B, 6, n) are the rows of their frames, which sit at ``origin_m`` (3,) of the
    unloaded shape, and ``attitude`` (B, 3, 3) is how they stand. What a sensor weighs rides on a link, what it feels is
    the beam between two.
    """
    places, index = _places(points), {name: k for k, name in enumerate(names)}
    origins_m = np.array([origin_m[name] for name in names])
    rides = np.array([index[c] for c in places.rides_on], dtype=np.intp)
    arm_m = _turned(attitude[rides], places.rides_at_m - origins_m[rides])
    # What turns about the frame moves by turn × arm, and that is -arm × turn.
    moved = bodies[rides, :3] - _cross_matrices(arm_m) @ bodies[rides, 3:]
    seats = np.array([index[c] for c in places.carriers], dtype=np.intp)
    arm_m = _turned(attitude[seats], places.position_m - origins_m[seats])
    along = places.weight[:, None] * _turned(attitude[seats], places.axis)
    # Of every body's displacement and turn, what each point's seats add up to.
    senses, leans = np.zeros((2, len(points), len(names), 6))
    np.add.at(senses, (places.point, seats), np.hstack([along, np.cross(arm_m, along)]))
    np.add.at(leans[..., 3:], (places.point, seats), GRAVITY_M_PER_S2 * np.cross(along, _UP))
    wide = bodies.reshape(-1, bodies.shape[-1])
    return moved, senses.reshape(len(points), -1) @ wide, leans.reshape(len(points), -1) @ wide


def _turned(attitude: Array, vectors: Array) -> Array:
    """Vectors (S, 3), each by its own attitude (S, 3, 3)."""
    return np.asarray((attitude @ vectors[..., None])[..., 0])


def _cross_matrices(vectors: Array) -> Array:
    """The matrices (S, 3, 3) that give vectors (S, 3) times another: v × w."""
    x, y, z = vectors.T
    nothing = np.zeros_like(x)
    return np.stack([nothing, -z, y, z, nothing, -x, -y, x, nothing], axis=-1).reshape(-1, 3, 3)


def _placed(points: Sequence[MeasurementPoint]) -> _Places:
    seats = [(k, seat, point.axis) for k, point in enumerate(points) for seat in point.seated]
    return _Places(
        np.array([k for k, _, _ in seats], dtype=np.intp),
        tuple(seat.carrier for _, seat, _ in seats),
        np.array([seat.position_m for _, seat, _ in seats]).reshape(-1, 3),
        np.array([axis for _, _, axis in seats]).reshape(-1, 3),
        np.array([seat.weight for _, seat, _ in seats]),
        tuple(point.carrier for point in points),
        np.array([point.position_m for point in points]).reshape(-1, 3),
    )


# A grid's points are asked of one structure after another.
_places = Recent(_placed)
