"""Sensor cables that hang to the floor: a soft spring and a dashpot at every accelerometer of a run."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import GroundSpring
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.effects.sensor_choice import CHOICES, chosen_sensors
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class CableDrag:
    """Spring and dashpot from each accelerometer of the run to the ground, at rest as hung.

    A cable hangs from its accelerometer, wherever other effects put that.
    To first order a pole moves by Δω = φ² k / (2 ω m_r) and its damping by Δζ = φ² c / (2 ω m_r).
    """

    name: ClassVar[str] = "cable-drag"
    summary: ClassVar[str] = "The accelerometers' cables hold back the points where they are in that run"
    family: ClassVar[Family] = Family.SENSORS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "frequencies and damping depend on the run, lopsidedly if the cables leave on one side"
    confused_with: ClassVar[tuple[str, ...]] = ("run-drift", "roving-sensor-mass", "nonproportional-damper")
    separating_test: ClassVar[str] = "re-route or suspend the cables and repeat a run with the sensors at a tip"
    reference: ClassVar[str] = "Ewins, Modal Testing, 2nd ed., chapter 3 (cables); shift by Rayleigh's quotient"

    stiffness_n_per_m: float = parameter(
        "N/m", 1.0, 50.0, "stiffness of one cable", neutral=0.0, scale="log", least=0.0
    )
    damping_n_s_per_m: float = parameter(
        "N s/m", 0.01, 0.5, "dashpot of one cable", neutral=0.0, scale="log", least=0.0
    )
    sensors: str = dataclasses.field(default="response", metadata={"doc": CHOICES})

    def act(self, scenario: Scenario, run: int) -> Action:
        """Tie the run's accelerometers to the ground."""
        if self.stiffness_n_per_m == 0 and self.damping_n_s_per_m == 0:
            return NOTHING
        where = chosen_sensors(scenario, run, self.sensors, self.name)
        stiffness, damping = self.stiffness_n_per_m, self.damping_n_s_per_m
        return Action(
            elements=tuple(GroundSpring(p.part, p.position_m, stiffness, damping, node=p.dof.node) for p in where)
        )
