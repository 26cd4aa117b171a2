"""What a Universal File states of quantities and units: data types, and the system of dataset 164."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vgvt.data import Quantity
from vgvt.files.uff.fields import real

# Specific data types of dataset 58 that a sidecar has a quantity for; a reaction force is a measured force.
QUANTITY_OF_CODE = {
    8: Quantity.DISPLACEMENT,
    9: Quantity.EXCITATION_FORCE,
    11: Quantity.VELOCITY,
    12: Quantity.ACCELERATION,
    13: Quantity.EXCITATION_FORCE,
}
NOT_STATED = (0, 1)
"""Specific data types that say nothing: unknown, and general."""
CODES_IN_WORDS = {
    2: "stress",
    3: "strain",
    5: "temperature",
    6: "heat flux",
    8: "displacement",
    9: "reaction force",
    11: "velocity",
    12: "acceleration",
    13: "excitation force",
    15: "pressure",
    16: "mass",
    17: "time",
    18: "frequency",
    19: "rotational speed",
    20: "order",
}


@dataclass(frozen=True, slots=True)
class UnitSystem:
    """Dataset 164: how many length and force units of the file are one metre and one newton."""

    lengths_a_metre: float
    forces_a_newton: float

    @classmethod
    def from_lines(cls, lines: Sequence[str]) -> UnitSystem:
        """Parse the lines of a dataset 164; ValueError where they are none."""
        numbers = [real(word) for line in lines[1:] for word in line.split()]
        if len(numbers) < 2 or not all(0 < number < float("inf") for number in numbers[:2]):
            raise ValueError("no factors of length and force")
        return cls(numbers[0], numbers[1])

    def in_si(self, quantity: Quantity, about_an_axis: bool) -> float | None:
        """SI units per unit of the file; None for what is neither motion nor force, or is a rotation or a moment.

        A length says nothing of angles, and angles have no factor in dataset 164.
        """
        if about_an_axis:
            return None
        if quantity is Quantity.EXCITATION_FORCE:
            return 1 / self.forces_a_newton
        return None if quantity is Quantity.GENERAL else 1 / self.lengths_a_metre
