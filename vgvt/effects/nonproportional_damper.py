"""A dashpot at one place: damping that the modes do not share evenly, so that their shapes turn complex."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import GroundSpring
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario
from vgvt.scenario.planform import part_at, surface_height_m


@dataclasses.dataclass(frozen=True, slots=True)
class NonproportionalDamper:
    """A dashpot c against the ground adds c φ²/(2 m_r ω) to each damping ratio and couples modes by c φ_r φ_s."""

    name: ClassVar[str] = "nonproportional-damper"
    summary: ClassVar[str] = "Something rubs or drags at one place of the airframe"
    family: ClassVar[Family] = Family.AIRFRAME
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "damping grows as the square of the shape there; the phase scatters along complex shapes"
    confused_with: ClassVar[tuple[str, ...]] = ("suspension-damping", "entrained-air", "channel-delay")
    separating_test: ClassVar[str] = (
        "phase resonance with two shakers: shapes stay complex; a delay turns every mode alike"
    )
    reference: ClassVar[str] = (
        "Caughey and O'Kelly, Classical normal modes in damped linear dynamic systems, J. Appl. Mech. 32, 1965"
    )

    damping_n_s_per_m: float = parameter("N s/m", 0.01, 5.0, "dashpot", neutral=0.0, scale="log")
    x_m: float = parameter("m", 0.0, 1.2, "where it acts, aft of the nose", default=0.9)
    y_m: float = parameter("m", -1.5, 1.5, "where it acts, to the right", default=1.2)

    def __post_init__(self) -> None:
        """ValueError for a dashpot that feeds energy in."""
        if self.damping_n_s_per_m < 0:
            raise ValueError("damping_n_s_per_m cannot be negative")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the dashpot, in every run."""
        del run
        if self.damping_n_s_per_m == 0:
            return NOTHING
        part = part_at(scenario.airframe, (self.x_m, self.y_m))
        place = (self.x_m, self.y_m, surface_height_m(scenario.airframe, part, self.x_m, self.y_m))
        return Action(elements=(GroundSpring(part, place, 0.0, self.damping_n_s_per_m, owner="airframe"),))
