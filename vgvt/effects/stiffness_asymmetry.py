"""Left and right wing are not equally stiff."""

from __future__ import annotations

import dataclasses
from functools import partial
from typing import ClassVar

from vgvt.data import InputError
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.beams import chosen_beams, plain_name, scaled, with_beams, with_columns, written_out
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.airframe import Beam
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class StiffnessAsymmetry:
    """The right beam gets (1 + a) of its stiffness, the left (1 − a): symmetric and antisymmetric modes mix.

    Frequencies feel it in second order where modes are far apart; two close modes of
    opposite symmetry share it, and each moves to one side of the aircraft.
    """

    name: ClassVar[str] = "stiffness-asymmetry"
    summary: ClassVar[str] = "One wing is stiffer than the other"
    family: ClassVar[Family] = Family.AIRFRAME
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "amplitudes of left and right differ in every mode; close pairs of modes split"
    confused_with: ClassVar[tuple[str, ...]] = ("root-compliance", "added-mass")
    separating_test: ClassVar[str] = "load both wing tips with the same weight and compare the deflections"
    reference: ClassVar[str] = "Pierre, Mode localization and eigenvalue loci veering, J. Sound Vib. 126, 1988"

    bending: float = parameter("", -0.15, 0.15, "fraction by which the right EI is higher, the left lower", neutral=0.0)
    torsion: float = parameter("", -0.15, 0.15, "fraction by which the right GJ is higher, the left lower", neutral=0.0)
    beam: str = dataclasses.field(default="", metadata={"doc": "a mirrored beam; '' for all that are on the body"})

    def __post_init__(self) -> None:
        """ValueError for a wing without stiffness."""
        if max(abs(self.bending), abs(self.torsion)) >= 1:
            raise ValueError("bending and torsion must lie between -1 and 1")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Give each side its own stiffness, in every run; InputError where no chosen beam has two sides."""
        del run
        if self.bending == self.torsion == 0:
            return NOTHING
        plain = {plain_name(n) for n in chosen_beams(scenario.airframe, self.beam, self.name)}
        split = written_out(scenario)
        sided = {n for n in plain if {f"{n}-right", f"{n}-left"} <= {b.name for b in split.airframe.beam}}
        if not sided:
            raise InputError(
                f"effect {self.name}: beam",
                f"there is no right and left copy of {' or '.join(sorted(plain))}",
                "Name a beam that is mirrored.",
            )
        for side, sign in (("right", 1.0), ("left", -1.0)):
            split = with_beams(split, [f"{n}-{side}" for n in sided], partial(self._scaled, sign=sign))
        return Action(scenario=split)

    def _scaled(self, beam: Beam, sign: float) -> Beam:
        stations = beam.stations
        return with_columns(
            beam,
            bending_stiffness_n_m2=scaled(stations.bending_stiffness_n_m2, 1 + sign * self.bending),
            torsional_stiffness_n_m2=scaled(stations.torsional_stiffness_n_m2, 1 + sign * self.torsion),
        )
