"""A delay of some channels against the others: a multiplexing converter, a filter of another make."""

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
class ChannelDelay:
    """At t a channel shows what was at t - tau: G(f) of a response is multiplied by exp(-i 2 pi f tau).

    A converter that takes the responses after the force does the opposite, it shows them early: then it is the force
    that is late, channels = "force".
    """

    name: ClassVar[str] = "channel-delay"
    summary: ClassVar[str] = "Response channels arrive later than the force"
    family: ClassVar[Family] = Family.ACQUISITION
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "a phase linear in frequency, the same on all delayed channels; magnitudes untouched"
    confused_with: ClassVar[tuple[str, ...]] = ("high-pass-mismatch",)
    separating_test: ClassVar[str] = "feed one signal into a delayed and a prompt channel at the same time"
    reference: ClassVar[str] = "Bendat and Piersol, Random Data, 4th ed., chapter 5 (time delay and phase)"

    delay_s: float = parameter(
        "s", 1e-6, 2e-3, "delay of the response channels against the force", neutral=0.0, scale="log"
    )
    channels: str = dataclasses.field(default="response", metadata={"doc": CHANNELS})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Delay the chosen channels in every run."""
        if self.delay_s == 0:
            return NOTHING
        where = chosen_channels(scenario, run, self.channels, self.name)
        return Action(channels=tuple(ChannelFilter(c, self._response) for c in where))

    def _response(self, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
        return np.asarray(np.exp(-2j * np.pi * frequency_hz * self.delay_s))
