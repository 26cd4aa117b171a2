"""The frame that the spring hangs from gives way and resonates."""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import SuspensionFrame
from vgvt.effects.parameter import parameter, require_above_zero
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class FrameResonance:
    """A mass on a spring and dashpot between the spring's upper end and the ground.

    Through a soft spring k the aircraft sees of it only k²/(k_f − ω² m_f): next
    to nothing, unless a surge of the spring is near. A spring without mass has none: where suspension-surge is in the
    scenario too, in either order, its surges meet the frame.
    """

    name: ClassVar[str] = "frame-resonance"
    summary: ClassVar[str] = "The frame that carries the spring resonates"
    family: ClassVar[Family] = Family.SUSPENSION
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "a faint pole-zero pair at the frame's frequency in all channels; heave a little lower"
    confused_with: ClassVar[tuple[str, ...]] = ("suspension-surge", "local-absorber")
    separating_test: ClassVar[str] = "an accelerometer on the frame; tap the frame with a hammer"
    reference: ClassVar[str] = "Den Hartog, Mechanical Vibrations, 4th ed., chapter 3 (two masses in series)"

    compliance_m_per_n: float = parameter(
        "m/N",
        1e-6,
        6e-4,
        "static compliance c of the frame where the spring hangs; its mass there is then 1/(c ω²) at its own frequency "
        "ω, and 5 to 50 kg are usual: the corners of the two ranges are not",
        neutral=0.0,
        scale="log",
        least=0.0,
    )
    frequency_hz: float = parameter(
        "Hz", 3.0, 20.0, "frequency of the frame alone", default=8.0, scale="log", least=0.0
    )
    damping_ratio: float = parameter(
        "", 0.01, 0.05, "damping ratio of the frame alone", default=0.02, scale="log", least=0.0
    )

    def __post_init__(self) -> None:
        """ValueError for a frame that is free."""
        require_above_zero(self, "frequency_hz")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Put the spring's upper end on the frame, in every run."""
        del scenario, run
        if self.compliance_m_per_n == 0:
            return NOTHING
        omega, stiffness = 2 * math.pi * self.frequency_hz, 1 / self.compliance_m_per_n
        mass = stiffness / omega**2
        return Action(elements=(SuspensionFrame(mass, stiffness, 2 * self.damping_ratio * mass * omega),))
