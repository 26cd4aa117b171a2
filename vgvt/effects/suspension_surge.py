"""The suspension spring has mass: waves run along it, and it resonates at multiples of its surge frequency."""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

from vgvt.effects.acting import Turn
from vgvt.effects.action import NOTHING, Action
from vgvt.effects.elements import Absorber, Element, PointMass
from vgvt.effects.parameter import parameter
from vgvt.effects.protocol import Family
from vgvt.scenario.model import Scenario

# Six surges reach past the test band for any plausible spring; what is above acts as mass.
_SURGES = 6


@dataclasses.dataclass(frozen=True, slots=True)
class SuspensionSurge:
    """A spring of stiffness k and mass m_s loads the hook with k γ cot γ, γ = ω sqrt(m_s/k), instead of k.

    The partial fractions of that are absorbers of mass 2 m_s/(nπ)² at n f_s,
    f_s = ½ sqrt(k/m_s), beside the spring itself; those above the sixth, m_s/3 less the
    six, ride on the hook as mass. They slide along the aircraft's own vertical, which is the spring's where it hangs
    about level; sideways all of m_s/3 rides on the hook, which is right below the spring's first wave across, at
    ½ sqrt(T/(m_s L)) under a tension T at a length L: 3.8 Hz for 0.9 kg under Hati. Above it a mode whose hook moves
    sideways is off by what the waves do, up to 0.1 % there and 2.4 % on GARTEUR, whose spring is short. Of the weight
    half of m_s ought to pull a swing back: it is m_s/(12 M) of itself too slow under an aircraft of mass M. On a
    frame that gives way (frame-resonance, in either order) the spring has two moving ends: their sum drives the odd
    surges and their difference the even ones, and as much rides on the frame.
    """

    name: ClassVar[str] = "suspension-surge"
    summary: ClassVar[str] = "The suspension spring has mass and resonates along its length"
    family: ClassVar[Family] = Family.SUSPENSION
    turn: ClassVar[Turn] = Turn.IN_THE_RIG
    linear: ClassVar[bool] = True
    signature: ClassVar[str] = "lightly damped pole-zero pairs at equal spacing in frequency, in all channels and runs"
    confused_with: ClassVar[tuple[str, ...]] = ("local-absorber", "frame-resonance")
    separating_test: ClassVar[str] = "tape the coils or hang the aircraft on another spring, and repeat one run"
    reference: ClassVar[str] = (
        "Wahl, Mechanical Springs, 2nd ed. (surge of helical springs); Rao, Mechanical Vibrations (bars)"
    )

    mass_kg: float = parameter("kg", 0.1, 0.9, "mass of the spring", neutral=0.0, scale="log", least=0.0)
    loss_factor: float = parameter(
        "",
        0.001,
        0.02,
        "loss factor of the spring, twice the damping ratio of each surge",
        default=0.005,
        scale="log",
        source="steel springs with their end hooks; guess",
        least=0.0,
    )

    def act(self, scenario: Scenario, run: int) -> Action:
        """Add the surges to the hook, in every run."""
        del run
        if self.mass_kg == 0:
            return NOTHING
        hook, stiffness = scenario.suspension.hook_m, scenario.suspension.stiffness_n_per_m
        surge = math.pi * math.sqrt(stiffness / self.mass_kg)
        elements: list[Element] = []
        for n in range(1, _SURGES + 1):
            mass, omega = 2 * self.mass_kg / (n * math.pi) ** 2, n * surge
            damper = self.loss_factor * mass * omega
            # A mode of the spring with both ends held moves with one end as with the other, or against it.
            share = (-1.0) ** (n + 1)
            elements.append(
                Absorber("body", hook, mass, mass * omega**2, damper, kind="surge", owner="rig", frame_share=share)
            )
        # Faster ones are mass of both ends alike; between the ends they alternate and leave a four-hundredth of m_s.
        rest = self.mass_kg / 3 - sum(e.mass_kg for e in elements if isinstance(e, Absorber))
        return Action(elements=(*elements, PointMass("body", hook, rest, owner="rig", frame_kg=rest)))
