"""The root joint alone gives way from run to run: bolts that settle, a glued fitting that creeps."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.acting import Turn
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.beams import Side
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.root_compliance import RootCompliance
from vgvt.effects.run_schedule import Shape, check_schedule, progress
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class RootCreep:
    """The root gains s(run) times a fraction of its beam's compliance, s from 0 in the first run to 1 in the last."""

    name: ClassVar[str] = "root-creep"
    summary: ClassVar[str] = "The wing root softens from run to run, and nothing else does"
    family: ClassVar[Family] = Family.BETWEEN_RUNS
    turn: ClassVar[Turn] = Turn.AT_ROOTS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "bending (or torsion) modes drop in the order of time, each by its own root moment, the others stay"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("run-drift", "root-compliance", "temperature-change")
    separating_test: ClassVar[str] = (
        "repeat the first run at the end, tighten the joint and repeat it again; torsion tells it from the material"
    )
    reference: ClassVar[str] = (
        "Bickford, An Introduction to the Design and Behavior of Bolted Joints, 3rd ed., 1995 (loss of preload)"
    )

    bending: float = parameter(
        "", 0.002, 0.3, "bending compliance gained per that of the whole beam", neutral=0.0, scale="log"
    )
    torsion: float = parameter(
        "", 0.002, 0.3, "torsional compliance gained per that of the whole beam", neutral=0.0, scale="log"
    )
    side: Side = dataclasses.field(default="both", metadata={"doc": "'both', 'right' or 'left'"})
    beam: str = dataclasses.field(default="", metadata={"doc": "a beam; '' for all that are on the body"})
    shape: Shape = dataclasses.field(default="exponential", metadata={"doc": "'linear', 'exponential' or 'step'"})
    time_constant_runs: float = dataclasses.field(default=3.0, metadata={"doc": "of the exponential, in runs"})
    from_run: int = dataclasses.field(default=2, metadata={"doc": "first run after the step, counted from 1"})

    def __post_init__(self) -> None:
        """ValueError for a joint stiffer than rigid, or a schedule that is none."""
        if min(self.bending, self.torsion) < 0:
            raise ValueError("a compliance cannot be negative")
        check_schedule(self.time_constant_runs, self.from_run)

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add as much compliance to the joint as it has gained in this run."""
        runs = len(scenario.acquisition.run_nodes)
        done = progress(self.shape, run, runs, self.time_constant_runs, self.from_run)
        if done * max(self.bending, self.torsion) == 0:
            return NOTHING
        gained = RootCompliance(self.bending * done, self.torsion * done, self.side, self.beam)
        return Action(scenario=gained.softened(scenario, self.name))
