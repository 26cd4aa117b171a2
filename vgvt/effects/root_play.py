"""Play in a root joint: a worn pin, a spar that sits loosely in its box."""

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
class RootFreeplay:
    """The root joint turns freely within a gap and with stiffness k beyond it.

    The truth is linear about rest: as hung, with the weight against one side of the gap; bare, inside it.
    """

    name: ClassVar[str] = "root-freeplay"
    summary: ClassVar[str] = "The wing root turns freely within a small gap"
    family: ClassVar[Family] = Family.NONLINEAR
    turn: ClassVar[Turn] = Turn.IN_JOINTS
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = (
        "strong softening at low level unless the weight holds the joint against a stop, jumps, odd harmonics; the "
        "linear frequencies return at high level"
    )
    confused_with: ClassVar[tuple[str, ...]] = (
        "root-compliance",
        "root-friction",
        "cubic-root-stiffness",
        "local-absorber",
    )
    separating_test: ClassVar[str] = "preload the joint with a soft cord: the softening goes"
    reference: ClassVar[str] = (
        "Kholodar, Nature of freeplay-induced aeroelastic oscillations, J. Aircraft 51, 2014; "
        "Nayfeh and Mook, Nonlinear Oscillations, 1979 (piecewise linear springs)"
    )

    gap_rad: float = parameter("rad", 3.5e-4, 8.7e-3, "whole gap from stop to stop", neutral=0.0, scale="log")
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
    kind: Kind = dataclasses.field(default="torsion", metadata={"doc": "'bending' or 'torsion'"})
    side: Side = dataclasses.field(default="both", metadata={"doc": "'both', 'right' or 'left'"})
    beam: str = dataclasses.field(default="", metadata={"doc": "plain name of the beam; empty for the first"})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Give the root joints their force law, in every run."""
        del run
        if self.gap_rad == 0:
            return NOTHING
        stiffness = self.root_stiffness_n_m_per_rad
        jointed, joints = root_joints(scenario, self.beam, self.side, self.kind, stiffness, self.name)
        laws = tuple(
            JointLaw(j.beam, self.kind, j.stiffness_n_m_per_rad, play_rad=self.gap_rad / 2, root=j.root) for j in joints
        )
        return Action(scenario=jointed, elements=laws)
