"""The rig: suspension, shaker, stinger and excitation signal."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from vgvt.scenario.base import MisfitError, NonNegative, Point, Positive, Table, Whole


class Suspension(Table):
    """One soft spring from a fixed frame to a hook on the aircraft."""

    stiffness_n_per_m: Positive = 130.0
    damping_n_s_per_m: NonNegative = 0.4
    hook_m: Point
    """Where the spring holds the aircraft, aircraft axes."""
    free_length_m: Positive = 0.8
    """Length of spring and cord without load; with the sag it sets the pendulum frequency."""
    yaw_stiffness_n_m_per_rad: Positive = 0.05
    """Twist stiffness of spring and cord: keeps the aircraft from turning away."""
    rotation_damping_n_m_s_per_rad: Positive = 0.02
    """Air and hook friction on roll, pitch and yaw of the whole aircraft."""
    pendulum_damping_n_s_per_m: Positive = 0.1
    """Air drag on the slow sideways swing of the whole aircraft."""


class Shaker(Table):
    """Electrodynamic shaker: m x'' + c x' + k x = Bl i - F and V = R i + L di/dt + Bl x'."""

    model: str = ""
    node: Whole = Field(default=100, ge=0)
    """Node number of the drive point in the campaign's geometry."""
    position_m: Point
    """Drive point on the aircraft, aircraft axes; the shaker stands below it and pushes along +z."""
    attached_to: str = "body"
    """'body' or the name of a beam (then on the nearest link)."""
    drive: Literal["voltage", "current"] = "voltage"
    """What the amplifier controls. Voltage drive damps the coupled system by Bl^2/R, current drive does not."""
    amplifier_gain: Positive = 1.0
    """Volts (voltage drive) or amperes (current drive) at the coil per volt of command."""
    coil_resistance_ohm: Positive
    coil_inductance_h: NonNegative = 0.0
    force_factor_n_per_a: Positive
    """Bl."""
    armature_mass_kg: Positive
    flexure_stiffness_n_per_m: NonNegative
    flexure_damping_n_s_per_m: NonNegative

    @model_validator(mode="after")
    def _inductance_fits_the_armature(self) -> Self:
        # The inductance's mechanical equivalent borrows this much of the armature (vgvt.simulation.rig).
        borrowed_kg = self.coil_inductance_h * (0.5 * self.force_factor_n_per_a / self.coil_resistance_ohm) ** 2
        if self.drive == "voltage" and borrowed_kg >= 0.9 * self.armature_mass_kg:
            raise MisfitError(
                ("coil_inductance_h",),
                f"is {self.coil_inductance_h:g} H, too much for Bl, R and this armature: L (Bl / 2R)^2 is "
                f"{borrowed_kg:.2g} kg and must stay below 0.9 of armature_mass_kg",
                "Write the inductance in henry: 0.6 mH is 6e-4.",
            )
        return self


class Stinger(Table):
    """The rod between armature and force transducer: axial only; lateral stiffness is an effect."""

    axial_stiffness_n_per_m: Positive
    axial_damping_n_s_per_m: NonNegative = 0.0
    length_m: Positive = 0.2
    mass_kg: NonNegative = 0.0
    """Half rides on the armature, half on the transducer."""


class Excitation(Table):
    """The command sent to the amplifier in every run."""

    kind: Literal["linear-chirp"] = "linear-chirp"
    """Shape of the command; a linear chirp passes every frequency at the same rate."""
    start_hz: NonNegative
    stop_hz: Positive
    duration_s: Positive
    """Length of the sweep."""
    amplitude_v: Positive = 1.0
    lead_in_s: NonNegative = 0.0
    """Silence before the sweep, inside the record."""
    ring_down_s: NonNegative = 0.0
    """Silence after the sweep, inside the record."""
    taper_s: NonNegative = 0.0
    """Cosine rise and fall at both ends of the sweep."""

    @model_validator(mode="after")
    def _sweep_goes_somewhere(self) -> Self:
        if self.start_hz == self.stop_hz:
            raise MisfitError(("stop_hz",), f"is {self.stop_hz:g} like start_hz", "A sweep needs two frequencies.")
        if 2 * self.taper_s > self.duration_s:
            raise MisfitError(
                ("taper_s",),
                f"is {self.taper_s:g}, more than half of duration_s {self.duration_s:g}",
                "Shorten it; it is there twice, at the rise and at the fall.",
            )
        return self

    @property
    def record_s(self) -> float:
        """Length of the record: lead-in, sweep and ring-down."""
        return self.lead_in_s + self.duration_s + self.ring_down_s

    @property
    def band_hz(self) -> tuple[float, float]:
        """The swept band, low to high."""
        return (min(self.start_hz, self.stop_hz), max(self.start_hz, self.stop_hz))
