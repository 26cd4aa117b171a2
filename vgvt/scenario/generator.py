"""The generator: what sends the command to the amplifiers, and how much of it."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from vgvt.scenario.base import MisfitError, Positive, Table, Whole
from vgvt.scenario.instruments import Acquisition
from vgvt.scenario.rig import RANDOM_KINDS, Excitation


class Generator(Table):
    """What sends the commands of all shakers: a signal generator, or the output module of a data acquisition.

    The drive channels are recorded as it sends them.
    """

    model: str = ""
    """Make and type, in words."""
    range_v: Positive | None = None
    """Full scale of every output, plus and minus: an amplitude beyond it is refused; peaks of noise are cut off there,
    and the drive is marked as overloaded. Left out, it gives any."""
    bits: Whole | None = Field(default=None, ge=2, le=32)
    """Resolution over plus and minus range_v; left out, it has no steps."""

    @model_validator(mode="after")
    def _steps_are_of_a_range(self) -> Self:
        if self.bits is not None and self.range_v is None:
            raise MisfitError(("range_v",), "is missing, and bits divides it into steps", "Write range_v = ….")
        return self


def check_generator(generator: Generator, excitation: Excitation, acquisition: Acquisition) -> None:
    """MisfitError unless the generator gives the levels that are asked for; peaks of noise may be cut off."""
    level = acquisition.loudest
    range_v, asked_v = generator.range_v, level * excitation.amplitude_v
    if range_v is None or excitation.kind == "impact" or asked_v <= range_v:
        return
    told = f"is {excitation.amplitude_v:g}" + (f", {level:g} times that in a run" if level != 1 else "")
    what = "root mean square alone" if excitation.kind in RANDOM_KINDS else "peak"
    raise MisfitError(
        ("excitation", "amplitude_v"),
        f"{told}, but the generator gives {range_v:g} V at most, and this is the {what}",
        f"Write {range_v / level:g} at most, and a larger shaker.amplifier_gain for more force.",
    )
