"""Damping that grows with amplitude: rubbing layers and air squeezed in a root fitting."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import JointLaw
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.root_joint import Kind, Side, root_joints
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class AmplitudeDependentDamping:
    """The root joint resists with c2 |θ′| θ′: its equivalent damper is 8 c2 ω Θ / (3π) at amplitude Θ."""

    name: ClassVar[str] = "amplitude-dependent-damping"
    summary: ClassVar[str] = "Damping grows with amplitude while frequencies stay"
    family: ClassVar[Family] = Family.NONLINEAR
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = (
        "peaks grow less than the force does while their frequencies stay; damping against amplitude is a straight line"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("root-friction",)
    separating_test: ClassVar[str] = (
        "sweep at three levels and plot damping against amplitude: a straight line through the small-signal value"
    )
    reference: ClassVar[str] = (
        "Krylov and Bogoliubov, Introduction to Nonlinear Mechanics, 1943 (equivalent linearisation); "
        "Goege et al., Int. J. Non-Linear Mech. 40, 2005 (linearity plots)"
    )

    quadratic_damping_n_m_s2_per_rad2: float = parameter(
        "N m s^2/rad^2", 1.0, 300.0, "coefficient c2 of the joint", neutral=0.0, scale="log"
    )
    root_stiffness_n_m_per_rad: float = parameter(
        "N m/rad",
        300.0,
        6000.0,
        "the joint's linear stiffness where the beam's root is rigid",
        default=2000.0,
        scale="log",
    )
    kind: Kind = dataclasses.field(default="bending", metadata={"doc": "'bending' or 'torsion'"})
    side: Side = dataclasses.field(default="both", metadata={"doc": "'both', 'right' or 'left'"})
    beam: str = dataclasses.field(default="", metadata={"doc": "plain name of the beam; empty for the first"})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Give the root joints their force law, in every run."""
        del run
        if self.quadratic_damping_n_m_s2_per_rad2 == 0:
            return NOTHING
        joints = root_joints(scenario, self.beam, self.side, self.kind, self.root_stiffness_n_m_per_rad)
        laws = tuple(
            JointLaw(
                beam,
                self.kind,
                joints.stiffness_n_m_per_rad,
                quadratic_damping_n_m_s2_per_rad2=self.quadratic_damping_n_m_s2_per_rad2,
            )
            for beam in joints.beams
        )
        return Action(scenario=joints.scenario, elements=laws)
