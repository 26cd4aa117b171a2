"""A bundle of cables along the wing ties one place of the airframe to another."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import PointPair, Vector
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario
from vgvt.scenario.planform import part_at, surface_height_m


@dataclasses.dataclass(frozen=True, slots=True)
class CableBundle:
    """Spring and dashpot on the difference of two points' heights above the rigid centre body.

    The bundle's bending stiffness holds its ends level with each other. An end on the centre body
    does not move against it, so that the default ties the right wing to the body.
    """

    name: ClassVar[str] = "cable-bundle"
    summary: ClassVar[str] = "A bundle of cables ties two places of the airframe together"
    family: ClassVar[Family] = Family.AIRFRAME
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "modes in which the two places move apart stiffen and damp, the same in every run; the others stay"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("carry-through-torsion", "cable-drag", "stiffness-asymmetry")
    separating_test: ClassVar[str] = "untie the bundle, or route it another way, and repeat one run"
    reference: ClassVar[str] = (
        "Coombs et al., Dynamic modeling and experimental validation of a cable-loaded panel, J. Spacecr. Rockets 48, "
        "2011; ranges are guesses"
    )

    stiffness_n_per_m: float = parameter(
        "N/m", 1.0, 100.0, "force per difference of height", neutral=0.0, scale="log", least=0.0
    )
    damping_n_s_per_m: float = parameter("N s/m", 0.001, 1.0, "damper beside it", neutral=0.0, scale="log", least=0.0)
    x_m: float = parameter("m", 0.0, 1.2, "one end, aft of the nose", default=0.9)
    y_m: float = parameter("m", -1.5, 1.5, "one end, to the right", default=1.2)
    other_x_m: float = parameter("m", 0.0, 1.2, "the other end, aft of the nose", default=0.45)
    other_y_m: float = parameter("m", -1.5, 1.5, "the other end, to the right", default=0.0)

    def act(self, scenario: Scenario, run: int) -> Action:
        """Tie the two places together, in every run."""
        del run
        if self.stiffness_n_per_m == 0 and self.damping_n_s_per_m == 0:
            return NOTHING
        ends = (_end(scenario, self.x_m, self.y_m), _end(scenario, self.other_x_m, self.other_y_m))
        return Action(elements=(PointPair(*ends[0], *ends[1], self.stiffness_n_per_m, self.damping_n_s_per_m),))


def _end(scenario: Scenario, x_m: float, y_m: float) -> tuple[str, Vector]:
    part = part_at(scenario.airframe, (x_m, y_m))
    return part, (x_m, y_m, surface_height_m(scenario.airframe, part, x_m, y_m))
