"""Bending twists the wing: an unbalanced laminate, or plies laid off the axis."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.beams import Side, chosen_beams, copies_of, on_side
from vgvt.effects.elements import BendTwist
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class BendTwistCoupling:
    """M = EI w'' − K φ', T = −K w'' + GJ φ' with K = κ sqrt(EI GJ): without torque φ' is κ sqrt(EI/GJ) w''.

    φ is positive leading edge up, on both sides: the two wings are mirror images.
    """

    name: ClassVar[str] = "bend-twist-coupling"
    summary: ClassVar[str] = "The wing twists as it bends"
    family: ClassVar[Family] = Family.AIRFRAME
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "leading and trailing edge move by different amounts in bending modes; torsion bends"
    confused_with: ClassVar[tuple[str, ...]] = ("section-cg-offset",)
    separating_test: ClassVar[str] = (
        "a static load on the elastic axis: coupling twists the wing, a mass offset does not"
    )
    reference: ClassVar[str] = (
        "Weisshaar and Foist, Vibration tailoring of advanced composite lifting surfaces, J. Aircraft 22, 1985"
    )

    coupling: float = parameter(
        "", -0.3, 0.3, "κ = K / sqrt(EI GJ); positive twists the leading edge up as the wing bends up", neutral=0.0
    )
    side: Side = dataclasses.field(default="both", metadata={"doc": "'both', 'right' or 'left'"})
    beam: str = dataclasses.field(default="", metadata={"doc": "a beam; '' for all that are on the body"})

    def __post_init__(self) -> None:
        """ValueError where the strain energy would not be positive."""
        if abs(self.coupling) >= 1:
            raise ValueError("coupling must lie between -1 and 1, or the wing would be unstable")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Couple bending and torsion along the whole beam, in every run."""
        del run
        if self.coupling == 0:
            return NOTHING
        names = chosen_beams(scenario.airframe, self.beam, self.name)
        split, names = on_side(scenario, names, self.side, self.name)
        return Action(elements=tuple(BendTwist(n, self.coupling) for n in copies_of(split.airframe, names)))
