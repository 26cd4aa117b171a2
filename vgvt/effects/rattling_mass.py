"""Something rattles: a battery in its tray, a control rod in its guide, a screw in a closed wing."""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import RattlingMass as Rattler
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario
from vgvt.scenario.planform import part_at, surface_height_m


@dataclasses.dataclass(frozen=True, slots=True)
class RattlingMass:
    """A mass lies loose on an elastic stop, with another one a gap above it; it jumps where its seat falls faster.

    The damper between mass and airframe acts in the gap too, like a guide that rubs. The truth is linear about rest:
    the mass on its lower stop. Out on one wing it also tips the hung aircraft, as an added mass does.
    """

    name: ClassVar[str] = "rattling-mass"
    summary: ClassVar[str] = "A loose part lies on its seat and rattles where the airframe falls away from it"
    family: ClassVar[Family] = Family.NONLINEAR
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = (
        "bursts of high frequency while the place moves by more than 1 g, low coherence there; silent at low level"
    )
    confused_with: ClassVar[tuple[str, ...]] = (
        "added-mass",
        "local-absorber",
        "clipping-range",
        "root-freeplay",
    )
    separating_test: ClassVar[str] = "listen; halve the level: below 1 g at the place the bursts stop altogether"
    reference: ClassVar[str] = (
        "Holmes, The dynamics of repeated impacts with a sinusoidally vibrating table, J. Sound Vib. 84, 1982"
    )

    mass_kg: float = parameter("kg", 0.005, 0.1, "mass that is loose", neutral=0.0, scale="log", least=0.0)
    gap_m: float = parameter("m", 1e-4, 5e-3, "free way between the stops", default=1e-3, scale="log")
    contact_hz: float = parameter(
        "Hz", 30.0, 140.0, "frequency of the mass on its stop, whose stiffness follows", default=100.0, scale="log"
    )
    damping_ratio: float = parameter(
        "", 0.01, 0.3, "damping ratio of the mass on its stop", default=0.1, scale="log", least=0.0
    )
    x_m: float = parameter("m", 0.0, 1.2, "where it lies, aft of the nose", default=0.9)
    y_m: float = parameter("m", -1.5, 1.5, "where it lies, to the right", default=1.2)

    def __post_init__(self) -> None:
        """ValueError for a seat so hard that the weight hardly presses it in."""
        # The linear truth is a difference over 20 µm: it must not reach the point where the mass lifts off.
        if not 0 < self.contact_hz <= 150.0:
            raise ValueError("contact_hz must be above 0 and at most 150")
        if not self.gap_m > 0:
            raise ValueError("gap_m must be above 0")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Put the mass on its stop, in every run."""
        del run
        if self.mass_kg == 0:
            return NOTHING
        part = part_at(scenario.airframe, (self.x_m, self.y_m))
        place = (self.x_m, self.y_m, surface_height_m(scenario.airframe, part, self.x_m, self.y_m))
        omega = 2 * math.pi * self.contact_hz
        stiffness, damper = self.mass_kg * omega**2, 2 * self.damping_ratio * self.mass_kg * omega
        return Action(elements=(Rattler(part, place, self.mass_kg, self.gap_m, stiffness, damper),))
