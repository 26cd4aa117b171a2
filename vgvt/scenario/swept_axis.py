"""One axis of a sweep: a key and its values, as they are written on the command line."""

from __future__ import annotations

import math
import re
import tomllib
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from vgvt.data.errors import InputError

_RANGE = re.compile(r"^(?P<low>[^,\[\]]+?)\.\.(?P<high>[^,\[\]:]+)(?::(?P<count>\d+))?(?P<log>:log)?$")


@dataclass(frozen=True, slots=True)
class Axis:
    """One swept key: its values, or the range that a latin hypercube draws from, even in the logarithm if ``log``.

    Ends of a range that are written as whole numbers are ints; ``whole`` takes only ints between them, too.
    """

    key: str
    values: tuple[Any, ...] = ()
    low: float = 0.0
    high: float = 0.0
    log: bool = False
    whole: bool = False

    @classmethod
    def parse(cls, text: str) -> Axis:
        """The axis written as KEY=a,b,c or KEY=low..high[:count][:log]; InputError says what is wrong."""
        key, equals, values = (part.strip() for part in text.partition("="))
        if not equals or not key or not values:
            raise InputError(f"--set {text}", "is not KEY=values", "write excitation.duration_s=30,60 or KEY=1..5:9")
        span = _RANGE.match(values)
        if span is None:
            return cls(key, tuple(_typed(text, v) for v in _listed(values)))
        low, high = (_typed(text, span[end]) for end in ("low", "high"))
        if not _is_number(low) or not _is_number(high) or not low < high:
            raise InputError(f"--set {text}", f"{values!r} is no range", "write two rising numbers, like 1..5")
        if span["log"] and low <= 0:
            raise InputError(f"--set {text}", "a logarithmic range starts above 0", "drop :log or start higher")
        axis = cls(key, (), low, high, bool(span["log"]))
        if span["count"] is None:
            return axis
        if int(span["count"]) < 2:
            raise InputError(f"--set {text}", "a range has two values at least", "write a count of 2 or more")
        at = np.linspace(0, 1, int(span["count"]))
        steps = tuple(axis.at(float(fraction)) for fraction in at)
        if axis.ends_are_whole and all(float(value).is_integer() for value in steps):
            steps = tuple(int(value) for value in steps)
        return replace(axis, values=steps)

    @property
    def ends_are_whole(self) -> bool:
        """Whether both ends of the range were written as whole numbers."""
        return isinstance(self.low, int) and isinstance(self.high, int)

    def in_whole_numbers(self) -> Axis:
        """The axis of a key that takes whole numbers only: what lies between whole ends rounded, each value once."""
        if not self.ends_are_whole:
            return self
        return replace(self, values=tuple(dict.fromkeys(round(value) for value in self.values)), whole=True)

    def at(self, fraction: float) -> float:
        """The value at a fraction of the way from ``low`` to ``high``, to ten digits.

        Every whole number of a ``whole`` axis has the fractions of half a step to either side of it, the ends as well.
        """
        beyond = 0.5 if self.whole else 0.0
        low, high = self.low - beyond, self.high + beyond
        value = low * (high / low) ** fraction if self.log else low + fraction * (high - low)
        if self.whole:
            return min(self.high, math.floor(value + 0.5))
        return float(f"{value:.10g}")


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _listed(values: str) -> list[str]:
    """Values between the commas that are outside brackets."""
    parts, depth = [""], 0
    for character in values:
        depth += {"[": 1, "]": -1}.get(character, 0)
        if character == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += character
    return [part.strip() for part in parts if part.strip()]


def _typed(text: str, value: str) -> Any:
    """A value as TOML reads it; what TOML cannot read is text."""
    try:
        return tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        if re.fullmatch(r"[\w .-]+", value.strip()):
            return value.strip()
        advice = "write numbers, words, lists in [ ], or a range as low..high[:count][:log], like 10..20:3:log"
        raise InputError(f"--set {text}", f"{value!r} is no value", advice) from None
