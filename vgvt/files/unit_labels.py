"""Labels of units as programs write them into files, and the unit that each means."""

from __future__ import annotations

import re

from vgvt.data import Quantity
from vgvt.files.units import UNITS

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
