"""Stiffness that grows with frequency: foam cores, plastics, glue lines."""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import Relaxation
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class ViscoelasticStiffness:
    """EI and GJ times 1 + (rise/3) Σ jωτ/(1 + jωτ): three Maxwell branches, corners evenly spaced in log f.

    The stated stiffness is that at rest; far above the corners it is 1 + rise times as much. In between it
    grows with log f, and the loss that goes with it comes on top of the scenario's damping. Roots, carry-through and
    couplings relax alike; springs of what hangs on the airframe, or ties two places of it, do not.
    """

    name: ClassVar[str] = "viscoelastic-stiffness"
    summary: ClassVar[str] = "The airframe gets stiffer the faster it moves"
    family: ClassVar[Family] = Family.AIRFRAME
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "every mode fits another EI, the higher the mode the stiffer, with more damping between the corners; "
        "static tests read softer than the first mode"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("root-compliance", "added-mass", "hysteretic-damping")
    separating_test: ClassVar[str] = "a static load test beside the modes; the same modes at another temperature"
    reference: ClassVar[str] = (
        "Ferry, Viscoelastic Properties of Polymers, 3rd ed., 1980, chapter 3 (Maxwell elements in parallel)"
    )

    rise: float = parameter(
        "", 0.05, 0.3, "stiffness far above the corners over that at rest, less one", neutral=0.0, scale="log"
    )
    low_hz: float = parameter("Hz", 0.1, 5.0, "lowest corner", default=1.0, scale="log")
    high_hz: float = parameter("Hz", 20.0, 200.0, "highest corner", default=100.0, scale="log")

    def __post_init__(self) -> None:
        """ValueError for a spectrum that is none."""
        if not 0 < self.low_hz < self.high_hz:
            raise ValueError("low_hz must be above 0 and below high_hz")
        if self.rise < 0:
            raise ValueError("no passive material gets softer the faster it moves: rise cannot be negative")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Put the branches beside the airframe's stiffness, in every run."""
        del run
        if self.rise == 0:
            return NOTHING
        corners = (self.low_hz, math.sqrt(self.low_hz * self.high_hz), self.high_hz)
        branches = tuple((self.rise / 3, corner) for corner in corners)
        return Action(elements=(Relaxation(2 * scenario.excitation.band_hz[1], branches),))
