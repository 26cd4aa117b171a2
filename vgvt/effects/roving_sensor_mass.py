"""Accelerometers heavier than stated, mostly by the cable that moves along: their mass roves with them."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

from vgvt.effects.action import NOTHING, Action
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario


@dataclasses.dataclass(frozen=True, slots=True)
class RovingSensorMass:
    """Every accelerometer carries more mass from point to point: Δω/ω = -φ² m / (2 m_r) in the runs where it sits."""

    name: ClassVar[str] = "roving-sensor-mass"
    summary: ClassVar[str] = "The roving accelerometers and their cables weigh more than stated"
    family: ClassVar[Family] = Family.SENSORS
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "poles differ from run to run with the sensors' places, most when they sit near the tips"
    confused_with: ClassVar[tuple[str, ...]] = ("run-drift", "temperature-change", "payload-change", "cable-drag")
    separating_test: ClassVar[str] = "dummy masses on all other points; repeat the first run at the end"
    reference: ClassVar[str] = (
        "Ewins, Modal Testing, 2nd ed., chapter 3 (transducer loading); shift by Rayleigh's quotient"
    )

    mass_kg: float = parameter(
        "kg",
        0.0005,
        0.02,
        "mass of one sensor beyond what the scenario states",
        neutral=0.0,
        scale="log",
        source="PCB 353B16: 1.5 g; coaxial cable about 10 g a metre, of which some decimetres move: estimate",
    )

    def act(self, scenario: Scenario, run: int) -> Action:
        """Make the accelerometers heavier; they rove by themselves."""
        del run
        if self.mass_kg == 0:
            return NOTHING
        sensors = scenario.accelerometers
        heavier = sensors.model_copy(update={"mass_kg": sensors.mass_kg + self.mass_kg})
        return Action(scenario=scenario.model_copy(update={"accelerometers": heavier}))
