"""The suspension takes more energy than the scenario says: cord, elastic bands, knots."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class SuspensionDamping:
    """A dashpot c beside the spring adds c φ²/(2 m ω) to the damping ratio of each mode, φ its motion at the hook."""

    name: ClassVar[str] = "suspension-damping"
    summary: ClassVar[str] = "The suspension dissipates more than stated"
    family: ClassVar[Family] = Family.SUSPENSION
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "heave well damped, more damping of modes that move the hook, frequencies unchanged"
    confused_with: ClassVar[tuple[str, ...]] = ("nonproportional-damper", "entrained-air")
    separating_test: ClassVar[str] = "let heave ring down without the shaker; change to another suspension"
    reference: ClassVar[str] = (
        "Carne, Griffith and Casias, Support conditions for free boundary-condition modal testing"
    )

    damping_n_s_per_m: float = parameter(
        "N s/m", 0.1, 5.0, "dashpot added in line with the spring", neutral=0.0, scale="log", least=0.0
    )

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the dashpot, in every run."""
        del run
        if self.damping_n_s_per_m == 0:
            return NOTHING
        damping = scenario.suspension.damping_n_s_per_m + self.damping_n_s_per_m
        suspension = scenario.suspension.model_copy(update={"damping_n_s_per_m": damping})
        return Action(scenario=scenario.model_copy(update={"suspension": suspension}))
