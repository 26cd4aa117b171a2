"""Damping that does not ask how fast: the loss per cycle of a material, alike at every frequency."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import Relaxation
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario

# Branches at a tenth of a mode's own frequency and at it, and above a dashpot, which is a branch far below its corner.
# Relative to each branch's spring: loss 10/101 + 1/2 + 1/10 and stiffness 100/101 + 1/2 at the mode's own frequency.
_CORNERS = (0.1, 1.0)
_LOSS, _STIFFENING = 10 / 101 + 0.5 + 0.1, 100 / 101 + 0.5


@dataclasses.dataclass(frozen=True, slots=True)
class HystereticDamping:
    """A loss factor η beside the scenario's viscous ratios: η/2 more damping of every mode, of another kind.

    The material is that of beams, roots and carry-through; what hangs on these keeps the damping of its own.
    No causal law in time has a constant loss factor; two Maxwell branches and a dashpot a mode keep it within
    15 % from a tenth of its frequency to three times it, and its stiffness at resonance as it was. Against as much
    viscous damping, the kind changes |H| by a quarter of η of its peak, on the flanks: 0.25 % for η = 1 %, less
    than a sensor's gain is known to. One campaign cannot identify it.
    """

    name: ClassVar[str] = "hysteretic-damping"
    summary: ClassVar[str] = "Part of the damping is a material's loss factor, the same at all frequencies"
    family: ClassVar[Family] = Family.AIRFRAME
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "more damping at resonance; its kind shows on the flanks only, by a quarter of η of the peak: unidentifiable"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("temperature-change", "viscoelastic-stiffness", "channel-delay")
    separating_test: ClassVar[str] = "none with one campaign: damping ratios of many modes against frequency, at best"
    reference: ClassVar[str] = (
        "Crandall, The role of damping in vibration theory, J. Sound Vib. 11, 1970; Ferry, 1980, chapter 3"
    )

    loss_factor: float = parameter(
        "",
        0.002,
        0.06,
        "imaginary over real part of the stiffness",
        neutral=0.0,
        scale="log",
        source="composites 0.002-0.02, wood and foam 0.01-0.06: handbook values",
    )

    def __post_init__(self) -> None:
        """ValueError for a loss that is a gain."""
        if self.loss_factor < 0:
            raise ValueError("a loss factor cannot be negative")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Put the branches beside the airframe's stiffness, in every run."""
        del run
        if self.loss_factor == 0:
            return NOTHING
        spring = self.loss_factor / _LOSS
        branches = tuple((spring, corner) for corner in _CORNERS)
        limit_hz = 2 * scenario.excitation.band_hz[1]
        return Action(elements=(Relaxation(limit_hz, branches, True, -_STIFFENING * spring, 0.1 * spring),))
