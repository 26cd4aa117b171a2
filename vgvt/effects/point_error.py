"""Where the test geometry is wrong about a sensor, or about the way the shaker pushes; as data."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from vgvt.data import Direction
from vgvt.effects.elements import Vector
from vgvt.scenario.airframe import Airframe
from vgvt.scenario.planform import slid_m


@dataclass(frozen=True, slots=True)
class PointError:
    """The accelerometer of a node sits elsewhere, or senses along another axis, than its label says.

    It sits at the place of ``at_node`` (swapped sensors) and ``shift_m`` from there, in aircraft axes, and
    ``on_surface`` as much higher or lower besides as the part is there, or on a fin up in place of to the right
    (:func:`shifted_m`). Effects that exchange sensors one after another each take them from where they have come to
    sit (:func:`seats`).
    It reads motion . (direction + ``lean`` + ``cross_sensitivity``), all fixed to the part: the housing leans, while
    what a sensor feels across its axis is its own and is seen on no housing. Several errors of one node add up.
    For the shaker's node only ``lean`` counts: the push turns to the unit vector along direction + lean.
    Geometry and truth of the sensors keep to the labels; that of the force is where it acts.
    """

    node: int
    at_node: int | None = None
    shift_m: Vector = (0.0, 0.0, 0.0)
    lean: Vector = (0.0, 0.0, 0.0)
    cross_sensitivity: Vector = (0.0, 0.0, 0.0)
    on_surface: bool = False


def seats(points: Iterable[Sequence[PointError]]) -> dict[int, int]:
    """At whose places sensors sit, both by the nodes of their labels; those that are not named sit at their own.

    ``points`` are those of one effect after another: what a later one exchanges is what earlier ones left.
    """
    at: dict[int, int] = {}
    for errors in points:
        at |= {e.node: at.get(e.at_node, e.at_node) for e in errors if e.at_node is not None}
    return at


def shifted_m(airframe: Airframe, part: str, seat_m: Sequence[float], errors: Sequence[PointError]) -> Vector:
    """Where a sensor (3,) sits that ``errors`` shift from its seat (3,) on a part (a name after mirroring), m.

    KeyError for a part that the airframe does not have.
    """
    loose, slid = ([e.shift_m for e in errors if e.on_surface is on] for on in (False, True))
    seat = [float(sum(along)) for along in zip(seat_m, *loose, strict=True)]
    dx, dy, up = (float(sum(along)) for along in zip((0.0, 0.0, 0.0), *slid, strict=True))
    x, y, z = slid_m(airframe, part, seat, dx, dy)
    return (x, y, z + up)


def across(direction: Direction, azimuth_rad: float) -> Vector:
    """The unit vector across a direction at an azimuth; for one that is up or down: 0 aft, pi/2 to the right."""
    own = abs(direction.value) - 1
    vector = [0.0, 0.0, 0.0]
    vector[(own + 1) % 3], vector[(own + 2) % 3] = math.cos(azimuth_rad), math.sin(azimuth_rad)
    return (vector[0], vector[1], vector[2])


def turned(direction: Direction, angle_rad: float, azimuth_rad: float) -> Vector:
    """What the unit vector of a direction gains when it is turned by an angle towards an azimuth."""
    aside, shrunk = across(direction, azimuth_rad), math.cos(angle_rad) - 1
    x, y, z = (shrunk * float(d) + math.sin(angle_rad) * a for d, a in zip(direction.unit_vector, aside, strict=True))
    return (x, y, z)


def as_it_sits(vector: Vector, labelled: Direction, sits: Direction) -> Vector:
    """A vector (3,) said of a sensor that measures along its label's direction, where it sits along another one.

    As much along its axis, and as much across it at the same azimuth.
    """
    if labelled is sits:
        return vector
    here, there = (np.array([d.unit_vector, across(d, 0.0), across(d, math.pi / 2)]) for d in (labelled, sits))
    x, y, z = (float(v) for v in here @ np.array(vector) @ there)
    return (x, y, z)
