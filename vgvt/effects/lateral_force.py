"""The shaker stands askew: part of its push is sideways."""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

from vgvt.data import Direction
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.point_error import PointError, turned
from vgvt.effects.protocol import Family
from vgvt.effects.shakers import chosen_shakers, shaker_choice
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class LateralForce:
    """Shaker, stinger and gauge are in line with each other, but lean from the normal of the surface.

    The push is F (cos α, sin α towards the azimuth); the gauge reads F. The truth's
    drive DOF is the motion along the push.
    """

    name: ClassVar[str] = "lateral-force"
    summary: ClassVar[str] = "The stinger leans, so that part of the force is sideways"
    family: ClassVar[Family] = Family.DRIVE_PATH
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "sway, yaw and in-plane modes appear; vertical residues shrink by the cosine; poles stay"
    confused_with: ClassVar[tuple[str, ...]] = ("transverse-sensitivity", "sensor-tilt", "hook-offset")
    separating_test: ClassVar[str] = "turn the shaker by 90 degrees about the vertical, or plumb the stinger"
    reference: ClassVar[str] = "Ewins, Modal Testing, 2nd ed., chapter 3 (alignment of drive rods)"

    angle_rad: float = parameter("rad", 0.0175, 0.087, "lean from the normal of the surface", neutral=0.0, scale="log")
    azimuth_rad: float = parameter(
        "rad", -math.pi, math.pi, "where it leans to: 0 aft, pi/2 to the right", default=math.pi / 2
    )
    shaker: int = shaker_choice()

    def act(self, scenario: Scenario, run: int) -> Action:
        """Turn the push, in every run."""
        del run
        if self.angle_rad == 0:
            return NOTHING
        lean = turned(Direction.PLUS_Z, self.angle_rad, self.azimuth_rad)
        chosen = chosen_shakers(scenario, self.shaker, self.name)
        return Action(points=tuple(PointError(scenario.shakers[k].node, lean=lean) for k in chosen))
