"""Harmonic distortion of the force: an amplifier or shaker that answers its command with a curved line."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class ForceDistortion:
    """The amplifier gets u + 2 h2 u²/U + h3 (3 u - 4 u³/U²) for a command u of amplitude U.

    A sine of amplitude U comes out with its second and third harmonics h2 U and h3 U and an
    untouched fundamental. A curve to one side also rectifies: h2 U on average. Random commands: U is the rms.
    """

    name: ClassVar[str] = "force-distortion"
    summary: ClassVar[str] = "The shaker adds second and third harmonics of the command to its force"
    family: ClassVar[Family] = Family.DRIVE_PATH
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = (
        "ridges at two and three times the drive in force and responses alike, in the ratio of its own FRF; "
        "A/F stays, A/drive grows grass"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("clipping-range", "cubic-root-stiffness", "root-freeplay")
    separating_test: ClassVar[str] = (
        "compare a harmonic's response over force with the FRF at that frequency: equal means shaker, unequal structure"
    )
    reference: ClassVar[str] = (
        "Klippel, Loudspeaker nonlinearities: causes, parameters, symptoms, J. Audio Eng. Soc. 54, 2006; "
        "Tomlinson, J. Sound Vib. 63, 1979 (force distortion in resonance testing)"
    )

    second_harmonic: float = parameter(
        "", 0.01, 0.7, "second harmonic of the command over its fundamental", neutral=0.0, scale="log"
    )
    third_harmonic: float = parameter(
        "", 0.01, 0.2, "third harmonic of the command over its fundamental", neutral=0.0, scale="log"
    )

    def act(self, scenario: Scenario, run: int) -> Action:
        """Bend the command's line in every run."""
        del run
        if self.second_harmonic == 0 and self.third_harmonic == 0:
            return NOTHING
        amplitude_v = scenario.excitation.amplitude_v

        def bent(command_v: NDArray[np.float64], time_s: NDArray[np.float64]) -> NDArray[np.float64]:
            del time_s
            u = command_v / amplitude_v
            curve = u + 2 * self.second_harmonic * u**2 + self.third_harmonic * (3 * u - 4 * u**3)
            return np.asarray(amplitude_v * curve)

        return Action(command=bent)
