"""The transducer comes off between runs and is glued on again, not quite where it was."""

from __future__ import annotations

import dataclasses
from functools import partial
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.run_schedule import after, check_schedule
from vgvt.effects.shakers import chosen_shakers, moved_on_its_part, shaker_choice, with_shakers
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class DriveRemount:
    """From a run on the shaker pushes at another point of the surface, while the records still name the old one."""

    name: ClassVar[str] = "drive-remount"
    summary: ClassVar[str] = "The force transducer is glued on again between runs at a slightly different point"
    family: ClassVar[Family] = Family.BETWEEN_RUNS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "residues of later runs change mode by mode with the shape at the drive point; poles nearly stay"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("gain-drift", "re-hang", "drive-point-offset")
    separating_test: ClassVar[str] = "mark the drive point; keep one accelerometer where it was in every run"
    reference: ClassVar[str] = (
        "Ewins, Modal Testing, 2nd ed., chapter 3 (attachment of the shaker); residue ratio phi(d + shift) / phi(d)"
    )

    shift_x_m: float = parameter("m", -0.025, 0.025, "how far aft the drive point moves", neutral=0.0)
    shift_y_m: float = parameter("m", -0.025, 0.025, "how far to the right the drive point moves", neutral=0.0)
    from_run: int = dataclasses.field(default=2, metadata={"doc": "first run after the change, counted from 1"})
    shaker: int = shaker_choice()

    def __post_init__(self) -> None:
        check_schedule(1.0, self.from_run)

    def act(self, scenario: Scenario, run: int) -> Action:
        """Move the drive point on its part, from the run after the change on."""
        if (self.shift_x_m == 0 and self.shift_y_m == 0) or not after(run, self.from_run):
            return NOTHING
        chosen = chosen_shakers(scenario, self.shaker, self.name)
        moved = partial(moved_on_its_part, scenario, dx_m=self.shift_x_m, dy_m=self.shift_y_m)
        return Action(scenario=with_shakers(scenario, chosen, moved))
