"""Fewer bits than stated: a coarse converter, or a signal that uses little of its range."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario

# Of a single bit nothing but the sign is left.
_FEWEST_BITS = 2


@dataclasses.dataclass(frozen=True, slots=True)
class Quantisation:
    """Samples are rounded to steps of 2 range/2^bits: white noise of step/sqrt(12) where the signal is large."""

    name: ClassVar[str] = "quantisation"
    summary: ClassVar[str] = "The converter resolves fewer bits than stated"
    family: ClassVar[Family] = Family.ACQUISITION
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = "a flat noise floor; few distinct values, and steps where the signal is small"
    confused_with: ClassVar[tuple[str, ...]] = ("clipping-range",)
    separating_test: ClassVar[str] = "count the distinct values in a quiet stretch; shake ten times harder"
    reference: ClassVar[str] = "Widrow and Kollar, Quantization Noise, 2008, chapter 1"

    lost_bits: float = parameter(
        "bit", 0.0, 14.0, "bits below the stated ones, rounded to whole ones", neutral=0.0, source="24 down to 10 bits"
    )

    def __post_init__(self) -> None:
        """ValueError for more bits than stated."""
        if self.lost_bits < 0:
            raise ValueError("lost_bits cannot be negative: state more acquisition.bits instead")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Coarsen the steps of every channel, in every run."""
        del run
        if round(self.lost_bits) == 0:
            return NOTHING
        bits = max(_FEWEST_BITS, scenario.acquisition.bits - round(self.lost_bits))
        acquisition = scenario.acquisition.model_copy(update={"bits": bits})
        return Action(scenario=scenario.model_copy(update={"acquisition": acquisition}))
