"""Two devices, two clocks: the responses are sampled at another rate than the force."""

from __future__ import annotations

import dataclasses
from functools import partial
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.action import NOTHING, Action, ChannelTransform
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.sensor_choice import CHANNELS, chosen_channels
from vgvt.scenario.model import Scenario
from vgvt.signals.resampling import between_samples


@dataclasses.dataclass(frozen=True, slots=True)
class ClockSkew:
    """Sample n of a skewed channel was taken at n (1 + ε)/fs, so that for ε > 0 it shows what comes later.

    That is a lead ε t, which grows with time, and in a sweep with f; for ε < 0 it is a delay. Both count from the
    record's beginning, where the clocks agree. What comes in at the converter (hum, interference) is sampled by that
    clock, too. Between samples the signal is what its band makes it, to 1e-4 up to 0.45 of the rate; within 32 samples
    of the record's last one, and of rest, that is a guess, and past it its last value.
    """

    name: ClassVar[str] = "clock-skew"
    summary: ClassVar[str] = "Responses and force are sampled by clocks that run at different rates"
    family: ClassVar[Family] = Family.ACQUISITION
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "a phase that grows through the record: as the square of frequency in a linear sweep"
    confused_with: ClassVar[tuple[str, ...]] = ("channel-delay", "dropped-samples", "anti-alias-delay")
    separating_test: ClassVar[str] = (
        "one signal on both devices, compared at the start and at the end; a reversed sweep"
    )
    reference: ClassVar[str] = (
        "Oppenheim and Schafer, Discrete-Time Signal Processing, 3rd ed., section 4.6 (resampling)"
    )

    skew: float = parameter(
        "", -1e-3, 1e-3, "fraction by which the clock is slow", neutral=0.0, source="crystals: 1e-6 to 1e-4"
    )
    channels: str = dataclasses.field(default="response", metadata={"doc": CHANNELS})

    def __post_init__(self) -> None:
        """ValueError for a clock that is no clock."""
        if abs(self.skew) >= 0.1:
            raise ValueError("skew is a fraction: 1e-4 is 100 parts per million")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Resample the chosen channels, in every run."""
        if self.skew == 0:
            return NOTHING
        where = chosen_channels(scenario, run, self.channels, self.name)
        resampled = partial(self._resampled, scenario.unrecorded_samples)
        return Action(channels=tuple(ChannelTransform(c, resampled, pace=1 + self.skew) for c in where))

    def _resampled(
        self, begin: int, samples: NDArray[np.float64], sample_rate_hz: float, generator: np.random.Generator
    ) -> NDArray[np.float64]:
        """The samples (N,) from rest on, of which the record begins at sample ``begin``."""
        del sample_rate_hz, generator
        after = np.arange(samples.size, dtype=np.float64) - begin
        # After its last instant the true signal is not known: the record comes to rest there.
        return between_samples(samples, np.clip(begin + after * (1 + self.skew), 0.0, samples.size - 1.0))
