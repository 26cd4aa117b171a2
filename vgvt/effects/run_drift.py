"""Stiffness that drifts while the campaign goes on: creeping joints, drying glue, an ageing foam core."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.acting import Turn
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.airframe_stiffness import with_stiffness_scaled
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.run_schedule import Shape, check_schedule, progress
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class RunDrift:
    """All EI, GJ, roots and carry-through times 1 + drift · s(run), with s from 0 in the first run to 1 in the last.

    Those that other effects soften or add are among them. The suspension stays, and so do springs of what hangs on the
    airframe or ties two places of it: absorbers, hinges of control surfaces, cables.
    """

    name: ClassVar[str] = "run-drift"
    summary: ClassVar[str] = "The airframe's stiffness drifts from run to run"
    family: ClassVar[Family] = Family.BETWEEN_RUNS
    turn: ClassVar[Turn] = Turn.TO_ALL_OF_IT
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "all natural frequencies move by half the drift, in the order of time and not of the sensors' places"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("temperature-change", "roving-sensor-mass")
    separating_test: ClassVar[str] = "repeat the first run at the end; rove the sensors in another order"
    reference: ClassVar[str] = (
        "Sohn, Phil. Trans. R. Soc. A 365, 2007 (operational variability of modal data); half the drift as f ~ sqrt(EI)"
    )

    drift: float = parameter("", -0.05, 0.05, "relative change of all stiffness at the end", neutral=0.0)
    shape: Shape = dataclasses.field(default="linear", metadata={"doc": "'linear', 'exponential' or 'step'"})
    time_constant_runs: float = dataclasses.field(default=3.0, metadata={"doc": "of the exponential, in runs"})
    from_run: int = dataclasses.field(default=2, metadata={"doc": "first run after the step, counted from 1"})

    def __post_init__(self) -> None:
        check_schedule(self.time_constant_runs, self.from_run)

    def act(self, scenario: Scenario, run: int) -> Action:
        """Scale the stiffness as far as the drift has come in this run."""
        runs = len(scenario.acquisition.run_nodes)
        done = progress(self.shape, run, runs, self.time_constant_runs, self.from_run)
        if self.drift * done == 0:
            return NOTHING
        airframe = with_stiffness_scaled(scenario.airframe, 1 + self.drift * done)
        return Action(scenario=scenario.model_copy(update={"airframe": airframe}))
