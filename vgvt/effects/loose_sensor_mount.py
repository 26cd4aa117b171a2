"""An accelerometer on too much wax, or half off: it rides on a spring of its own."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.action import NOTHING, Action, ChannelFilter
from vgvt.effects.parameter import parameter, require_above_zero
from vgvt.effects.protocol import Family
from vgvt.effects.sensor_choice import chosen_node
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class LooseSensorMount:
    """One sensor reads the base motion times (1 + 2 i ζ r) / (1 - r² + 2 i ζ r), r = f T.

    T = 1/f0 is the sensor's period on its mount; the sensor's mass is too small to act back on the aircraft.
    """

    name: ClassVar[str] = "loose-sensor-mount"
    summary: ClassVar[str] = "One accelerometer is not firmly mounted and resonates on its wax"
    family: ClassVar[Family] = Family.SENSORS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "one sensor only reads too much, and the more the higher the frequency"
    confused_with: ClassVar[tuple[str, ...]] = ("local-absorber", "channel-gain")
    separating_test: ClassVar[str] = "mount the sensor again and repeat that run"
    reference: ClassVar[str] = (
        "ISO 5348, Mechanical mounting of accelerometers; Den Hartog, Mechanical Vibrations, chapter 2 (base motion)"
    )

    period_s: float = parameter(
        "s", 0.002, 0.033, "period of the sensor on its mount, one over its frequency", neutral=0.0, scale="log"
    )
    damping_ratio: float = parameter("", 0.02, 0.2, "damping ratio on its mount", default=0.05, scale="log")
    node: int = dataclasses.field(default=0, metadata={"doc": "node of the loose sensor; 0 for the first channel's"})

    def __post_init__(self) -> None:
        """ValueError for a sensor that rings without end."""
        require_above_zero(self, "damping_ratio")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Let the one sensor resonate in the runs that use it."""
        if self.period_s == 0:
            return NOTHING
        point = chosen_node(scenario, self.node, self.name)
        if point.dof.node not in scenario.acquisition.run_nodes[run]:
            return NOTHING
        return Action(channels=(ChannelFilter(str(point.dof), self._response),))

    def _response(self, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
        ratio = frequency_hz * self.period_s
        damper = 2j * self.damping_ratio * ratio
        return np.asarray((1 + damper) / (1 - ratio**2 + damper))
