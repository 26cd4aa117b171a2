"""A gain that drifts while the campaign goes on: a warming conditioner, a decaying battery supply."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.action import NOTHING, Action, ChannelFilter
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.run_schedule import Shape, check_schedule, progress
from vgvt.effects.sensor_choice import CHANNELS, chosen_channels
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class GainDrift:
    """Some channels are multiplied by 1 + drift · s(run), with s from 0 in the first run to 1 in the last.

    It is the conditioner's gain: the sensor's own noise drifts with the signal, the converter's noise stays.
    """

    name: ClassVar[str] = "gain-drift"
    summary: ClassVar[str] = "The gain of some channels drifts from run to run"
    family: ClassVar[Family] = Family.BETWEEN_RUNS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "residues of later runs are off by one factor in all modes; poles stay"
    confused_with: ClassVar[tuple[str, ...]] = ("run-drift", "channel-gain")
    separating_test: ClassVar[str] = "keep one accelerometer at the drive point in every run"
    reference: ClassVar[str] = "Ewins, Modal Testing, 2nd ed., chapter 3 (calibration before and after the test)"

    drift: float = parameter("", -0.1, 0.1, "relative change of the gain at the end", neutral=0.0)
    channels: str = dataclasses.field(default="response", metadata={"doc": CHANNELS})
    shape: Shape = dataclasses.field(default="linear", metadata={"doc": "'linear', 'exponential' or 'step'"})
    time_constant_runs: float = dataclasses.field(default=3.0, metadata={"doc": "of the exponential, in runs"})
    from_run: int = dataclasses.field(default=2, metadata={"doc": "first run after the step, counted from 1"})

    def __post_init__(self) -> None:
        check_schedule(self.time_constant_runs, self.from_run)

    def act(self, scenario: Scenario, run: int) -> Action:
        """Scale the channels as far as the drift has come in this run."""
        runs = len(scenario.acquisition.run_nodes)
        done = progress(self.shape, run, runs, self.time_constant_runs, self.from_run)
        gain = 1 + self.drift * done

        def response(frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
            return np.full(frequency_hz.shape, gain, dtype=complex)

        if gain == 1:
            return NOTHING
        where = chosen_channels(scenario, run, self.channels, self.name)
        return Action(channels=tuple(ChannelFilter(c, response, "conditioner") for c in where))
