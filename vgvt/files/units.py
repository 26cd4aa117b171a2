"""Units that people write in a channel table, and what they are in SI."""

from __future__ import annotations

import math
from dataclasses import dataclass

from vgvt.data import Quantity
from vgvt.data.suggestion import choose_one_of

STANDARD_GRAVITY_M_PER_S2 = 9.80665
POUND_FORCE_N = 4.4482216152605
KILOGRAM_FORCE_N = STANDARD_GRAVITY_M_PER_S2

LENGTHS_M = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}

ANGLES_RAD = {"rad": 1.0, "deg": math.pi / 180}
"""Of motion about an axis, as at ``12+RY``."""

QUANTITIES = {
    "acceleration": Quantity.ACCELERATION,
    "velocity": Quantity.VELOCITY,
    "displacement": Quantity.DISPLACEMENT,
    "force": Quantity.EXCITATION_FORCE,
    "voltage": Quantity.GENERAL,
}

# SI units per unit, by quantity.
UNITS: dict[Quantity, dict[str, float]] = {
    Quantity.ACCELERATION: {
        "m/s^2": 1.0,
        "m/s²": 1.0,
        "g": STANDARD_GRAVITY_M_PER_S2,
        **{f"{name}/s^2": metres for name, metres in LENGTHS_M.items() if name != "m"},
        **{f"{name}/s^2": radians for name, radians in ANGLES_RAD.items()},
    },
    Quantity.VELOCITY: {f"{name}/s": size for name, size in (LENGTHS_M | ANGLES_RAD).items()},
    Quantity.DISPLACEMENT: LENGTHS_M | ANGLES_RAD,
    Quantity.EXCITATION_FORCE: {
        "N": 1.0,
        "kN": 1000.0,
        "mN": 0.001,
        "lb": POUND_FORCE_N,
        "lbf": POUND_FORCE_N,
        "kgf": KILOGRAM_FORCE_N,
    },
    Quantity.GENERAL: {"V": 1.0, "mV": 0.001},
}

_VOLTS = {"V": 1.0, "mV": 0.001}


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """Volts at the converter per unit of what is measured."""

    volts: float
    unit: str

    def v_per_si(self, quantity: Quantity) -> float:
        """Volts per SI unit of the quantity."""
        return self.volts / unit_in_si(quantity, self.unit)

    @classmethod
    def from_text(cls, text: str) -> Sensitivity:
        """Parse ``10 mV/g`` or ``0.4684 V/lb``; ValueError with the accepted form."""
        form = f"{text!r} is not a sensitivity; write a number, V or mV, and the unit, like '10 mV/g' or '0.4684 V/lb'"
        number, _, units = text.strip().partition(" ")
        numerator, slash, unit = units.strip().partition("/")
        try:
            value = float(number)
        except ValueError:
            raise ValueError(form) from None
        if not slash or numerator.strip() not in _VOLTS or not unit.strip():
            raise ValueError(form)
        if not 0 < abs(value) < float("inf"):
            raise ValueError(f"a sensitivity of {text!r} cannot be divided by; write the one on the calibration sheet")
        return cls(value * _VOLTS[numerator.strip()], unit.strip())


def unit_in_si(quantity: Quantity, unit: str) -> float:
    """SI units per ``unit``; ValueError that lists the units of this quantity."""
    known = UNITS[quantity]
    if unit not in known:
        name = next(n for n, q in QUANTITIES.items() if q is quantity)
        raise ValueError(f"{unit!r} is not a unit of {name}; {choose_one_of(unit, known)}")
    return known[unit]
