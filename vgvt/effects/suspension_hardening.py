"""A suspension spring that stiffens as it stretches: a rubber cord near its end, coils that bind."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.acting import Turn
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import SuspensionCubic
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario

STROKE_M = 0.01
"""Motion from the hung place at which the hardening is stated."""


@dataclasses.dataclass(frozen=True, slots=True)
class SuspensionHardening:
    """The spring's force is k x + k3 x³ for a motion x from where the aircraft hangs; k3 = h k / 3 (10 mm)².

    Its slope is (1 + h) k at 10 mm to either side. The truth is linear about rest, and does not know it.
    """

    name: ClassVar[str] = "suspension-hardening"
    summary: ClassVar[str] = "The suspension spring stiffens with the motion of the aircraft"
    family: ClassVar[Family] = Family.SUSPENSION
    turn: ClassVar[Turn] = Turn.IN_THE_RIG
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = "heave rises with level, and third harmonics of a slow sweep; nothing above some hertz"
    confused_with: ClassVar[tuple[str, ...]] = ("suspension-stiffness", "root-friction")
    separating_test: ClassVar[str] = "let the aircraft heave freely and watch the period as it dies out"
    reference: ClassVar[str] = (
        "Nayfeh and Mook, Nonlinear Oscillations, 1979 (Duffing); Treloar, The Physics of Rubber Elasticity, 1975"
    )

    hardening: float = parameter(
        "",
        0.01,
        2.0,
        "increase of the spring's slope 10 mm from where the aircraft hangs, as a fraction",
        neutral=0.0,
        scale="log",
        least=0.0,
    )

    def act(self, scenario: Scenario, run: int) -> Action:
        """Put the cubic part beside the spring, in every run."""
        del run
        if self.hardening == 0:
            return NOTHING
        cubic = self.hardening * scenario.suspension.stiffness_n_per_m / (3 * STROKE_M**2)
        return Action(elements=(SuspensionCubic(cubic),))
