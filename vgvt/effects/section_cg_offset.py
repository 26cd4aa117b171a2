"""The sections' masses lie fore or aft of where the scenario has them, or are spread more widely."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.beams import chosen_beams, scaled, with_beams, with_columns
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.airframe import Beam
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class SectionCgOffset:
    """Mass behind the elastic axis twists the wing as it accelerates: coupling by inertia, growing with ω²."""

    name: ClassVar[str] = "section-cg-offset"
    summary: ClassVar[str] = "Centre of gravity or pitch inertia of the wing sections differ from the stated ones"
    family: ClassVar[Family] = Family.AIRFRAME
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "leading and trailing edge differ in bending modes, more so in higher ones; torsion moves"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("bend-twist-coupling", "added-inertia")
    separating_test: ClassVar[str] = "balance the wing alone on its axis; a static load shows no twist"
    reference: ClassVar[str] = "Bisplinghoff, Ashley and Halfman, Aeroelasticity, 1955 (coupled bending and torsion)"

    offset_m: float = parameter("m", -0.01, 0.01, "how far aft of its stated place each section's mass is", neutral=0.0)
    pitch_inertia_change: float = parameter(
        "", -0.3, 0.3, "change of the pitch inertia per length as a fraction of the stated one", neutral=0.0
    )
    beam: str = dataclasses.field(default="", metadata={"doc": "a beam; '' for all that are on the body"})

    def __post_init__(self) -> None:
        """ValueError for negative inertia."""
        if self.pitch_inertia_change < -1:
            raise ValueError("pitch_inertia_change cannot be below -1")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Move and spread the sections, in every run."""
        del run
        if self.offset_m == self.pitch_inertia_change == 0:
            return NOTHING
        names = chosen_beams(scenario.airframe, self.beam, self.name)
        return Action(scenario=with_beams(scenario, names, self._moved))

    def _moved(self, beam: Beam) -> Beam:
        stations = beam.stations
        offsets = stations.cg_offset_m or (0.0,) * len(stations.position_m)
        return with_columns(
            beam,
            cg_offset_m=(offset + self.offset_m for offset in offsets),
            pitch_inertia_kg_m=scaled(stations.pitch_inertia_kg_m, 1 + self.pitch_inertia_change),
        )
