"""AC coupling that differs between force and response: discharge time constants of sensors and conditioners."""

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
class HighPassMismatch:
    """Some channels pass another first-order high-pass: G(f) is multiplied by i f / (f_c + i f), f_c = 1/(2π DTC).

    It is behind the stated coupling of the sensor, whose own noise passes it, too.
    """

    name: ClassVar[str] = "high-pass-mismatch"
    summary: ClassVar[str] = "Some channels are AC coupled more than stated"
    family: ClassVar[Family] = Family.SENSORS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "a phase lead of about f_c/f and a droop at the lowest frequencies only"
    confused_with: ClassVar[tuple[str, ...]] = ("channel-delay", "sensor-tilt", "pendulum-length")
    separating_test: ClassVar[str] = "the sensor's answer to a step; one signal into both channels below 1 Hz"
    reference: ClassVar[str] = (
        "makers' data sheets (discharge time constant, f_c = 1/(2 pi DTC)); Ewins, Modal Testing, 2nd ed., chapter 3"
    )

    corner_hz: float = parameter(
        "Hz",
        0.005,
        3.0,
        "corner f_c of the extra high-pass",
        neutral=0.0,
        scale="log",
        source="PCB 353B16: discharge 0.5-2 s, 0.08-0.3 Hz; PCB 208C01 at least 50 s; conditioner 480E09 about 0.15 Hz",
    )
    channels: str = dataclasses.field(default="response", metadata={"doc": CHANNELS})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Filter the chosen channels of the run."""
        if self.corner_hz == 0:
            return NOTHING
        where = chosen_channels(scenario, run, self.channels, self.name)
        return Action(channels=tuple(ChannelFilter(c, self._response, "conditioner") for c in where))

    def _response(self, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
        return np.asarray(1j * frequency_hz / (self.corner_hz + 1j * frequency_hz))
