"""A stinger that is softer along its axis: too long, too thin, or screwed into something that gives."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class StingerCompliance:
    """A compliance in series with the stinger: 1/k' = 1/k + s; the damper keeps the rod's time constant c/k."""

    name: ClassVar[str] = "stinger-compliance"
    summary: ClassVar[str] = "The stinger is softer along its axis than stated"
    family: ClassVar[Family] = Family.DRIVE_PATH
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "none in A/F; force per command rolls off towards the stinger's own resonance"
    confused_with: ClassVar[tuple[str, ...]] = ("mount-compliance",)
    separating_test: ClassVar[str] = "change the stinger's length by a tenth; A/F must not move, F/drive does"
    reference: ClassVar[str] = "Ewins, Modal Testing, 2nd ed., chapter 3 (drive rods)"

    compliance_m_per_n: float = parameter(
        "m/N",
        1e-7,
        1e-4,
        "compliance in series with the rod",
        neutral=0.0,
        scale="log",
        source="10 MN/m for a stiff joint to 10 kN/m for a thin long rod: guess; steel, 4.6 mm by 216 mm, has 16 MN/m",
        least=0.0,
    )

    def act(self, scenario: Scenario, run: int) -> Action:
        """Soften the stinger, in every run."""
        del run
        if self.compliance_m_per_n == 0:
            return NOTHING
        rod = scenario.stinger
        softer = 1 / (1 + rod.axial_stiffness_n_per_m * self.compliance_m_per_n)
        stinger = rod.model_copy(
            update={
                "axial_stiffness_n_per_m": rod.axial_stiffness_n_per_m * softer,
                "axial_damping_n_s_per_m": rod.axial_damping_n_s_per_m * softer,
            }
        )
        return Action(scenario=scenario.model_copy(update={"stinger": stinger}))
