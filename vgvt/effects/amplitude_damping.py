"""Damping that grows with amplitude: rubbing layers, cables, air that separates at the edges."""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import ModalDrag
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class AmplitudeDependentDamping:
    """Every mode resists with d |q′| q′: its damping ratio is ζ + growth · Q at mass-normalised amplitude Q.

    d = 3 π growth / 4 by equivalent linearisation. Modes up to the limit of the airframe's
    exact damping ratios have it; the truth is that of vanishing amplitude.
    """

    name: ClassVar[str] = "amplitude-dependent-damping"
    summary: ClassVar[str] = "Damping grows with amplitude while frequencies stay"
    family: ClassVar[Family] = Family.NONLINEAR
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = (
        "peaks grow less than the force does while their frequencies stay; damping against amplitude is a straight line"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("root-friction",)
    separating_test: ClassVar[str] = "sweep at three levels and plot damping against amplitude: friction falls again"
    reference: ClassVar[str] = (
        "Krylov and Bogoliubov, Introduction to Nonlinear Mechanics, 1943 (equivalent linearisation); "
        "Goege et al., Int. J. Non-Linear Mech. 40, 2005 (linearity plots)"
    )

    growth_per_rtkg_m: float = parameter(
        "1/(kg^0.5 m)", 0.3, 10.0, "damping ratio added per mass-normalised amplitude", neutral=0.0, scale="log"
    )

    def act(self, scenario: Scenario, run: int) -> Action:
        """Let the modal dampers grow with amplitude, in every run."""
        del scenario, run
        if self.growth_per_rtkg_m == 0:
            return NOTHING
        return Action(elements=(ModalDrag(0.75 * math.pi * self.growth_per_rtkg_m),))
