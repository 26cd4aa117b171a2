"""A small mass on a spring somewhere on the airframe: loose payload, battery, servo, cable bundle."""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import Absorber
from vgvt.effects.parameter import parameter, require_above_zero
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario
from vgvt.scenario.planform import part_at, surface_height_m


@dataclasses.dataclass(frozen=True, slots=True)
class LocalAbsorber:
    """A mass that slides up and down on a spring and dashpot at one point of the airframe.

    Out on one wing it also tips the hung aircraft: by atan(m y / M h) where it hangs by h above its centre of gravity.
    """

    name: ClassVar[str] = "local-absorber"
    summary: ClassVar[str] = "A loose mass resonates somewhere on the airframe"
    family: ClassVar[Family] = Family.AIRFRAME
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "a pole-zero pair near its own frequency in all channels; below it only added mass"
    confused_with: ClassVar[tuple[str, ...]] = ("suspension-surge", "loose-sensor-mount", "added-mass")
    separating_test: ClassVar[str] = "take the payload out or tape it down and repeat one run"
    reference: ClassVar[str] = "Den Hartog, Mechanical Vibrations, 4th ed., chapter 3 (dynamic vibration absorber)"

    mass_kg: float = parameter("kg", 0.02, 0.3, "mass that is loose", neutral=0.0, scale="log", least=0.0)
    frequency_hz: float = parameter(
        "Hz", 3.0, 40.0, "its frequency on a fixed airframe", default=12.0, scale="log", least=0.0
    )
    damping_ratio: float = parameter(
        "", 0.003, 0.1, "its damping ratio on a fixed airframe", default=0.02, scale="log", least=0.0
    )
    x_m: float = parameter("m", 0.0, 1.2, "where it sits, aft of the nose", default=0.45)
    y_m: float = parameter("m", -1.5, 1.5, "where it sits, to the right", default=0.0)

    def __post_init__(self) -> None:
        """ValueError for a mass that nothing holds."""
        require_above_zero(self, "frequency_hz")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the absorber to the airframe, in every run."""
        del run
        if self.mass_kg == 0:
            return NOTHING
        part = part_at(scenario.airframe, (self.x_m, self.y_m))
        height = surface_height_m(scenario.airframe, part, self.x_m, self.y_m)
        omega = 2 * math.pi * self.frequency_hz
        spring, damper = self.mass_kg * omega**2, 2 * self.damping_ratio * self.mass_kg * omega
        absorber = Absorber(part, (self.x_m, self.y_m, height), self.mass_kg, spring, damper)
        return Action(elements=(absorber,))
