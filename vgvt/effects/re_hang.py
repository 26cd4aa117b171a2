"""The aircraft is taken down between runs and hung up again, not quite where it was."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.run_schedule import after, check_schedule
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class ReHang:
    """From a run on the spring holds the aircraft at another point."""

    name: ClassVar[str] = "re-hang"
    summary: ClassVar[str] = "The aircraft is hung up again between runs at a slightly different point"
    family: ClassVar[Family] = Family.BETWEEN_RUNS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "rigid-body modes and the attitude change from one run to the next; elastic modes hardly move"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("hook-offset", "drive-remount")
    separating_test: ClassVar[str] = "measure the attitude before every run; compare the rigid-body modes run by run"
    reference: ClassVar[str] = (
        "Carne, Griffith and Casias, Sound and Vibration 41, 2007 (support conditions for experimental modal testing)"
    )

    shift_x_m: float = parameter("m", -0.05, 0.05, "how far aft the hook moves", neutral=0.0)
    shift_y_m: float = parameter("m", -0.05, 0.05, "how far to the right the hook moves", neutral=0.0)
    from_run: int = dataclasses.field(default=2, metadata={"doc": "first run after the change, counted from 1"})

    def __post_init__(self) -> None:
        check_schedule(1.0, self.from_run)

    def act(self, scenario: Scenario, run: int) -> Action:
        """Move the hook, from the run after the change on."""
        if (self.shift_x_m == 0 and self.shift_y_m == 0) or not after(run, self.from_run):
            return NOTHING
        x, y, z = scenario.suspension.hook_m
        suspension = scenario.suspension.model_copy(update={"hook_m": (x + self.shift_x_m, y + self.shift_y_m, z)})
        return Action(scenario=scenario.model_copy(update={"suspension": suspension}))
