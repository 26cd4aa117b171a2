"""The cord is longer or shorter than stated, and the slow sideways swing with it."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.data import InputError
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class PendulumLength:
    """The swing goes with sqrt(g/l); l counts from the frame to the hook, spring stretch included."""

    name: ClassVar[str] = "pendulum-length"
    summary: ClassVar[str] = "Spring and cord are longer or shorter than stated"
    family: ClassVar[Family] = Family.SUSPENSION
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "the sideways swings below 1 Hz move, and the tilt that accelerometers feel there"
    confused_with: ClassVar[tuple[str, ...]] = ("hook-offset",)
    separating_test: ClassVar[str] = "measure the cord, or time ten swings by hand"
    reference: ClassVar[str] = (
        "Landau and Lifshitz, Mechanics, 3rd ed., section 5, problem 1, and section 23, problem 2 (the double pendulum)"
    )

    length_change_m: float = parameter("m", -0.4, 1.0, "change of the unloaded length", neutral=0.0)

    def act(self, scenario: Scenario, run: int) -> Action:
        """Change the cord, in every run; InputError where nothing of it is left."""
        del run
        if self.length_change_m == 0:
            return NOTHING
        length = scenario.suspension.free_length_m + self.length_change_m
        if length <= 0:
            stated = scenario.suspension.free_length_m
            raise InputError(
                "effect pendulum-length: length_change_m",
                f"is {self.length_change_m:g}, but the suspension is only {stated:g} m long",
                f"Write more than {-stated:g}.",
            )
        suspension = scenario.suspension.model_copy(update={"free_length_m": length})
        return Action(scenario=scenario.model_copy(update={"suspension": suspension}))
