"""A part resists rotation more than the scenario says, at the same weight: masses far from their common centre."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.added_mass import with_lump
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario

# An item must weigh something: a microgram, far below anything that is measured.
_NEXT_TO_NOTHING_KG = 1e-9


@dataclasses.dataclass(frozen=True, slots=True)
class AddedInertia:
    """Rotary inertia J lowers a frequency by J θ²/(2 m_r), θ the rotation of the mode there.

    Flat, as wings and centre bodies are: yaw gets the sum of roll and pitch.
    """

    name: ClassVar[str] = "added-inertia"
    summary: ClassVar[str] = "A part has more rotary inertia than the scenario says"
    family: ClassVar[Family] = Family.AIRFRAME
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "modes that rotate there drop, pitch mostly torsion; the weight is right"
    confused_with: ClassVar[tuple[str, ...]] = ("section-cg-offset", "added-mass")
    separating_test: ClassVar[str] = "swing the aircraft as a bifilar pendulum about each axis"
    reference: ClassVar[str] = "Gupta, Seiler and Danowsky, AIAA 2016-1753 (swing tests, Table 1)"

    pitch_inertia_kg_m2: float = parameter(
        "kg m^2", 1e-4, 0.1, "inertia about the y axis", neutral=0.0, scale="log", source="Ixx + Iyy - Izz of Hati: 0.3"
    )
    roll_inertia_kg_m2: float = parameter("kg m^2", 1e-4, 0.1, "inertia about the x axis", neutral=0.0, scale="log")
    x_m: float = parameter("m", 0.0, 1.2, "where it is, aft of the nose", default=0.48)
    y_m: float = parameter("m", -1.5, 1.5, "where it is, to the right", default=0.0)

    def __post_init__(self) -> None:
        """ValueError for a negative inertia."""
        if min(self.pitch_inertia_kg_m2, self.roll_inertia_kg_m2) < 0:
            raise ValueError("an added inertia cannot be negative")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the inertia as an item of the airframe, in every run."""
        del run
        roll, pitch = self.roll_inertia_kg_m2, self.pitch_inertia_kg_m2
        if roll == pitch == 0:
            return NOTHING
        inertia = (roll, pitch, roll + pitch)
        place = (self.x_m, self.y_m)
        return Action(scenario=with_lump(scenario, self.name, _NEXT_TO_NOTHING_KG, place, inertia))
