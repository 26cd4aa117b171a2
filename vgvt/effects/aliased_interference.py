"""Aliasing: a converter without an anti-alias filter folds what lies far above its rate into the band."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.action import NOTHING, Action, ChannelTransform
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.sensor_choice import CHANNELS, chosen_channels
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class AliasedInterference:
    """A sine of frequency f on the converter's input, sampled as it is: it appears at |f - n fs| with n = round(f/fs).

    It is there without any drive: twice the drive does not give twice the record.
    """

    name: ClassVar[str] = "aliased-interference"
    summary: ClassVar[str] = "A converter without anti-alias filter folds interference into the band"
    family: ClassVar[Family] = Family.ACQUISITION
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = (
        "a line that does not follow the sweep, at no multiple of the mains, and that moves when the sample rate does"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("mains-hum", "local-absorber")
    separating_test: ClassVar[str] = "change the sample rate by a few per cent: the line moves, a mode does not"
    reference: ClassVar[str] = (
        "Shannon, Communication in the presence of noise, Proc. IRE 37, 1949 (the sampling theorem)"
    )

    amplitude_v: float = parameter(
        "V",
        1e-4,
        1e-1,
        "amplitude at the converter",
        neutral=0.0,
        scale="log",
        source="guess: a switching supply nearby",
    )
    frequency_hz: float = parameter(
        "Hz",
        2e4,
        2e5,
        "frequency of the interference",
        default=100037.0,
        scale="log",
        source="switching supplies run at 20 to 200 kHz",
        least=0.0,
    )
    channels: str = dataclasses.field(default="response", metadata={"doc": f"'all', 'drive', {CHANNELS}"})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the sine at the converter, in every run."""
        if self.amplitude_v == 0:
            return NOTHING
        where = chosen_channels(scenario, run, self.channels, self.name)
        return Action(channels=tuple(ChannelTransform(c, self._folded, "converter") for c in where))

    def _folded(
        self, samples: NDArray[np.float64], sample_rate_hz: float, generator: np.random.Generator
    ) -> NDArray[np.float64]:
        # Sampled at n/fs the sine is that of the remainder, which keeps the phase of a long record exact.
        remainder = self.frequency_hz - round(self.frequency_hz / sample_rate_hz) * sample_rate_hz
        phase = 2 * np.pi * remainder * np.arange(samples.size) / sample_rate_hz + generator.uniform(0.0, 2 * np.pi)
        return np.asarray(samples + self.amplitude_v * np.sin(phase))
