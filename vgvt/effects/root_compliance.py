"""The joint at the root of a wing gives way: bolts, a worn fitting, a soft spar box."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

import numpy as np

from vgvt.effects.acting import Turn
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.beams import Side, chosen_beams, on_side, with_beams
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.airframe import Beam
from vgvt.scenario.axis import beam_axis
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class RootCompliance:
    """The root rotates by M/k; its compliance 1/k is a fraction of the whole beam's, the integral of ds/EI (or GJ)."""

    name: ClassVar[str] = "root-compliance"
    summary: ClassVar[str] = "The wing root is softer than stated, on one side or both"
    family: ClassVar[Family] = Family.AIRFRAME
    turn: ClassVar[Turn] = Turn.AT_ROOTS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "all bending (or torsion) modes drop, by their own root moment; one side mixes symmetries"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("stiffness-asymmetry", "added-mass")
    separating_test: ClassVar[str] = "load a wing tip and measure the slope on both sides of the joint"
    reference: ClassVar[str] = "Blevins, Formulas for Natural Frequency and Mode Shape, table 8-1 (spring-hinged beam)"

    bending: float = parameter(
        "", 0.002, 0.3, "bending compliance of the joint per that of the whole beam", neutral=0.0, scale="log"
    )
    torsion: float = parameter(
        "", 0.002, 0.3, "torsional compliance of the joint per that of the whole beam", neutral=0.0, scale="log"
    )
    side: Side = dataclasses.field(default="both", metadata={"doc": "'both', 'right' or 'left'"})
    beam: str = dataclasses.field(default="", metadata={"doc": "a beam; '' for all that are on the body"})

    def __post_init__(self) -> None:
        """ValueError for a joint stiffer than rigid."""
        if min(self.bending, self.torsion) < 0:
            raise ValueError("a compliance cannot be negative")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the compliance to what the joint has already, in every run."""
        del run
        if self.bending == self.torsion == 0:
            return NOTHING
        return Action(scenario=self.softened(scenario, self.name))

    def softened(self, scenario: Scenario, effect: str) -> Scenario:
        """The scenario with that compliance; InputError, naming the ``effect``, where there is no such beam or side."""
        names = chosen_beams(scenario.airframe, self.beam, effect)
        changed, names = on_side(scenario, names, self.side, effect)
        return with_beams(changed, names, self._softer)

    def _softer(self, beam: Beam) -> Beam:
        return beam.model_copy(
            update={
                "root_bending_stiffness_n_m_per_rad": _in_series(
                    beam.root_bending_stiffness_n_m_per_rad,
                    self.bending * beam_compliance(beam, beam.stations.bending_stiffness_n_m2),
                ),
                "root_torsional_stiffness_n_m_per_rad": _in_series(
                    beam.root_torsional_stiffness_n_m_per_rad,
                    self.torsion * beam_compliance(beam, beam.stations.torsional_stiffness_n_m2),
                ),
            }
        )


def beam_compliance(beam: Beam, stiffness_n_m2: tuple[float, ...]) -> float:
    """The integral of ds over a stiffness column along the axis, rad/(N m): a rotation per end moment, one a beam."""
    first, last = np.array(stiffness_n_m2[:-1]), np.array(stiffness_n_m2[1:])
    change = (last - first) / first
    # ∫ ds/(E0 (1 + x s/l)) = l log1p(x)/(x E0); its limit for a uniform segment is l/E0.
    tapered = np.abs(change) > 1e-9
    mean = np.where(tapered, np.log1p(change) / np.where(tapered, change, 1.0), 1.0)
    return float((beam_axis(beam).segment_length_m * mean / first).sum())


def _in_series(stiffness: float | None, compliance: float) -> float | None:
    """The joint's stiffness with a compliance added to it; None is rigid."""
    if compliance == 0:
        return stiffness
    return 1 / (compliance + (0.0 if stiffness is None else 1 / stiffness))
