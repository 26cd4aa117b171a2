"""Samples get lost on the way to the disk: repeated by the driver, or closed up without a trace."""

from __future__ import annotations

import dataclasses
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.action import NOTHING, Action, ChannelTransform
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.sensor_choice import CHANNELS, chosen_channels
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class DroppedSamples:
    """Now and then the device loses a few samples, at the same instants on all of its channels.

    They are lost behind the converter: 'repeated' writes the sample before them once more, equal to the last bit;
    'closed-up' writes nothing, so that all that follows comes early, and the last sample fills up the record's end.
    Every such effect of a scenario is a device of its own, which loses its own samples.
    """

    name: ClassVar[str] = "dropped-samples"
    summary: ClassVar[str] = "The device of some channels loses samples"
    family: ClassVar[Family] = Family.ACQUISITION
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "repeated: a white floor in the responses; closed up: a phase lead that grows in steps"
    confused_with: ClassVar[tuple[str, ...]] = ("clock-skew", "channel-delay", "quantisation")
    separating_test: ClassVar[str] = "record one signal on both devices and compare start and end of the record"
    reference: ClassVar[str] = "Bendat and Piersol, Random Data, 4th ed. (data qualification)"

    losses: float = parameter(
        "", 1.0, 100.0, "how often in a record, rounded to a whole number", neutral=0.0, scale="log"
    )
    samples_lost: float = parameter(
        "", 1.0, 100.0, "samples lost each time, rounded to a whole number", default=1.0, scale="log"
    )
    kind: Literal["repeated", "closed-up"] = dataclasses.field(
        default="repeated", metadata={"doc": "what is written in their place"}
    )
    channels: str = dataclasses.field(default="response", metadata={"doc": f"'all', {CHANNELS}"})

    def __post_init__(self) -> None:
        """ValueError for fewer than none."""
        if self.losses < 0 or self.samples_lost < 1:
            raise ValueError("losses cannot be negative, and samples_lost must be at least 1")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Lose samples, other ones in every run."""
        if round(self.losses) == 0:
            return NOTHING
        where = chosen_channels(scenario, run, self.channels, self.name)
        return Action(channels=tuple(ChannelTransform(c, self._written, "record", together=True) for c in where))

    def _written(
        self, samples: NDArray[np.float64], sample_rate_hz: float, generator: np.random.Generator
    ) -> NDArray[np.float64]:
        del sample_rate_hz
        lost = self._lost(generator, samples.size)
        if self.kind == "repeated":
            return samples[np.maximum.accumulate(np.where(lost, 0, np.arange(samples.size)))]
        return np.concatenate([samples[~lost], np.full(int(lost.sum()), samples[-1])])

    def _lost(self, generator: np.random.Generator, size: int) -> NDArray[np.bool_]:
        """Which samples of a record are lost; never the first."""
        lost = np.zeros(size, dtype=bool)
        for start in generator.integers(1, size, round(self.losses)):
            lost[start : start + round(self.samples_lost)] = True
        return lost
