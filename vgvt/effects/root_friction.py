"""Dry friction in a root joint: a bolted or plugged fitting that slips."""

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
class RootFriction:
    """The root joint's torque is k θ + M sign θ′; below M it sticks and the root is rigid.

    The truth and the linear engine have the joint slipping freely: what a loud test tends to.
    """

    name: ClassVar[str] = "root-friction"
    summary: ClassVar[str] = "The wing root sticks at low level and slips with dry friction at high level"
    family: ClassVar[Family] = Family.NONLINEAR
    turn: ClassVar[Turn] = Turn.IN_JOINTS
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = (
        "frequencies fall with level, from those of a rigid root to those of the slipping joint; damping is highest in "
        "between; third harmonics"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("root-compliance", "amplitude-dependent-damping", "root-freeplay")
    separating_test: ClassVar[str] = "sweep at three or more force levels: damping falls again at the loudest"
    reference: ClassVar[str] = (
        "Den Hartog, Trans. ASME 53, 1931 (forced vibration with Coulomb friction); "
        "Bograd et al., Mech. Syst. Signal Process. 25, 2011 (joints, review)"
    )

    friction_n_m: float = parameter("N m", 0.02, 2.0, "torque M at which the joint slips", neutral=0.0, scale="log")
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
        if self.friction_n_m == 0:
            return NOTHING
        stiffness = self.root_stiffness_n_m_per_rad
        jointed, joints = root_joints(scenario, self.beam, self.side, self.kind, stiffness, self.name)
        laws = tuple(
            JointLaw(j.beam, self.kind, j.stiffness_n_m_per_rad, friction_n_m=self.friction_n_m, root=j.root)
            for j in joints
        )
        return Action(scenario=jointed, elements=laws)
