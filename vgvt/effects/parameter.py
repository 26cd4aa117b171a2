"""Physical parameters of an effect: unit, neutral value and plausible range, on the dataclass field itself."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter as a catalogue lists it.

    ``neutral`` is the value at which the effect vanishes (None where another
    parameter switches it off); ``low`` and ``high`` bound what is plausible for a small
    aircraft; ``source`` says who says so ('guess' where nobody does). ``scale`` is the
    natural one for a prior: 'log' for positive sizes, 'linear' for signed ones. Below ``least`` (0 for
    positive sizes that state none) it is refused: a negative mass has no model, a negative damper feeds the aircraft.
    """

    name: str
    unit: str
    neutral: float | None
    low: float
    high: float
    scale: Literal["linear", "log"]
    doc: str
    source: str
    least: float | None = None

    def at(self, share: float) -> float:
        """The value at a share of the plausible range, in its own scale."""
        if self.scale == "log":
            return math.exp((1 - share) * math.log(self.low) + share * math.log(self.high))
        return (1 - share) * self.low + share * self.high


def parameter(
    unit: str,
    low: float,
    high: float,
    doc: str,
    *,
    neutral: float | None = None,
    default: float | None = None,
    scale: Literal["linear", "log"] = "linear",
    source: str = "guess",
    least: float | None = None,
) -> Any:
    """A dataclass field that is a physical parameter; it defaults to ``default``, else to its neutral value."""
    value = default if default is not None else neutral
    if value is None:
        raise ValueError(f"the parameter {doc!r} needs neutral=… (the value at which the effect is gone) or default=…")
    if least is None and scale == "log":
        least = 0.0
    about = {"unit": unit, "low": low, "high": high, "doc": doc, "neutral": neutral, "scale": scale}
    return dataclasses.field(default=float(value), metadata=about | {"source": source, "least": least})


def require_above_zero(effect: object, *names: str) -> None:
    """For a constructor: ValueError where one of these parameters is not above 0, as what is divided by must be.

    ``least`` alone would take 0 itself. A fit never gets there: of a positive size it varies the logarithm.
    """
    for name in names:
        if not getattr(effect, name) > 0:
            raise ValueError(f"{name} must be above 0")


def range_fault(p: Parameter) -> str:
    """What keeps a parameter from being fitted, in words; empty where nothing does."""
    # Somebody else's class: nothing keeps it to the types that are asked for.
    numbers: list[tuple[str, object]] = [("low", p.low), ("high", p.high)]
    numbers += [(what, v) for what, v in (("neutral", p.neutral), ("least", p.least)) if v is not None]
    for what, value in numbers:
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            return f"{what} = {value!r} is no finite number"
    unit: object = p.unit
    if not isinstance(unit, str):
        return f"the unit is {unit!r}: write a text, '' for a fraction"
    if p.scale not in ("linear", "log"):
        return f"scale = {p.scale!r}: write 'linear' or 'log'"
    if not p.low < p.high:
        return f"{p.low:g} to {p.high:g} is no range: low comes first"
    if p.scale == "log" and p.low <= 0:
        return f"a logarithmic scale cannot begin at {p.low:g}: write a positive low, or scale='linear'"
    if p.neutral is not None and p.least is not None and p.neutral < p.least:
        return f"neutral = {p.neutral:g} is below least = {p.least:g}"
    return ""


@cache
def parameters_of(effect: type) -> tuple[Parameter, ...]:
    """The parameters of an effect class, in the order of its fields; other fields are settings without a prior."""
    fields = [f for f in dataclasses.fields(effect) if "unit" in f.metadata]
    return tuple(Parameter(name=f.name, **f.metadata) for f in fields)
