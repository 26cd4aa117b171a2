"""Hot glue or clay between the force gauge and the aircraft gives a little, and loses energy."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.data import InputError
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import MountCompliance as Mount
from vgvt.effects.equivalent_damper import equivalent_damper
from vgvt.effects.parameter import parameter, require_above_zero
from vgvt.effects.protocol import Family
from vgvt.effects.shakers import chosen_shakers, shaker_choice
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class MountCompliance:
    """Spring and dashpot along the push between gauge and structure.

    The mount is in the force's path: A/F sees it only through the end mass of the gauge that rides on it.
    """

    name: ClassVar[str] = "mount-compliance"
    summary: ClassVar[str] = "The glue or clay that holds the force gauge to the aircraft gives"
    family: ClassVar[Family] = Family.MOUNT
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "almost none in A/F; force per command and the drive point's own motion change"
    confused_with: ClassVar[tuple[str, ...]] = ("stinger-compliance", "stinger-moment", "gain-drift")
    separating_test: ClassVar[str] = "accelerometers on both sides of the mount; repeat a run with another mount"
    reference: ClassVar[str] = "Ewins, Modal Testing, 2nd ed., chapter 3"

    compliance_m_per_n: float = parameter(
        "m/N",
        2e-7,
        2.5e-4,
        "axial compliance of the mount",
        neutral=0.0,
        scale="log",
        source="hot glue 1-6 MN/m, modelling clay 4-80 kN/m, 13 mm across: estimates from modulus and thickness",
    )
    loss_factor: float = parameter(
        "", 0.05, 1.0, "loss factor: glue 0.05-0.2, clay 0.3-1", default=0.1, scale="log", least=0.0
    )
    frequency_hz: float = parameter(
        "Hz", 1.0, 35.0, "where the damper has that loss factor", default=10.0, scale="log", least=0.0
    )
    shaker: int = shaker_choice()

    def __post_init__(self) -> None:
        """ValueError for a damper at no frequency."""
        require_above_zero(self, "frequency_hz")

    def act(self, scenario: Scenario, run: int) -> Action:
        """Put the mount under the gauge, in every run; InputError where nothing of the gauge rides on it."""
        del run
        if self.compliance_m_per_n == 0:
            return NOTHING
        if scenario.transducer.end_mass_kg == 0:
            raise InputError(
                f"scenario {scenario.name}: effect {self.name}",
                "the transducer has no mass on the structure's side to ride on the mount",
                "Give transducer.end_mass_kg a value: a few grams for a small gauge.",
            )
        stiffness = 1 / self.compliance_m_per_n
        damper = equivalent_damper(stiffness, self.loss_factor, self.frequency_hz)
        chosen = chosen_shakers(scenario, self.shaker, self.name)
        return Action(elements=tuple(Mount(stiffness, damper, exciter=k) for k in chosen))
