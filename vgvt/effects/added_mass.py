"""A lump of mass that nobody wrote down: ballast, glue, a connector, a forgotten sensor."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.beams import with_airframe
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.airframe import Item
from vgvt.scenario.model import Scenario
from vgvt.scenario.planform import part_at, surface_height_m


@dataclasses.dataclass(frozen=True, slots=True)
class AddedMass:
    """A mass m lowers a frequency by φ² m/(2 m_r): modes with a node there do not notice.

    Out on one wing it also tips the hung aircraft: by atan(m y / M h) where it hangs by h above its centre of gravity.
    """

    name: ClassVar[str] = "added-mass"
    summary: ClassVar[str] = "There is a lump of mass on the airframe that the scenario does not have"
    family: ClassVar[Family] = Family.AIRFRAME
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "frequencies drop as the square of the mode shape there, the same in all runs"
    confused_with: ClassVar[tuple[str, ...]] = ("local-absorber", "root-compliance", "added-inertia")
    separating_test: ClassVar[str] = "weigh the aircraft and find its centre of gravity"
    reference: ClassVar[str] = "Ewins, Modal Testing, 2nd ed., chapter 3 (mass loading)"

    mass_kg: float = parameter("kg", 0.002, 0.2, "mass", neutral=0.0, scale="log")
    x_m: float = parameter("m", 0.0, 1.2, "where it sits, aft of the nose", default=0.45)
    y_m: float = parameter("m", -1.5, 1.5, "where it sits, to the right", default=0.0)

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the mass as an item of the airframe, in every run."""
        del run
        if self.mass_kg == 0:
            return NOTHING
        return Action(scenario=with_lump(scenario, self.name, self.mass_kg, (self.x_m, self.y_m)))

    def __post_init__(self) -> None:
        """ValueError for a negative mass."""
        if self.mass_kg < 0:
            raise ValueError("mass_kg cannot be negative: take mass off an item of the airframe instead")


def with_lump(
    scenario: Scenario,
    name: str,
    mass_kg: float,
    place_m: tuple[float, float],
    inertia_kg_m2: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Scenario:
    """The scenario with one more item at (x, y), on the surface that is there."""
    airframe = scenario.airframe
    part = part_at(airframe, place_m)
    position = (*place_m, surface_height_m(airframe, part, *place_m))
    lump = Item(
        name=f"{name}-{len(airframe.item)}",
        mass_kg=mass_kg,
        position_m=position,
        inertia_kg_m2=inertia_kg_m2,
        attached_to=part,
    )
    return with_airframe(scenario, item=(*airframe.item, lump))
