"""Base strain: a force gauge that also reads the moment the stinger puts through it."""

from __future__ import annotations

import dataclasses
from typing import ClassVar, Literal

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import RotationSpring
from vgvt.effects.equivalent_damper import equivalent_damper
from vgvt.effects.parameter import parameter, require_above_zero
from vgvt.effects.protocol import Family
from vgvt.effects.shakers import chosen_shakers, shaker_choice
from vgvt.effects.stinger_moment import require_body_drive
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class BaseStrain:
    """The gauge reads F + s M, with M = -k θ - c θ' the moment of a stinger that resists rotation about one axis.

    The moment path is its own, so that the effect stands alone and is gone with it: where nothing resists, nothing is
    read. For a drive point on the centre body only. The moment path stiffens the aircraft as a stinger's does, and
    what is read by mistake is divided out of A/F: that has its poles where F + s M is zero, which are not the
    aircraft's. They move with the sign of s, by as much as the drive point's rotation has to do with a mode.
    """

    name: ClassVar[str] = "base-strain"
    summary: ClassVar[str] = "The force gauge reads part of the stinger's bending moment as force"
    family: ClassVar[Family] = Family.DRIVE_PATH
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "one factor on all channels of A/F, coherent with the rotation of the drive point; it moves the poles of A/F, "
        "up or down with the sign of s, while those of A per command stay"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("stinger-moment", "transducer-mass", "drive-point-offset")
    separating_test: ClassVar[str] = "turn the gauge by 90 degrees about its own axis"
    reference: ClassVar[str] = (
        "Ewins, Modal Testing, 2nd ed., chapter 3 (force transducers: cross sensitivity to moments)"
    )

    apparent_force_per_moment_per_m: float = parameter(
        "1/m", -20.0, 20.0, "apparent force s per bending moment, N per N m", default=10.0
    )
    rotational_stiffness_n_m_per_rad: float = parameter(
        "N m/rad", 0.5, 30.0, "stiffness of what holds the drive point", neutral=0.0, scale="log", least=0.0
    )
    loss_factor: float = parameter(
        "", 0.01, 0.5, "loss factor of the moment path", default=0.05, scale="log", least=0.0
    )
    frequency_hz: float = parameter(
        "Hz", 1.0, 35.0, "where the damper has that loss factor", default=10.0, scale="log", least=0.0
    )
    axis: Literal["roll", "pitch"] = dataclasses.field(default="pitch", metadata={"doc": "'roll' or 'pitch'"})
    shaker: int = shaker_choice()

    def __post_init__(self) -> None:
        """ValueError for a damper at no frequency."""
        require_above_zero(self, "frequency_hz")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the moment path and let the gauge feel it, in every run; InputError for a drive point on a beam."""
        del run
        if self.rotational_stiffness_n_m_per_rad == 0:
            return NOTHING
        chosen = chosen_shakers(scenario, self.shaker, self.name)
        require_body_drive(scenario, chosen, self.name)
        stiffness = self.rotational_stiffness_n_m_per_rad
        damping = equivalent_damper(stiffness, self.loss_factor, self.frequency_hz)
        felt = self.apparent_force_per_moment_per_m
        springs = (RotationSpring(self.axis, stiffness, damping, gauge_per_m=felt, exciter=k) for k in chosen)
        return Action(elements=tuple(springs))
