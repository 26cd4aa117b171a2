"""A sensitivity that is off: a sensor out of calibration, a conditioner switched to another range."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.action import NOTHING, Action, ChannelFilter
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.sensor_choice import CHANNELS, chosen_channels
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class ChannelGain:
    """Some channels read 1 + ε times what they should, at all frequencies; on the force, A/F shrinks by 1 + ε.

    That goes for the sensor's own noise, too: it is stated as what it would have to sense to read it, so it follows
    the sensor's volts per unit and the conditioner's gain, whichever is off. The converter's noise stays.
    """

    name: ClassVar[str] = "channel-gain"
    summary: ClassVar[str] = "The sensitivity of some channels is off by a constant factor"
    family: ClassVar[Family] = Family.SENSORS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "a real factor, the same at all frequencies; on the force it scales all modal masses"
    confused_with: ClassVar[tuple[str, ...]] = ("gain-drift", "drive-point-offset", "added-mass", "sensor-tilt")
    separating_test: ClassVar[str] = "shake a known mass; swap two sensors and see whether the factor follows"
    reference: ClassVar[str] = "Ewins, Modal Testing, 2nd ed., chapter 3 (calibration)"

    gain_error: float = parameter("", -0.15, 0.15, "relative error of the gain", neutral=0.0)
    channels: str = dataclasses.field(default="response", metadata={"doc": CHANNELS})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Scale the chosen channels of the run."""
        if self.gain_error == 0:
            return NOTHING
        where = chosen_channels(scenario, run, self.channels, self.name)
        return Action(channels=tuple(ChannelFilter(c, self._response, "conditioner") for c in where))

    def _response(self, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
        return np.full(frequency_hz.shape, 1.0 + self.gain_error, dtype=complex)
