"""Where the test geometry is wrong about a sensor, or about the way the shaker pushes; as data."""

from __future__ import annotations

from dataclasses import dataclass

from vgvt.effects.elements import Vector


@dataclass(frozen=True, slots=True)
class PointError:
    """The accelerometer of a node sits elsewhere, or senses along another axis, than its label says.

    It sits at the place of ``at_node`` (swapped sensors) and ``shift_m`` from there, in aircraft axes.
    It reads motion . (direction + ``lean``), both fixed to the part. Several errors of one node add up.
    For the shaker's node only ``lean`` counts: the push turns to the unit vector along direction + lean.
    Geometry and truth of the sensors keep to the labels; that of the force is where it acts.
    """

    node: int
    at_node: int | None = None
    shift_m: Vector = (0.0, 0.0, 0.0)
    lean: Vector = (0.0, 0.0, 0.0)
