"""Backlash in the drive path: a loose thread, a worn cap or a ball joint between shaker and aircraft."""

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
class ShakerBacklash:
    """The drive path pushes with stiffness k; pulled by more than its preload it gives way by the gap, then holds.

    The preload is that of a thread's friction or a rubber band round the joint: it stays while the joint crosses the
    gap. What hangs on the joint is carried without opening it. Its damper acts in the gap too. The truth is
    linear about rest, in contact.
    """

    name: ClassVar[str] = "shaker-backlash"
    summary: ClassVar[str] = "The drive path between shaker and aircraft has play"
    family: ClassVar[Family] = Family.DRIVE_PATH
    turn: ClassVar[Turn] = Turn.IN_THE_RIG
    linear: ClassVar[bool] = False
    signature: ClassVar[str] = (
        "flat spots and knocks in the force, harmonics of all orders in force and response in the ratio of the FRF; "
        "A/F stays, force over command falls with level once the preload is passed"
    )
    confused_with: ClassVar[tuple[str, ...]] = ("mount-lift-off", "force-distortion", "rattling-mass")
    separating_test: ClassVar[str] = "tighten the joint, or press the shaker against the aircraft: the knocks go"
    reference: ClassVar[str] = (
        "Comparin and Singh, Non-linear frequency response characteristics of an impact pair, J. Sound Vib. 134, 1989"
    )

    gap_m: float = parameter("m", 1e-5, 1e-3, "how far the joint gives way", neutral=0.0, scale="log")
    compliance_m_per_n: float = parameter(
        "m/N", 5e-5, 2.5e-4, "axial compliance of the joint in contact", default=1e-4, scale="log"
    )
    preload_n: float = parameter(
        "N", 0.5, 10.0, "pull, beyond the weight, at which the joint opens", default=0.5, scale="log"
    )
    loss_factor: float = parameter("", 0.05, 1.0, "loss factor in contact", default=0.3, scale="log", least=0.0)
    frequency_hz: float = parameter(
        "Hz", 1.0, 35.0, "where the damper has that loss factor", default=10.0, scale="log", least=0.0
    )
    shaker: int = shaker_choice()

    def __post_init__(self) -> None:
        """ValueError for a joint that is none."""
        require_above_zero(self, "frequency_hz")
        if self.gap_m < 0:
            raise ValueError("gap_m cannot be negative")
        # The linear truth is a difference over 20 µm: it must not reach the point where the joint opens.
        if not self.compliance_m_per_n > 0 or not self.preload_n * self.compliance_m_per_n > 1.5e-5:
            raise ValueError("the preload must press the joint together by 15 µm or more")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Put the joint under the gauge, in every run; InputError where nothing of the gauge rides on it."""
        del run
        if self.gap_m == 0:
            return NOTHING
        if scenario.transducer.end_mass_kg == 0:
            raise InputError(
                f"scenario {scenario.name}: effect {self.name}",
                "the transducer has no mass on the structure's side to ride on the joint",
                "Give transducer.end_mass_kg a value: a few grams for a small gauge.",
            )
        stiffness = 1 / self.compliance_m_per_n
        damper = equivalent_damper(stiffness, self.loss_factor, self.frequency_hz)
        preload_n = self.preload_n + _GRAVITY_M_PER_S2 * (scenario.transducer.mass_kg + 0.5 * scenario.stinger.mass_kg)
        chosen = chosen_shakers(scenario, self.shaker, self.name)
        joints = (Mount(stiffness, damper, preload_n=preload_n, gap_m=self.gap_m, exciter=k) for k in chosen)
        return Action(elements=tuple(joints))
