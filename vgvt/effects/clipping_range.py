"""The converter's range is smaller than stated, and peaks are cut off."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class ClippingRange:
    """Volts beyond plus or minus the range are recorded as the range; channels that reach it are flagged."""

    name: ClassVar[str] = "clipping-range"
    summary: ClassVar[str] = "The converter's range is too small and cuts the peaks off"
    family: ClassVar[Family] = Family.ACQUISITION
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = "flat tops at resonance, odd harmonics while they last, the overload flag"
    confused_with: ClassVar[tuple[str, ...]] = ("quantisation",)
    separating_test: ClassVar[str] = "histogram of the samples; shake at half the level"
    reference: ClassVar[str] = "Bendat and Piersol, Random Data, 4th ed. (data qualification)"

    range_divisor: float = parameter(
        "", 2.0, 1e4, "how many times smaller the range is", neutral=1.0, scale="log", source="gains of 10^n"
    )

    def __post_init__(self) -> None:
        """ValueError for a range that grows, or is none."""
        if self.range_divisor < 1:
            raise ValueError("range_divisor must be at least 1")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Narrow the range of every channel, in every run; the steps shrink with it, as on a real converter."""
        del run
        if self.range_divisor == 1:
            return NOTHING
        range_v = scenario.acquisition.range_v / self.range_divisor
        acquisition = scenario.acquisition.model_copy(update={"range_v": range_v})
        return Action(scenario=scenario.model_copy(update={"acquisition": acquisition}))
