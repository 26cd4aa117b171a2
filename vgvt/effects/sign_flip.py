"""An accelerometer upside down, or a plug the wrong way round: one channel has the wrong sign."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.action import NOTHING, Action, ChannelFilter
from vgvt.effects.protocol import Family
from vgvt.effects.sensor_choice import CHANNELS, chosen_channels
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class SignFlip:
    """The chosen channels read minus what they should.

    A force gauge the wrong way round and all accelerometers upside down are one: A/F is minus what it should be, and
    does not tell which. A drive point does: above heave, below what else resonates there, A/F is one over a mass; and
    its imaginary part, the power that the shaker gives, is negative nowhere.
    """

    name: ClassVar[str] = "sign-flip"
    summary: ClassVar[str] = "Some channels have the wrong sign"
    family: ClassVar[Family] = Family.SENSORS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "one entry of every mode shape has the wrong sign, magnitudes and poles are perfect"
    confused_with: ClassVar[tuple[str, ...]] = ("swapped-sensors",)
    separating_test: ClassVar[str] = (
        "rigid modes: all of a rigid aircraft heaves the same way; with the force, or every response, the wrong way "
        "round it still does, but A/F at the drive point is negative above heave, where a mass moves with the force"
    )
    reference: ClassVar[str] = "Ewins, Modal Testing, 2nd ed., chapter 3 (checks on the transducers)"

    channels: str = dataclasses.field(default="", metadata={"doc": f"empty for none, {CHANNELS}"})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Turn the chosen channels of the run over."""
        if not self.channels:
            return NOTHING
        where = chosen_channels(scenario, run, self.channels, self.name)
        return Action(channels=tuple(ChannelFilter(c, _minus) for c in where))


def _minus(frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
    return np.full(frequency_hz.shape, -1.0, dtype=complex)
