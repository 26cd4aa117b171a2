"""Samples get lost on the way to the disk: repeated by the driver, or closed up without a trace."""

from __future__ import annotations

import dataclasses
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.action import NOTHING, Action, ChannelTransform
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario
from vgvt.scenario.streams import named_stream


@dataclasses.dataclass(frozen=True, slots=True)
class DroppedSamples:
    """Each sample is lost with a small chance, at the same instants on all channels of the device.

    'repeated' writes the sample before it once more; 'closed-up' writes nothing, so that all that
    follows comes a sample early.
    """

    name: ClassVar[str] = "dropped-samples"
    summary: ClassVar[str] = "The device of some channels loses samples"
    family: ClassVar[Family] = Family.ACQUISITION
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "repeated: a white floor in the responses; closed up: a phase lead that grows in steps"
    confused_with: ClassVar[tuple[str, ...]] = ("clock-skew", "channel-delay", "quantisation")
    separating_test: ClassVar[str] = "record one signal on both devices and compare start and end of the record"
    reference: ClassVar[str] = "Bendat and Piersol, Random Data, 4th ed., section 10.3 (data qualification)"

    fraction: float = parameter("", 1e-6, 1e-2, "share of the samples that is lost", neutral=0.0, scale="log")
    kind: Literal["repeated", "closed-up"] = dataclasses.field(
        default="repeated", metadata={"doc": "what is written in their place"}
    )
    channels: str = dataclasses.field(
        default="response", metadata={"doc": "'response', 'force', 'all' or a DOF like 12+Z"}
    )

    def __post_init__(self) -> None:
        """ValueError for a share that is none."""
        if not 0 <= self.fraction < 1:
            raise ValueError("fraction must be at least 0 and below 1")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Lose samples, other ones in every run."""
        if self.fraction == 0:
            return NOTHING
        seed = scenario.seed

        def change(
            samples: NDArray[np.float64], sample_rate_hz: float, generator: np.random.Generator
        ) -> NDArray[np.float64]:
            del sample_rate_hz, generator
            # A stream of the device, not of the channel: all its channels lose the same samples.
            lost = named_stream(seed, self.name, run).random(samples.size) < self.fraction
            lost[0] = False
            source = np.flatnonzero(~lost)
            if self.kind == "repeated":
                return samples[np.maximum.accumulate(np.where(lost, 0, np.arange(samples.size)))]
            return np.concatenate([samples[source], np.full(int(lost.sum()), samples[-1])])

        return Action(channels=(ChannelTransform(self.channels, change, "converter"),))
