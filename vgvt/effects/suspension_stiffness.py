"""The suspension spring is stiffer or softer than its label."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class SuspensionStiffness:
    """Heave goes with sqrt(k); elastic modes feel k φ² of the hook, a fraction (f_heave/f)² of their own stiffness."""

    name: ClassVar[str] = "suspension-stiffness"
    summary: ClassVar[str] = "The suspension spring is stiffer or softer than stated"
    family: ClassVar[Family] = Family.SUSPENSION
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "the heave mode moves; nothing above about 3 Hz"
    confused_with: ClassVar[tuple[str, ...]] = ("added-mass", "pendulum-length")
    separating_test: ClassVar[str] = "count heave cycles by hand for a minute, or hang known weights on the spring"
    reference: ClassVar[str] = "Ewins, Modal Testing, 2nd ed., chapter 3 (free supports)"

    stiffness_change: float = parameter(
        "", -0.2, 0.2, "change of the stiffness as a fraction of the stated one", neutral=0.0
    )

    def act(self, scenario: Scenario, run: int) -> Action:
        """Scale the spring, in every run; the frame is raised or lowered so that the aircraft hangs where it did."""
        del run
        if self.stiffness_change == 0:
            return NOTHING
        stiffness = scenario.suspension.stiffness_n_per_m * (1 + self.stiffness_change)
        suspension = scenario.suspension.model_copy(update={"stiffness_n_per_m": stiffness})
        return Action(scenario=scenario.model_copy(update={"suspension": suspension}))

    def __post_init__(self) -> None:
        """ValueError for a spring without stiffness."""
        if self.stiffness_change <= -1:
            raise ValueError("stiffness_change must stay above -1: nothing would be left of the spring")
