"""Directions stated along the axes of a table, along aircraft axes: as vectors are turned, and rotations."""

from __future__ import annotations

from itertools import permutations, product

import numpy as np
import pytest

from vgvt.data import Direction
from vgvt.files.axes import Axes

EVERY_WAY = [
    Axes(aft=f"{a}{x}", right=f"{b}{y}", up=f"{c}{z}")
    for x, y, z in permutations("xyz")
    for a, b, c in product(("", "-"), repeat=3)
]


def cross_matrix(vector: np.ndarray) -> np.ndarray:
    """What a small rotation about an axis does to a point."""
    return np.cross(np.eye(3), -vector)


def test_a_direction_is_turned_as_a_position_is() -> None:
    for axes, direction in product(EVERY_WAY, (Direction.PLUS_X, Direction.MINUS_Y, Direction.PLUS_Z)):
        expected = axes.to_aircraft_m(direction.unit_vector[None])[0]
        np.testing.assert_array_equal(axes.to_aircraft(direction).unit_vector, expected)


def test_a_rotation_moves_the_same_points_the_same_way() -> None:
    """Also where the table's axes are left-handed, in which a rotation about an axis has the other sense."""
    turned = (Direction.PLUS_ROTATION_X, Direction.MINUS_ROTATION_Y, Direction.PLUS_ROTATION_Z)
    for axes, direction in product(EVERY_WAY, turned):
        to = axes.to_aircraft(direction)
        assert to.is_rotation
        moved = axes.turn @ cross_matrix(direction.unit_vector) @ axes.turn.T
        np.testing.assert_array_equal(cross_matrix(to.unit_vector), moved)


@pytest.mark.parametrize("axes", EVERY_WAY[:3])
def test_a_scalar_has_no_direction(axes: Axes) -> None:
    assert axes.to_aircraft(Direction.SCALAR) is Direction.SCALAR
