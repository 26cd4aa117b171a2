"""An analogue anti-alias filter on some channels only: it delays, and rounds off what is near its corner."""

from __future__ import annotations

import dataclasses
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.action import NOTHING, Action, ChannelFilter
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.sensor_choice import CHANNELS, chosen_channels
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class AntiAliasDelay:
    """A Butterworth low-pass of order n; at low frequency it is a delay of 1/(ω_c sin(π/2n)), which names it here.

    It stands before the converter: the sensor's own noise passes it like the signal, that of the converter does not.
    """

    name: ClassVar[str] = "anti-alias-delay"
    summary: ClassVar[str] = "Responses pass an anti-alias filter that the force does not"
    family: ClassVar[Family] = Family.ACQUISITION
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "a phase nearly linear in frequency, steepening and with loss of magnitude at the corner"
    confused_with: ClassVar[tuple[str, ...]] = ("channel-delay", "clock-skew")
    separating_test: ClassVar[str] = (
        "white noise into a filtered and an unfiltered channel, up to half the sampling rate"
    )
    reference: ClassVar[str] = (
        "Oppenheim and Schafer, Discrete-Time Signal Processing, 3rd ed., appendix B (Butterworth)"
    )

    delay_s: float = parameter(
        "s",
        1e-4,
        5e-3,
        "delay of the filter at low frequency",
        neutral=0.0,
        scale="log",
        source="corners 100 Hz to 4 kHz",
    )
    order: Literal[2, 4, 6, 8] = dataclasses.field(default=4, metadata={"doc": "order of the filter"})
    channels: str = dataclasses.field(default="response", metadata={"doc": CHANNELS})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Filter the chosen channels, in every run."""
        if self.delay_s == 0:
            return NOTHING
        where = chosen_channels(scenario, run, self.channels, self.name)
        return Action(channels=tuple(ChannelFilter(c, self._response, "conditioner") for c in where))

    @property
    def corner_hz(self) -> float:
        """Where the filter passes half of the power."""
        return float(1 / (2 * np.pi * self.delay_s * np.sin(np.pi / (2 * self.order))))

    def _response(self, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
        poles = np.exp(1j * np.pi * (2 * np.arange(1, self.order + 1) + self.order - 1) / (2 * self.order))
        s = 1j * frequency_hz / self.corner_hz
        return np.asarray(np.prod([1 / (1 - s / pole) for pole in poles], axis=0))
