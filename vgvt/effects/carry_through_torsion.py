"""The centre section between the wings twists: a soft carry-through spar, a fuselage open below."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.data import InputError
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.beams import with_airframe
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.mirror import expanded_beams
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class CarryThroughTorsion:
    """The centre body is two halves, with a wing each, that pitch against each other on a spring.

    They turn about the line through the roots of the beams; each half has half of the body's
    mass and inertia. Hook, shaker and all else in the plane of symmetry move by the mean of both.
    """

    name: ClassVar[str] = "carry-through-torsion"
    summary: ClassVar[str] = "The centre body twists between the wings"
    family: ClassVar[Family] = Family.AIRFRAME
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "antisymmetric modes drop, one of them far, as the body's halves rock against each other; symmetric ones stay"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("root-compliance", "cable-bundle", "stiffness-asymmetry")
    separating_test: ClassVar[str] = "drive symmetrically, then antisymmetrically: a soft GJ shows in both"
    reference: ClassVar[str] = (
        "Bruhn, Analysis and Design of Flight Vehicle Structures, 1973, chapter A6 (torsion of open and closed boxes); "
        "range is a guess"
    )

    compliance_rad_per_n_m: float = parameter(
        "rad/(N m)",
        2e-4,
        1e-2,
        "relative pitch of the two wings' roots per moment between them",
        neutral=0.0,
        scale="log",
    )

    def __post_init__(self) -> None:
        """ValueError for a body stiffer than rigid."""
        if self.compliance_rad_per_n_m < 0:
            raise ValueError("a compliance cannot be negative")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the compliance to what the body has already, in every run; InputError where no wing is on each half."""
        del run
        if self.compliance_rad_per_n_m == 0:
            return NOTHING
        body = scenario.airframe.body
        tips = [b.stations.position_m[-1][1] for b in expanded_beams(scenario.airframe) if b.parent == "body"]
        if not any(y > 0 for y in tips) or not any(y < 0 for y in tips):
            raise InputError(
                f"scenario {scenario.name}: effect {self.name}",
                "the body carries no beam to the right and one to the left, whose roots could pitch against each other",
                "Leave the effect out: it is for wings that hang on the body itself.",
            )
        own = body.carry_through_stiffness_n_m_per_rad
        stiffness = 1 / (self.compliance_rad_per_n_m + (0.0 if own is None else 1 / own))
        halved = body.model_copy(update={"carry_through_stiffness_n_m_per_rad": stiffness})
        return Action(scenario=with_airframe(scenario, body=halved))
