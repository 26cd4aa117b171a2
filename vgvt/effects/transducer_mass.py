"""Mass below the force gauge's sensing element that nobody weighed: a clamp, a stud, a plate, the gauge's own end."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class TransducerMass:
    """Extra mass between sensing element and structure: the gauge reads F + m a at the drive point d.

    All FRFs change by one factor, H' = H / (1 + m H_dd).
    """

    name: ClassVar[str] = "transducer-mass"
    summary: ClassVar[str] = "Unaccounted mass sits between the force gauge's sensing element and the structure"
    family: ClassVar[Family] = Family.DRIVE_PATH
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "one factor on all channels, largest near resonances of the drive point; poles drop"
    confused_with: ClassVar[tuple[str, ...]] = ("added-mass", "channel-gain", "base-strain")
    separating_test: ClassVar[str] = "shake the gauge with its clamp but without the aircraft: A/F is one over the mass"
    reference: ClassVar[str] = (
        "Ewins, Modal Testing, 2nd ed., chapter 3 (mass cancellation); Cakar and Sanliturk, Mech. Syst. Signal "
        "Process. 19, 2005"
    )

    mass_kg: float = parameter(
        "kg",
        0.005,
        0.08,
        "mass below the sensing element beyond what the scenario states",
        neutral=0.0,
        scale="log",
        source="PCB 208C01: 22.7 g in all, 5-15 g on the structure's side; clamps and plates weigh more",
    )

    def act(self, scenario: Scenario, run: int) -> Action:
        """Make the transducer heavier, in every run."""
        del run
        if self.mass_kg == 0:
            return NOTHING
        stated = scenario.transducer
        heavier = {"mass_kg": stated.mass_kg + self.mass_kg, "end_mass_kg": stated.end_mass_kg + self.mass_kg}
        return Action(scenario=scenario.model_copy(update={"transducer": stated.model_copy(update=heavier)}))
