"""Degrees of freedom, labelled as test engineers write them: node and direction, ``12+Z``."""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

_LABEL = re.compile(r"^\s*(?P<node>\d+)\s*(?P<sign>[+-]?)\s*(?P<axis>R?[XYZ]|S)\s*$", re.IGNORECASE)


class Direction(IntEnum):
    """Direction of a degree of freedom; values are the codes of UFF dataset 58."""

    SCALAR = 0
    PLUS_X = 1
    PLUS_Y = 2
    PLUS_Z = 3
    PLUS_ROTATION_X = 4
    PLUS_ROTATION_Y = 5
    PLUS_ROTATION_Z = 6
    MINUS_X = -1
    MINUS_Y = -2
    MINUS_Z = -3
    MINUS_ROTATION_X = -4
    MINUS_ROTATION_Y = -5
    MINUS_ROTATION_Z = -6

    @property
    def label(self) -> str:
        """The direction as in a DOF label: ``+Z``, ``-RX``, ``S`` for a scalar."""
        if self is Direction.SCALAR:
            return "S"
        axis = ("X", "Y", "Z", "RX", "RY", "RZ")[abs(self.value) - 1]
        return ("+" if self.value > 0 else "-") + axis

    @property
    def sign(self) -> int:
        """+1, or -1 for the negative directions."""
        return -1 if self.value < 0 else 1

    @property
    def unit_vector(self) -> NDArray[np.float64]:
        """Unit vector, shape (3,), of a translation; for a rotation, its axis."""
        vector = np.zeros(3)
        if self is not Direction.SCALAR:
            vector[(abs(self.value) - 1) % 3] = self.sign
        return vector

    @property
    def is_rotation(self) -> bool:
        """True for the six rotational directions."""
        return abs(self.value) > 3

    @classmethod
    def from_label(cls, text: str) -> Direction:
        """The direction of ``+Z``, ``Z``, ``-rx``; ValueError otherwise."""
        return Dof.from_label("0" + text).direction


@dataclass(frozen=True, slots=True, order=True)
class Dof:
    """One degree of freedom: a node of the geometry and a direction."""

    node: int
    direction: Direction

    def __str__(self) -> str:
        return f"{self.node}{self.direction.label}"

    def __repr__(self) -> str:
        return f"<{self}>"

    @property
    def label(self) -> str:
        """``12+Z``."""
        return str(self)

    @property
    def unsigned(self) -> Dof:
        """The same DOF along the positive axis."""
        return Dof(self.node, Direction(abs(self.direction.value)))

    @classmethod
    def from_label(cls, text: str) -> Dof:
        """Parse ``12+Z``; a missing sign means plus. Raises ValueError with the accepted form."""
        match = _LABEL.match(text)
        if match is None:
            raise ValueError(f"not a degree of freedom: {text!r}; write node and direction, like 12+Z or 3-RX")
        if match["axis"].upper() == "S":
            return cls(int(match["node"]), Direction.SCALAR)
        code = ("X", "Y", "Z", "RX", "RY", "RZ").index(match["axis"].upper()) + 1
        return cls(int(match["node"]), Direction(-code if match["sign"] == "-" else code))
