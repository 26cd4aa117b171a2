"""The airframe warms up while a record runs: glue and foam soften under their own losses, or a lamp shines on them."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import WarmUp as Softening
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class WarmUp:
    """The airframe's linear springs times 1 - softening · (1 - exp(-t/T)), t from the start of every record.

    Until then they are cold. Those are EI, GJ, roots and carry-through, and what other effects lay across these, before
    or after it: a coupling of bending and torsion, the stops of a root's play, a material's memory. A cubic root keeps
    its k3.
    Superposition holds, but not invariance in time: only the mujoco engine can follow, and the linear one keeps the
    airframe cold, as the truth does.
    """

    name: ClassVar[str] = "warm-up"
    summary: ClassVar[str] = "The airframe softens while a record runs"
    family: ClassVar[Family] = Family.NONLINEAR
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = (
        "what a sweep passes late is softer: sweeps up and down disagree, and at every level alike"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("run-drift", "cubic-root-stiffness", "viscoelastic-stiffness")
    separating_test: ClassVar[str] = "sweep up, then down, then at half the level: warmth asks for time, not for force"
    reference: ClassVar[str] = (
        "Cooper and Worden, On-line physical parameter estimation with adaptive forgetting factors, Mech. Syst. Signal "
        "Process. 14, 2000 (systems that vary within a record); sizes are guesses"
    )

    softening: float = parameter("", -0.1, 0.1, "share of all stiffness that is lost in the end", neutral=0.0)
    time_constant_s: float = parameter("s", 2.0, 120.0, "time constant of the warming", default=10.0, scale="log")

    def __post_init__(self) -> None:
        """ValueError for an airframe that melts, or warms at once."""
        if not self.softening < 1:
            raise ValueError("softening must stay below 1")
        if not self.time_constant_s > 0:
            raise ValueError("time_constant_s must be above 0")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Let the springs soften from the start of the record, in every run."""
        del run
        if self.softening == 0:
            return NOTHING
        begin_s = scenario.excitation.before_record_s
        return Action(elements=(Softening(self.softening, self.time_constant_s, begin_s=begin_s),))
