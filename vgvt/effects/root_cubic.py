"""A root joint that stiffens, or softens, as it turns: a bolted fitting that beds in, a membrane skin."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.acting import Turn
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import JointLaw
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.root_joint import Kind, Side, root_joints
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class CubicRootStiffness:
    """The root joint's torque is k θ + k3 θ³."""

    name: ClassVar[str] = "cubic-root-stiffness"
    summary: ClassVar[str] = "The wing root gets stiffer the further it turns"
    family: ClassVar[Family] = Family.NONLINEAR
    turn: ClassVar[Turn] = Turn.IN_JOINTS
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = (
        "natural frequencies of the modes that turn the root rise with level, peaks lean right; where the weight "
        "preloads the joint (bending) they may fall first, and rise when the motion is larger than the sag; third "
        "harmonics, and second ones with a preload"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("root-compliance", "root-friction", "root-freeplay")
    separating_test: ClassVar[str] = "sweep at two or three force levels, and up and down"
    reference: ClassVar[str] = (
        "Nayfeh and Mook, Nonlinear Oscillations, 1979, chapter 4 (Duffing); "
        "Kerschen et al., Mech. Syst. Signal Process. 20, 2006 (review)"
    )

    cubic_n_m_per_rad3: float = parameter(
        "N m/rad^3", 1e6, 1e9, "cubic stiffness k3 of the joint", neutral=0.0, scale="log"
    )
    root_stiffness_n_m_per_rad: float = parameter(
        "N m/rad",
        300.0,
        6000.0,
        "the joint's linear stiffness where the beam's root is rigid",
        default=2000.0,
        scale="log",
        # Without any the wing hangs loose, and the aircraft has no modes to speak of.
        least=1.0,
    )
    kind: Kind = dataclasses.field(default="bending", metadata={"doc": "'bending' or 'torsion'"})
    side: Side = dataclasses.field(default="both", metadata={"doc": "'both', 'right' or 'left'"})
    beam: str = dataclasses.field(default="", metadata={"doc": "plain name of the beam; empty for the first"})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Give the root joints their force law, in every run."""
        del run
        if self.cubic_n_m_per_rad3 == 0:
            return NOTHING
        stiffness = self.root_stiffness_n_m_per_rad
        jointed, joints = root_joints(scenario, self.beam, self.side, self.kind, stiffness, self.name)
        laws = tuple(
            JointLaw(
                j.beam, self.kind, j.stiffness_n_m_per_rad, cubic_n_m_per_rad3=self.cubic_n_m_per_rad3, root=j.root
            )
            for j in joints
        )
        return Action(scenario=jointed, elements=laws)
