"""Something is put into the aircraft between runs: a battery, ballast, a forgotten tool."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import PointMass
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.run_schedule import after, check_schedule
from vgvt.scenario.model import Scenario
from vgvt.scenario.planform import part_at, surface_height_m


@dataclasses.dataclass(frozen=True, slots=True)
class PayloadChange:
    """From a run on the airframe carries one more lumped mass; the bare truth is that of the first run.

    Out on one wing it also tips the hung aircraft: by atan(m y / M h) where it hangs by h above its centre of gravity.
    """

    name: ClassVar[str] = "payload-change"
    summary: ClassVar[str] = "The aircraft carries more in later runs than in earlier ones"
    family: ClassVar[Family] = Family.BETWEEN_RUNS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "every pole drops by half phi squared m from one run to the next and stays there"
    confused_with: ClassVar[tuple[str, ...]] = ("run-drift", "roving-sensor-mass")
    separating_test: ClassVar[str] = "weigh the aircraft before and after the campaign; repeat the first run at the end"
    reference: ClassVar[str] = (
        "Ewins, Modal Testing, 2nd ed., chapter 3 (mass loading); Rayleigh: df / f = -phi^2 m / 2"
    )

    mass_kg: float = parameter("kg", 0.005, 0.2, "mass that is put in", neutral=0.0, scale="log")
    x_m: float = parameter("m", 0.0, 1.2, "where, aft of the nose", default=0.45)
    y_m: float = parameter("m", -1.5, 1.5, "where, to the right", default=0.0)
    from_run: int = dataclasses.field(default=2, metadata={"doc": "first run after the change, counted from 1"})

    def __post_init__(self) -> None:
        check_schedule(1.0, self.from_run)

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the mass, from the run after the change on."""
        if self.mass_kg == 0 or not after(run, self.from_run):
            return NOTHING
        part = part_at(scenario.airframe, (self.x_m, self.y_m))
        height = surface_height_m(scenario.airframe, part, self.x_m, self.y_m)
        return Action(elements=(PointMass(part, (self.x_m, self.y_m, height), self.mass_kg),))
