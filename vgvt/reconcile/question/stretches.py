"""How finely stiffness and mass may vary along a beam: as finely as its shortest wave within the band feels."""

from __future__ import annotations

import math

import numpy as np

from vgvt.reconcile.question.uncertain import long_beams
from vgvt.scenario.airframe import Beam
from vgvt.scenario.axis import beam_axis
from vgvt.scenario.model import Scenario
from vgvt.scenario.tolerances import LEAST_SEGMENTS, MOST_SEGMENTS

_POINTS = 200


def with_stretches(scenario: Scenario, highest_hz: float) -> Scenario:
    """The scenario with the ``segments`` of its tolerances stated; where they are, as it is."""
    if scenario.tolerances.segments is not None:
        return scenario
    tolerances = scenario.tolerances.model_copy(update={"segments": stations_for(scenario, highest_hz)})
    return scenario.model_copy(update={"tolerances": tolerances})


def stations_for(scenario: Scenario, highest_hz: float) -> int:
    """How many stations a band up to some frequency asks for, whatever the scenario states.

    A mode's strain and kinetic energy come and go along a beam once in half a wave, so that two stretches in each
    half-wave tell what it can feel of a scatter, and fewer leave of it what looks like an effect: on a uniform beam
    with six modes in the band and no noise, four stations a side leave up to ten times of what six do.
    """
    beams = [beam for beam in scenario.airframe.beam if beam.name in long_beams(scenario)]
    shortest = max((half_waves(beam, highest_hz) for beam in beams), default=0.0)
    return min(max(LEAST_SEGMENTS, 1 + math.ceil(2 * shortest)), MOST_SEGMENTS)


def half_waves(beam: Beam, frequency_hz: float) -> float:
    """Half-waves on one side of a beam at a frequency, of bending or of torsion, whichever are more.

    Phase of a wave that travels along it (WKB): the integral of (m omega^2 / EI)^(1/4) or omega (I / GJ)^(1/2) over pi.
    A cantilever's nth bending mode has n - 1/2 of them. Air moves with a section, and offsets turn about the axis.
    """
    axis, stations, omega = beam_axis(beam), beam.stations, 2 * np.pi * frequency_hz
    arc = np.linspace(0.0, axis.arc_length_m[-1], _POINTS)

    def along(name: str) -> np.ndarray:
        column = getattr(stations, name)
        return np.zeros(_POINTS) if column is None else np.asarray(np.interp(arc, axis.arc_length_m, column))

    mass, air = along("mass_kg_per_m"), along("air_kg_per_m")
    turned = along("pitch_inertia_kg_m") + mass * along("cg_offset_m") ** 2
    turned += along("air_pitch_inertia_kg_m") + air * along("air_offset_m") ** 2
    bending = ((mass + air) * omega**2 / along("bending_stiffness_n_m2")) ** 0.25
    torsion = omega * np.sqrt(turned / along("torsional_stiffness_n_m2"))
    return max(float(np.trapezoid(number, arc)) for number in (bending, torsion)) / math.pi
