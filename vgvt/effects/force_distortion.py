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
from vgvt.scenario.rig import RANDOM_KINDS

_NORMAL = np.linspace(-8.0, 8.0, 1601)
"""Deviations at which averages over Gaussian noise are taken."""


@dataclasses.dataclass(frozen=True, slots=True)
class ForceDistortion:
    """The amplifier gets u + 2 h2 u²/U + h3 (3 u - 4 u³/U²) for a command u of amplitude U.

    A sine of amplitude U comes out with its second and third harmonics h2 U and h3 U and an
    untouched fundamental. A curve to one side also rectifies: h2 U on average. Of noise and multisines U is the rms;
    peaks beyond where the curve would turn back stay where it does, and the whole is scaled so that noise keeps its
    linear part. No other curve makes these harmonics of a sine alone: it turns peaks over where 4 h2 + 9 h3 is above 1.
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
        "", 0.01, 0.25, "second harmonic of the command over its fundamental", neutral=0.0, scale="log"
    )
    third_harmonic: float = parameter(
        "", 0.01, 0.11, "third harmonic of the command over its fundamental", neutral=0.0, scale="log"
    )

    def act(self, scenario: Scenario, run: int) -> Action:
        """Bend the command's line in every run."""
        del run
        if self.second_harmonic == 0 and self.third_harmonic == 0:
            return NOTHING
        amplitude_v = scenario.excitation.amplitude_v
        curve = self._curve if scenario.excitation.kind not in RANDOM_KINDS else self._curve_of_noise

        def bent(command_v: NDArray[np.float64], time_s: NDArray[np.float64]) -> NDArray[np.float64]:
            del time_s
            return np.asarray(amplitude_v * curve(command_v / amplitude_v))

        return Action(command=bent)

    def _curve(self, u: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(u + 2 * self.second_harmonic * u**2 + self.third_harmonic * (3 * u - 4 * u**3))

    def _curve_of_noise(self, u: NDArray[np.float64]) -> NDArray[np.float64]:
        """The rising part of the curve, held beyond, with a regression of 1 on Gaussian noise of unit power."""
        low, high = self._turns()
        density = np.exp(-0.5 * _NORMAL**2)
        gain = density @ (_NORMAL * self._curve(np.clip(_NORMAL, low, high))) / (density @ _NORMAL**2)
        return np.asarray(self._curve(np.clip(u, low, high)) / gain)

    def _turns(self) -> tuple[float, float]:
        """Where the curve's slope 1 + 3 h3 + 4 h2 u - 12 h3 u² ends, below and above 0; infinite where it does not."""
        flat, linear, square = 1 + 3 * self.third_harmonic, 4 * self.second_harmonic, 12 * self.third_harmonic
        root = linear + np.sqrt(linear**2 + 4 * flat * square)
        return -2 * flat / root, (root / (2 * square) if square > 0 else np.inf)
