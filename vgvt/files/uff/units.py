"""Units that a Universal File states: labels of axes, and the system of dataset 164."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from vgvt.data import Quantity
from vgvt.files.uff.fields import real
from vgvt.files.units import UNITS

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
_OTHER_SPELLINGS = {
    "G": "g",
    "gn": "g",
    "g's": "g",
    "lbs": "lbf",
    "newton": "N",
    "Newton": "N",
    "volt": "V",
    "Volt": "V",
    "volts": "V",
    "Volts": "V",
    "v": "V",
}
_TOLERANCE = 1e-3


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

    def in_si(self, quantity: Quantity) -> float | None:
        """SI units per unit of the file; None for a quantity that is neither motion nor force."""
        if quantity is Quantity.EXCITATION_FORCE:
            return 1 / self.forces_a_newton
        return None if quantity is Quantity.GENERAL else 1 / self.lengths_a_metre


def unit_of_label(label: str) -> tuple[Quantity, str] | None:
    """The quantity and unit, as sidecars spell it, that a label like ``m/s2`` means; None where it is none of them."""
    spelt = label.replace(" ", "").replace("**", "^").replace("²", "^2").replace("sec", "s")
    spelt = re.sub(r"/\(?s\^?2\)?$", "/s^2", spelt)
    spelt = _OTHER_SPELLINGS.get(spelt, spelt)
    return next(((quantity, spelt) for quantity, units in UNITS.items() if spelt in units), None)


def unit_of_factor(quantity: Quantity, in_si: float) -> str | None:
    """The unit of a quantity that is so many SI units, as sidecars spell it; None where there is none."""
    return next((name for name, factor in UNITS[quantity].items() if same_unit(factor, in_si)), None)


def same_unit(in_si: float, other_in_si: float) -> bool:
    """True where two units are one, but for how exactly their factors are written."""
    return abs(in_si / other_in_si - 1) <= _TOLERANCE
