"""The shaker pushes a little beside the point that the records name."""

from __future__ import annotations

import dataclasses
from functools import partial
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.shakers import chosen_shakers, moved_on_its_part, shaker_choice, with_shakers
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class DrivePointOffset:
    """The drive point lies (dx, dy) along the surface from where the scenario says; the geometry keeps the stated one.

    Residues scale mode by mode with φ(d + δ) / φ(d). The truth's drive DOF is where the force acts.
    """

    name: ClassVar[str] = "drive-point-offset"
    summary: ClassVar[str] = "The shaker pushes beside the drive point that the records name"
    family: ClassVar[Family] = Family.DRIVE_PATH
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "residues of all channels scale mode by mode with the shape at the drive point; poles stay (but for the "
        "transducer's mass, which moves along)"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("drive-remount", "channel-gain", "stinger-moment", "root-compliance")
    separating_test: ClassVar[str] = "measure the drive point with a tape; excite at a second point"
    reference: ClassVar[str] = "Ewins, Modal Testing, 2nd ed., chapter 2 (residues as products of shape entries)"

    dx_m: float = parameter("m", -0.025, 0.025, "how far aft of the stated point", neutral=0.0)
    dy_m: float = parameter("m", -0.025, 0.025, "how far to the right of the stated point", neutral=0.0)
    shaker: int = shaker_choice()

    def act(self, scenario: Scenario, run: int) -> Action:
        """Move the drive point in every run."""
        del run
        if self.dx_m == 0 and self.dy_m == 0:
            return NOTHING
        chosen = chosen_shakers(scenario, self.shaker, self.name)
        moved = partial(moved_on_its_part, scenario, dx_m=self.dx_m, dy_m=self.dy_m)
        return Action(scenario=with_shakers(scenario, chosen, moved))
