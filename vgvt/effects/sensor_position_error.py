"""An accelerometer a little beside the point where the test geometry has it."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.point_error import PointError
from vgvt.effects.protocol import Family
from vgvt.effects.sensor_choice import chosen_node
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class SensorPositionError:
    """One sensor sits (dx, dy) from its node on the same part, in every run that uses it.

    Along the surface: where that stands upright, as a fin does, dy leads up it.
    Exchanged with another one (swapped-sensors) it sits so from where that was, on that one's part. Geometry
    and truth keep to the node, so that the shape's entry there is wrong by φ(x + δ) - φ(x).
    """

    name: ClassVar[str] = "sensor-position-error"
    summary: ClassVar[str] = "One accelerometer sits beside the point that the geometry gives it"
    family: ClassVar[Family] = Family.SENSORS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "one channel is off mode by mode, by the slope of each shape there; poles stay"
    confused_with: ClassVar[tuple[str, ...]] = ("channel-gain", "swapped-sensors", "sensor-tilt")
    separating_test: ClassVar[str] = "measure the sensor's place again; photograph every run"
    reference: ClassVar[str] = "Ewins, Modal Testing, 2nd ed., chapter 3; first order: delta . grad phi"

    dx_m: float = parameter("m", -0.05, 0.05, "how far aft of its node it sits", neutral=0.0)
    dy_m: float = parameter(
        "m", -0.05, 0.05, "how far to the right of its node it sits; on a fin how far above", neutral=0.0
    )
    node: int = dataclasses.field(default=0, metadata={"doc": "node of the sensor; 0 for the first channel's"})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Move the sensor along the surface."""
        del run
        if self.dx_m == 0 and self.dy_m == 0:
            return NOTHING
        point = chosen_node(scenario, self.node, self.name)
        return Action(points=(PointError(point.dof.node, shift_m=(self.dx_m, self.dy_m, 0.0), on_surface=True),))
