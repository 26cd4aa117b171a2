"""The stinger's bending stiffness: it pushes back when the drive point turns, and no channel measures that."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.data import InputError
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import RotationSpring
from vgvt.effects.equivalent_damper import equivalent_damper
from vgvt.effects.parameter import parameter, require_above_zero
from vgvt.effects.protocol import Family
from vgvt.effects.shakers import chosen_shakers, shaker_choice
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class StingerMoment:
    """Springs to the ground on roll and pitch of the drive point; for a drive point on the centre body only.

    A rod clamped at both ends has 4 E I / L about either axis. It is at rest as the aircraft hangs.
    """

    name: ClassVar[str] = "stinger-moment"
    summary: ClassVar[str] = "The stinger resists rotation of the drive point with an unmeasured moment"
    family: ClassVar[Family] = Family.DRIVE_PATH
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = (
        "modes that turn the drive point stiffen, rigid pitch and roll most of all; zeros of all channels move together"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("base-strain", "drive-point-offset", "hook-offset", "mount-compliance")
    separating_test: ClassVar[str] = "a longer or thinner stinger; a drive point that does not turn"
    reference: ClassVar[str] = (
        "Hieber, Non-toxic stingers, Proc. 6th IMAC, 1988; Ewins, Modal Testing, 2nd ed., chapter 3 (drive rods)"
    )

    rotational_stiffness_n_m_per_rad: float = parameter(
        "N m/rad",
        0.5,
        30.0,
        "stiffness about either axis of what holds the drive point",
        neutral=0.0,
        scale="log",
        source="clay 0.04-0.8, hot glue 10-60, steel rod of 4.6 mm 4EI/L = 84 N m/rad: estimates, in series",
        least=0.0,
    )
    loss_factor: float = parameter(
        "", 0.01, 0.5, "loss factor of the moment path", default=0.05, scale="log", least=0.0
    )
    frequency_hz: float = parameter(
        "Hz", 1.0, 35.0, "where the damper has that loss factor", default=10.0, scale="log", least=0.0
    )
    shaker: int = shaker_choice()

    def __post_init__(self) -> None:
        """ValueError for a damper at no frequency."""
        require_above_zero(self, "frequency_hz")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Hold roll and pitch of the centre body, in every run; InputError for a drive point on a beam."""
        del run
        if self.rotational_stiffness_n_m_per_rad == 0:
            return NOTHING
        chosen = chosen_shakers(scenario, self.shaker, self.name)
        require_body_drive(scenario, chosen, self.name)
        stiffness = self.rotational_stiffness_n_m_per_rad
        damping = equivalent_damper(stiffness, self.loss_factor, self.frequency_hz)
        return Action(
            elements=tuple(
                RotationSpring(axis, stiffness, damping, exciter=k) for k in chosen for axis in ("roll", "pitch")
            )
        )


def require_body_drive(scenario: Scenario, chosen: tuple[int, ...], effect: str) -> None:
    """InputError unless these shakers push on the centre body, whose rotation is a coordinate of the model."""
    for k in chosen:
        part = scenario.shakers[k].attached_to
        if part != "body":
            raise InputError(
                f"scenario {scenario.name}: effect {effect}",
                f"the shaker is attached to {part!r}, and a moment can only be put on the centre body",
                "Drive the aircraft at its body, choose a shaker that does, or leave the effect out.",
            )
