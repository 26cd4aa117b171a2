"""Accelerometers that feel a little of the motion across their axis."""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

from vgvt.data import Direction
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import Vector
from vgvt.effects.parameter import parameter
from vgvt.effects.point_error import PointError, across
from vgvt.effects.protocol import Family
from vgvt.effects.sensor_choice import CHOICES, chosen_sensors
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class TransverseSensitivity:
    """The sensor reads its axis fully and a fraction of one direction across it, gravity included."""

    name: ClassVar[str] = "transverse-sensitivity"
    summary: ClassVar[str] = "Accelerometers read a few percent of the motion across their axis"
    family: ClassVar[Family] = Family.SENSORS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "phantom peaks of in-plane modes, and of tilting against gravity at low frequency"
    confused_with: ClassVar[tuple[str, ...]] = ("sensor-tilt", "lateral-force")
    separating_test: ClassVar[str] = "turn the sensor by 90 or 180 degrees about its own axis"
    reference: ClassVar[str] = "ISO 16063-31, Testing of transverse vibration sensitivity"

    fraction: float = parameter(
        "", 0.002, 0.05, "sensitivity across over sensitivity along", neutral=0.0, scale="log", source="PCB 353B16: 5 %"
    )
    azimuth_rad: float = parameter(
        "rad",
        -math.pi,
        math.pi,
        "direction across that it feels; for one that measures up: 0 aft, pi/2 to the right",
        default=0.0,
    )
    sensors: str = dataclasses.field(default="response", metadata={"doc": CHOICES})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the cross axis to the chosen sensors of the run."""
        if self.fraction == 0:
            return NOTHING
        where = chosen_sensors(scenario, run, self.sensors, self.name)
        return Action(
            points=tuple(PointError(p.dof.node, cross_sensitivity=self._across(p.dof.direction)) for p in where)
        )

    def _across(self, direction: Direction) -> Vector:
        x, y, z = across(direction, self.azimuth_rad)
        return (self.fraction * x, self.fraction * y, self.fraction * z)
