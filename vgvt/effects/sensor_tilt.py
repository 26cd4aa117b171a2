"""Accelerometers that lean: they also measure in-plane motion, and the surface's tilting in gravity."""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

from vgvt.data import Direction
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import Vector
from vgvt.effects.parameter import parameter
from vgvt.effects.point_error import PointError, turned
from vgvt.effects.protocol import Family
from vgvt.effects.sensor_choice import CHOICES, chosen_sensors
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class SensorTilt:
    """The sensing axis leans by an angle; where the surface turns by θ, it feels g sin(angle) θ on top."""

    name: ClassVar[str] = "sensor-tilt"
    summary: ClassVar[str] = "Accelerometers lean away from the direction that they should measure"
    family: ClassVar[Family] = Family.SENSORS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "grows as 1/f² against the rotation at low frequency, where gravity counts; pole free"
    confused_with: ClassVar[tuple[str, ...]] = ("transverse-sensitivity", "high-pass-mismatch", "lateral-force")
    separating_test: ClassVar[str] = "turn the sensor by 180 degrees about the vertical; put it on a tilt table"
    reference: ClassVar[str] = "ISO 5348, Mechanical mounting of accelerometers; g theta by statics"

    angle_rad: float = parameter("rad", 0.005, 0.087, "how far the axis leans", neutral=0.0, scale="log")
    azimuth_rad: float = parameter(
        "rad", -math.pi, math.pi, "where it leans to; for one that measures up: 0 aft, pi/2 to the right", default=0.0
    )
    sensors: str = dataclasses.field(default="response", metadata={"doc": CHOICES})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Turn the axes of the chosen sensors of the run."""
        if self.angle_rad == 0:
            return NOTHING
        where = chosen_sensors(scenario, run, self.sensors, self.name)
        return Action(points=tuple(PointError(p.dof.node, lean=self._lean(p.dof.direction)) for p in where))

    def _lean(self, direction: Direction) -> Vector:
        return turned(direction, self.angle_rad, self.azimuth_rad)
