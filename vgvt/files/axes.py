"""How the axes of a position table lie in the aircraft."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from vgvt.data import Direction
from vgvt.files.strict import Finite, Table
from vgvt.files.units import LENGTHS_M


class Axes(Table):
    """How the axes of the position table lie in the aircraft: vgvt has x aft from the nose, y right, z up."""

    unit: Literal["m", "cm", "mm", "in", "ft"] = "m"
    aft: str = Field(default="x", pattern="^[+-]?[xyz]$")
    """Which axis of the table points aft, like 'y' or '-x'."""
    right: str = Field(default="y", pattern="^[+-]?[xyz]$")
    up: str = Field(default="z", pattern="^[+-]?[xyz]$")
    nose: tuple[Finite, Finite, Finite] = (0.0, 0.0, 0.0)
    """Where the nose is, in the table's own axes and unit."""

    @model_validator(mode="after")
    def _every_axis_once(self) -> Self:
        if {a[-1] for a in (self.aft, self.right, self.up)} != {"x", "y", "z"}:
            raise ValueError(
                f"aft = {self.aft!r}, right = {self.right!r}, up = {self.up!r} do not use every axis once; "
                "write each of x, y, z in one of them"
            )
        return self

    @property
    def turn(self) -> NDArray[np.float64]:
        """Matrix (3, 3) that turns a vector of the table into aircraft axes."""
        turn = np.zeros((3, 3))
        for row, axis in enumerate((self.aft, self.right, self.up)):
            turn[row, "xyz".index(axis[-1])] = -1.0 if axis.startswith("-") else 1.0
        return turn

    def to_aircraft_m(self, table: NDArray[np.float64]) -> NDArray[np.float64]:
        """Positions (P, 3) of the table in aircraft axes and metres."""
        return np.asarray((table - np.array(self.nose)) @ self.turn.T * LENGTHS_M[self.unit])

    def to_aircraft(self, direction: Direction) -> Direction:
        """The same direction, stated along the table's axes, along aircraft axes."""
        if direction is Direction.SCALAR:
            return direction
        vector = self.turn @ direction.unit_vector
        if direction.is_rotation:  # its sense changes where the table's axes are left-handed
            vector *= round(float(np.linalg.det(self.turn)))
        axis = int(np.argmax(np.abs(vector)))
        code = axis + (4 if direction.is_rotation else 1)
        return Direction(code if vector[axis] > 0 else -code)
