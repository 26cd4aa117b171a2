"""Mains hum: the power line's frequency and its harmonics on the converter's inputs."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.action import NOTHING, Action, ChannelTransform
from vgvt.effects.parameter import parameter, require_above_zero
from vgvt.effects.protocol import Family
from vgvt.effects.sensor_choice import CHANNELS, chosen_channels
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class MainsHum:
    """Sines at the line frequency and twice and three times it, in volts, of a phase of its own on every channel.

    It is there without any drive: twice the drive does not give twice the record.
    """

    name: ClassVar[str] = "mains-hum"
    summary: ClassVar[str] = "The power line couples into the cables"
    family: ClassVar[Family] = Family.ACQUISITION
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = "lines fixed at 50 or 60 Hz and multiples, there before the sweep and after it"
    confused_with: ClassVar[tuple[str, ...]] = ("local-absorber",)
    separating_test: ClassVar[str] = "record with the amplifier off; power the conditioner from a battery"
    reference: ClassVar[str] = "Morrison, Grounding and Shielding, 6th ed.; EN 50160 (line frequency: 50 Hz within 1 %)"

    amplitude_v: float = parameter("V", 1e-4, 1e-2, "amplitude of the fundamental", neutral=0.0, scale="log")
    frequency_hz: float = parameter(
        "Hz",
        49.5,
        60.6,
        "line frequency: within 1 % of 50 or of 60 Hz, and nothing between them",
        default=50.0,
        source="EN 50160 of 50 Hz; of 60 Hz a guess",
    )
    second: float = parameter("", 0.0, 0.5, "second harmonic per fundamental", default=0.1)
    third: float = parameter("", 0.0, 1.0, "third harmonic per fundamental", default=0.3)
    channels: str = dataclasses.field(default="all", metadata={"doc": f"'all', 'drive', {CHANNELS}"})

    def __post_init__(self) -> None:
        """ValueError for a line that does not alternate."""
        require_above_zero(self, "frequency_hz")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the hum at the converter, in every run."""
        if self.amplitude_v == 0:
            return NOTHING
        where = chosen_channels(scenario, run, self.channels, self.name)
        return Action(channels=tuple(ChannelTransform(c, self._hum, "converter") for c in where))

    def _hum(
        self, samples: NDArray[np.float64], sample_rate_hz: float, generator: np.random.Generator
    ) -> NDArray[np.float64]:
        time_s = np.arange(samples.size) / sample_rate_hz
        out = samples.copy()
        for order, level in ((1, 1.0), (2, self.second), (3, self.third)):
            phase = generator.uniform(0.0, 2 * np.pi)
            # The converter's own filter keeps what lies above half the rate out.
            if order * self.frequency_hz < sample_rate_hz / 2:
                out += self.amplitude_v * level * np.sin(2 * np.pi * order * self.frequency_hz * time_s + phase)
        return out
