"""A mount that holds in compression and gives when pulled: clay that lifts off, a stud that is not tight."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.data import InputError
from vgvt.effects.acting import Turn
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import MountCompliance as Mount
from vgvt.effects.equivalent_damper import equivalent_damper
from vgvt.effects.parameter import parameter, require_above_zero
from vgvt.effects.protocol import Family
from vgvt.effects.shakers import chosen_shakers, shaker_choice
from vgvt.scenario.model import Scenario

_GRAVITY_M_PER_S2 = 9.80665


@dataclasses.dataclass(frozen=True, slots=True)
class MountLiftOff:
    """The mount pushes with stiffness k, and with (1 - loss) k where it is pulled by more than its preload.

    A bilinear spring between gauge and structure; what hangs on the mount is carried without lifting it off, and the
    preload comes on top. The truth is linear about rest, on the stiff side.
    """

    name: ClassVar[str] = "mount-lift-off"
    summary: ClassVar[str] = "The force gauge's mount is softer in tension than in compression"
    family: ClassVar[Family] = Family.MOUNT
    turn: ClassVar[Turn] = Turn.IN_THE_RIG
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = (
        "even harmonics in force and response, in the ratio of the FRF; A/F stays, force over command depends on level"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("force-distortion", "mount-compliance")
    separating_test: ClassVar[str] = "press the shaker against the aircraft: with preload the even harmonics go"
    reference: ClassVar[str] = (
        "Shaw and Holmes, A periodically forced piecewise linear oscillator, J. Sound Vib. 90, 1983"
    )

    stiffness_loss: float = parameter("", 0.05, 0.9, "fraction of the stiffness that is lost in tension", neutral=0.0)
    compliance_m_per_n: float = parameter(
        "m/N",
        5e-5,
        2.5e-4,
        "axial compliance in compression",
        default=1e-4,
        scale="log",
        source="clay, as mount-compliance",
    )
    preload_n: float = parameter(
        "N", 0.5, 10.0, "pull, beyond the weight, at which the mount starts to lift off", default=0.5, scale="log"
    )
    loss_factor: float = parameter("", 0.05, 1.0, "loss factor in compression", default=0.3, scale="log", least=0.0)
    frequency_hz: float = parameter(
        "Hz", 1.0, 35.0, "where the damper has that loss factor", default=10.0, scale="log", least=0.0
    )
    shaker: int = shaker_choice()

    def __post_init__(self) -> None:
        """ValueError for a mount that cannot hold the gauge."""
        require_above_zero(self, "frequency_hz")
        if not 0 <= self.stiffness_loss < 1:
            raise ValueError("stiffness_loss must be from 0 to below 1")
        # The linear truth is a difference over 20 µm: it must not reach the point where the mount lifts off.
        if not self.compliance_m_per_n > 0 or not self.preload_n * self.compliance_m_per_n > 1.5e-5:
            raise ValueError("the preload must press the mount in by 15 µm or more")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Put the mount under the gauge, in every run; InputError where nothing of the gauge rides on it."""
        del run
        if self.stiffness_loss == 0:
            return NOTHING
        if scenario.transducer.end_mass_kg == 0:
            raise InputError(
                f"scenario {scenario.name}: effect {self.name}",
                "the transducer has no mass on the structure's side to ride on the mount",
                "Give transducer.end_mass_kg a value: a few grams for a small gauge.",
            )
        stiffness = 1 / self.compliance_m_per_n
        damper = equivalent_damper(stiffness, self.loss_factor, self.frequency_hz)
        weight_n = _GRAVITY_M_PER_S2 * (scenario.transducer.mass_kg + 0.5 * scenario.stinger.mass_kg)
        ratio, preload_n = 1 - self.stiffness_loss, weight_n + self.preload_n
        chosen = chosen_shakers(scenario, self.shaker, self.name)
        return Action(elements=tuple(Mount(stiffness, damper, ratio, preload_n, exciter=k) for k in chosen))
