"""The hangar warms up, or cools down, while the campaign goes on."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.acting import Turn
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.airframe_stiffness import with_damping_scaled, with_stiffness_scaled
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.run_schedule import Shape, check_schedule, progress
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class TemperatureChange:
    """Warmer structure is softer and damps more: factors 1 + coefficient · warming, growing over the runs.

    Softer are EI, GJ, root springs and the carry-through, those that other effects soften or add among them. The
    suspension stays, and so do springs of what hangs on the airframe or ties two places of it.
    """

    name: ClassVar[str] = "temperature-change"
    summary: ClassVar[str] = "The hangar's temperature changes during the campaign"
    family: ClassVar[Family] = Family.BETWEEN_RUNS
    turn: ClassVar[Turn] = Turn.TO_ALL_OF_IT
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "frequencies and damping ratios of all modes move together with time, damping by far the more"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("run-drift",)
    separating_test: ClassVar[str] = (
        "log the temperature beside the runs; repeat the first run at the first temperature"
    )
    reference: ClassVar[str] = (
        "Sohn, Phil. Trans. R. Soc. A 365, 2007 (effects of environment on modal data); coefficients are guesses"
    )

    warming_k: float = parameter("K", -10.0, 10.0, "how much warmer the last run is than the first", neutral=0.0)
    stiffness_per_k: float = parameter("1/K", -3e-3, -2e-4, "relative change of all stiffness", default=-1e-3)
    damping_per_k: float = parameter("1/K", 0.0, 0.03, "relative change of damping ratios", default=0.01)
    shape: Shape = dataclasses.field(default="linear", metadata={"doc": "'linear', 'exponential' or 'step'"})
    time_constant_runs: float = dataclasses.field(default=3.0, metadata={"doc": "of the exponential, in runs"})
    from_run: int = dataclasses.field(default=2, metadata={"doc": "first run after the step, counted from 1"})

    def __post_init__(self) -> None:
        check_schedule(self.time_constant_runs, self.from_run)

    def act(self, scenario: Scenario, run: int) -> Action:
        """Soften the airframe and raise its damping as far as the warming has come in this run."""
        runs = len(scenario.acquisition.run_nodes)
        done = progress(self.shape, run, runs, self.time_constant_runs, self.from_run)
        warming = self.warming_k * done
        if warming == 0:
            return NOTHING
        airframe = with_stiffness_scaled(scenario.airframe, 1 + self.stiffness_per_k * warming)
        airframe = with_damping_scaled(airframe, 1 + self.damping_per_k * warming)
        return Action(scenario=scenario.model_copy(update={"airframe": airframe}), warming_k=warming)
