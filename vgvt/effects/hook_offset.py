"""The hook is not where the scenario says: the aircraft hangs tilted and heave drags rotation along."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class HookOffset:
    """The spring's line misses the centre of gravity: the aircraft tilts until it is below, and rigid modes couple."""

    name: ClassVar[str] = "hook-offset"
    summary: ClassVar[str] = "The spring holds the aircraft at another place than stated"
    family: ClassVar[Family] = Family.SUSPENSION
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "modes below 2 Hz move and mix; elastic ones by a per cent, as the aircraft hangs tilted"
    confused_with: ClassVar[tuple[str, ...]] = ("pendulum-length", "suspension-stiffness")
    separating_test: ClassVar[str] = "put a spirit level on the hung aircraft; measure the hook with a tape"
    reference: ClassVar[str] = "Gupta, Seiler and Danowsky, AIAA 2016-1753 (hook at the centre of gravity)"

    aft_m: float = parameter("m", -0.05, 0.05, "how far aft of its stated place", neutral=0.0)
    right_m: float = parameter("m", -0.05, 0.05, "how far to the right", neutral=0.0)
    up_m: float = parameter("m", 0.0, 0.2, "how far above; more height makes pitch and roll faster", neutral=0.0)

    def act(self, scenario: Scenario, run: int) -> Action:
        """Move the hook, in every run."""
        del run
        if self.aft_m == self.right_m == self.up_m == 0:
            return NOTHING
        x, y, z = scenario.suspension.hook_m
        hook = (x + self.aft_m, y + self.right_m, z + self.up_m)
        suspension = scenario.suspension.model_copy(update={"hook_m": hook})
        return Action(scenario=scenario.model_copy(update={"suspension": suspension}))
