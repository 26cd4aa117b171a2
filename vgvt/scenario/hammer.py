"""The impact hammer: what strikes the aircraft in place of a shaker."""

from __future__ import annotations

import math

from pydantic import Field

from vgvt.scenario.base import Node, NonNegative, Positive, Switch, Table
from vgvt.scenario.instruments import NoiseSpectrum


class Hammer(Table):
    """Impact hammer with a force gauge behind its tip; used where excitation.kind is 'impact'.

    Shaker, stinger and force transducer are then off the aircraft. Each hit is a push of contact time
    pi sqrt(mass / tip stiffness), which rises and falls as a squared sine, against the point's direction.
    """

    model: str = ""
    """Make and type, in words."""
    head_mass_kg: Positive
    """Mass behind the force gauge: head, extender, and what of the handle moves along."""
    tip_mass_kg: NonNegative = 0.0
    """Mass ahead of the force gauge: the tip and its seat."""
    tip_stiffness_n_per_m: Positive
    """Contact stiffness of the tip on the surface: soft tips hit longer and lower in frequency."""
    peak_force_n: Positive
    """Peak force of a hit as strong as meant."""
    strength_scatter: NonNegative = Field(default=0.0, lt=0.5)
    """Standard deviation of the strength from hit to hit, as a fraction of it."""
    timing_scatter_s: NonNegative = 0.0
    """Each hit comes up to this much early or late."""
    double_hit_probability: NonNegative = Field(default=0.0, le=1.0)
    """How often the hammer bounces and hits again, half as hard."""
    double_hit_interval_s: Positive = 0.04
    """From a hit to the bounce."""
    nodes: tuple[Node, ...] = ()
    """Roving hammer: the node of the grid that is hit in each of acquisition.runs; left out, the drive point is."""
    sensitivity_v_per_n: Positive
    """Volts per newton at the converter."""
    calibrated: Switch = True
    """The sensitivity was found by hitting a known mass, tip on. Else the gauge lacks the inertia of the tip: it reads
    head_mass_kg / (head_mass_kg + tip_mass_kg) of the force."""
    range_n: Positive | None = None
    """Full scale of the gauge, plus and minus: more force reads as this, and marks the record as overloaded; left out,
    none does."""
    noise: NoiseSpectrum | None = None
    """The gauge's own noise, N/√Hz; left out, there is none."""

    @property
    def contact_s(self) -> float:
        """How long a hit lasts: half a period of the hammer's mass on its tip."""
        return math.pi * math.sqrt((self.head_mass_kg + self.tip_mass_kg) / self.tip_stiffness_n_per_m)

    @property
    def reading(self) -> float:
        """What the recorded force is of the force on the aircraft."""
        return 1.0 if self.calibrated else self.head_mass_kg / (self.head_mass_kg + self.tip_mass_kg)

    @property
    def first_hit_s(self) -> float:
        """From the start of a block to its hit, when it comes in time."""
        return 0.05 + self.timing_scatter_s
