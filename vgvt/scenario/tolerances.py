"""What a scenario does not know exactly: standard deviations that a calibration may use, and no more."""

from __future__ import annotations

from pydantic import Field

from vgvt.scenario.base import NonNegative, Table, Whole

LEAST_SEGMENTS, MOST_SEGMENTS = 4, 12
"""Bounds of how many ``segments`` the band may ask for; a file may say fewer."""


class Tolerances(Table):
    """Standard deviations of what the scenario states; reconcile calibrates within them.

    The defaults are engineering judgement for a small composite aircraft and a careful lab. A
    relative one is a fraction of the stated value; 0 means known exactly.
    """

    stiffness_scale: NonNegative = 0.10
    """EI and GJ of a whole beam, each, relative; both sides alike."""
    stiffness_segment: NonNegative = 0.015
    """EI and GJ along each side of a beam around that scale, relative."""
    mass_segment: NonNegative = 0.01
    """Mass per length along each side of a beam, relative."""
    segments: Whole | None = Field(default=None, ge=0, le=MOST_SEGMENTS)
    """Stations of a long beam's side at which its stiffness and mass vary on their own; left out, two for each
    half-wave of the shortest wave in the band and one, 4 at least."""
    body_mass: NonNegative = 0.01
    """Mass of the centre body, relative."""
    body_centre_of_gravity_m: NonNegative = 0.003
    """Centre of gravity of the centre body, fore and aft."""
    inertia: NonNegative = 0.12
    """Inertias of the centre body and pitch inertia along the beams, relative."""
    item_mass: NonNegative = 0.02
    """Mass of each lumped item, relative."""
    damping: NonNegative = 0.30
    """Each stated damping ratio, relative."""
    drive_point_m: NonNegative = 0.005
    """Drive point, fore and aft and sideways, each."""
    hook_m: NonNegative = 0.005
    """Hook, in each direction."""
    suspension_stiffness: NonNegative = 0.05
    """Spring, relative."""
    suspension_damping: NonNegative = 0.5
    """Dampers of the suspension, relative, all alike."""
    transducer_end_mass: NonNegative = 0.10
    """Mass between sensing element and structure, relative."""
    sensor_mass: NonNegative = 0.05
    """Mass of an accelerometer with its cable, relative, all alike."""
    gain: NonNegative = 0.01
    """Sensitivity of the force gauge, and of each accelerometer, relative."""
    channel_gain: NonNegative = 0.003
    """Scatter of each channel in each run around that, relative."""
    high_pass: NonNegative = 0.10
    """Corner frequencies of AC coupling, relative."""
    model_form: NonNegative = 0.004
    """What discretisation leaves of each response function, relative; judged with the noise, not calibrated."""

    @property
    def stations(self) -> int:
        """The segments as stated; where nothing is, and no band is known, the fewest that a band may ask for."""
        return LEAST_SEGMENTS if self.segments is None else self.segments
