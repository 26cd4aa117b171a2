"""A lab that differs from its scenario as far as the tolerances allow, and no further: the blind half of the study.

Draws the true aircraft, rig and instruments; what it draws, nobody tells the analysis. Its parametrisation is its
own: piecewise-linear factors along each side at stations that are not those of the analysis.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, ChannelRole, Record
from vgvt.effects.beams import with_airframe, written_out
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.airframe import Beam
from vgvt.scenario.axis import beam_axis

Array = NDArray[np.float64]
# Nature has no cells: the truth has many more than the analysis, and other stretches of stiffness.
ANALYSIS_CELLS, TRUE_CELLS, STRETCHES = 12, 60, 5
# As many as can still be stepped in time at the study's sample rate; with 16 or 20 their coarseness alone is seen.
STEPPED_CELLS = 24
RUNS = ((1, 6, 13, 18), (3, 8, 11, 20), (5, 10, 15, 16), (2, 9, 14, 17), (4, 7, 12, 19))
RATE_HZ, SWEEP_S = 250.0, 14.0


def nominal() -> Scenario:
    """The scenario of the study: Hati, five runs of four roving sensors, one short sweep, few cells."""
    scenario = load_scenario("hati-unsymmetric")
    beams = tuple(beam.model_copy(update={"cells": ANALYSIS_CELLS}) for beam in scenario.airframe.beam)
    sweep = {"start_hz": 3.0, "stop_hz": 35.0, "duration_s": SWEEP_S, "ring_down_s": 3.0}
    return scenario.model_copy(
        update={
            "name": "closing-the-loop",
            # Modes just above the band shape its end: their damping must be what is stated, too.
            "airframe": scenario.airframe.model_copy(
                update={"beam": beams, "damping": scenario.airframe.damping.model_copy(update={"limit_hz": 60.0})}
            ),
            "acquisition": scenario.acquisition.model_copy(update={"sample_rate_hz": RATE_HZ, "runs": RUNS}),
            "excitation": scenario.excitation.model_copy(update=sweep),
        }
    )


def drawn(scenario: Scenario, generator: np.random.Generator, cells: int = TRUE_CELLS) -> Scenario:
    """An aircraft and a rig that the tolerances allow, without instruments' errors."""
    t, g = scenario.tolerances, generator

    def factor(sd: float) -> float:
        return float(np.exp(sd * g.standard_normal()))

    split = written_out(scenario)
    common = {
        "bending_stiffness_n_m2": factor(t.stiffness_scale),
        "torsional_stiffness_n_m2": factor(t.stiffness_scale),
    }
    common["pitch_inertia_kg_m"] = factor(t.inertia)
    scatter = {"bending_stiffness_n_m2": t.stiffness_segment, "torsional_stiffness_n_m2": t.stiffness_segment}
    scatter["mass_kg_per_m"] = t.mass_segment
    beams = tuple(_beam(b, common, scatter, g).model_copy(update={"cells": cells}) for b in split.airframe.beam)
    items, known = [], {}
    for item in split.airframe.item:
        share = known.setdefault(item.name.removesuffix("-right").removesuffix("-left"), factor(t.item_mass))
        items.append(item.model_copy(update={"mass_kg": item.mass_kg * share}))
    body, damping = split.airframe.body, split.airframe.damping
    x, y, z = body.centre_of_gravity_m
    roll, pitch, _ = (v * factor(t.inertia) for v in body.inertia_kg_m2)
    true_body = body.model_copy(
        update={
            "mass_kg": body.mass_kg * factor(t.body_mass),
            "centre_of_gravity_m": (x + t.body_centre_of_gravity_m * g.standard_normal(), y, z),
            # A flat body stays one.
            "inertia_kg_m2": (roll, pitch, roll + pitch),
        }
    )
    true_damping = damping.model_copy(
        update={
            "damping_ratio": damping.damping_ratio * factor(t.damping),
            "modal": tuple(ratio * factor(t.damping) for ratio in damping.modal),
        }
    )
    return _rig(with_airframe(split, beam=beams, item=tuple(items), body=true_body, damping=true_damping), g)


def _beam(beam: Beam, common: dict[str, float], scatter: dict[str, float], g: np.random.Generator) -> Beam:
    """A side with its stiffness and mass scattered along it around a common factor."""
    axis = beam_axis(beam)
    knots = np.linspace(0, axis.arc_length_m[-1], STRETCHES)
    arcs = np.union1d(axis.arc_length_m, knots)
    arcs = arcs[np.concatenate([[True], np.diff(arcs) > 1e-6])]
    columns: dict[str, object] = {}
    for name in type(beam.stations).model_fields:
        values = getattr(beam.stations, name)
        if name == "position_m":
            points = [np.interp(arcs, axis.arc_length_m, axis.position_m[:, k]) for k in range(3)]
            columns[name] = tuple(tuple(float(v) for v in p) for p in np.array(points).T)
        elif values is not None:
            here = np.interp(arcs, axis.arc_length_m, values) * common.get(name, 1.0)
            if name in scatter:
                here *= np.interp(arcs, knots, np.exp(scatter[name] * g.standard_normal(STRETCHES)))
            columns[name] = tuple(float(v) for v in here)
    return beam.model_copy(update={"stations": beam.stations.model_copy(update=columns)})


def _rig(scenario: Scenario, g: np.random.Generator) -> Scenario:
    """The rig within its tolerances."""
    t = scenario.tolerances

    def scaled(table: str, sd: float, *keys: str) -> dict[str, float]:
        share = float(np.exp(sd * g.standard_normal()))
        return {key: getattr(getattr(scenario, table), key) * share for key in keys}

    spring = scaled("suspension", t.suspension_stiffness, "stiffness_n_per_m")
    dampers = ("damping_n_s_per_m", "rotation_damping_n_m_s_per_rad", "pendulum_damping_n_s_per_m")
    spring |= scaled("suspension", t.suspension_damping, *dampers)
    hook = {"hook_m": tuple(np.array(scenario.suspension.hook_m) + t.hook_m * g.standard_normal(3))}
    drive = np.array(scenario.shaker.position_m) + t.drive_point_m * np.array([*g.standard_normal(2), 0.0])
    sensors = scaled("accelerometers", t.sensor_mass, "mass_kg") | scaled("accelerometers", t.high_pass, "high_pass_hz")
    gauge = scaled("transducer", t.transducer_end_mass, "end_mass_kg") | scaled(
        "transducer", t.high_pass, "high_pass_hz"
    )
    changes = {"suspension": spring | hook, "shaker": {"position_m": tuple(drive)}, "accelerometers": sensors}
    changes["transducer"] = gauge
    return scenario.model_copy(update={k: getattr(scenario, k).model_copy(update=v) for k, v in changes.items()})


def read_by_instruments(
    campaign: Campaign, scenario: Scenario, generator: np.random.Generator, noise: float
) -> Campaign:
    """The records as instruments within their tolerances give them, with noise of a stated size.

    ``noise`` is the spectrum of the white noise of each accelerometer over the median of its signal's in the band;
    half of its power again lies below 5 Hz. The force gauge has a third of it.
    """
    t, g = scenario.tolerances, generator
    force_gain = float(np.exp(t.gain * g.standard_normal()))
    widest = max(len(run.channels) for run in campaign.runs)
    instruments = np.exp(t.gain * g.standard_normal(widest))
    runs = []
    for run in campaign.runs:
        samples = np.array(run.samples, dtype=float)
        responses = 0
        for k, channel in enumerate(run.channels):
            if channel.role is ChannelRole.DRIVE:
                continue
            if channel.role is ChannelRole.REFERENCE:
                gain, level = force_gain, noise / 3
            else:
                gain, level = instruments[responses] * np.exp(t.channel_gain * g.standard_normal()), noise
                responses += 1
            samples[k] = samples[k] * gain + _noise(samples[k], run, campaign.band_hz, level, g)
        runs.append(replace(run, samples=samples))
    return replace(campaign, runs=tuple(runs))


def _noise(signal: Array, run: Record, band: tuple[float, float], level: float, g: np.random.Generator) -> Array:
    frequency = np.fft.rfftfreq(signal.size, 1 / run.sample_rate_hz)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    density = level * float(np.median(np.abs(np.fft.rfft(signal))[inside])) / np.sqrt(signal.size)
    white = np.fft.rfft(density * g.standard_normal(signal.size))
    return np.asarray(np.fft.irfft(white * np.sqrt(1 + 0.5 * (frequency < 5.0)), signal.size))


def quiet(scenario: Scenario) -> Scenario:
    """The scenario with ideal instruments: their errors come afterwards, in stated sizes."""
    sensors = scenario.accelerometers.model_copy(update={"noise": None})
    gauge = scenario.transducer.model_copy(update={"noise": None})
    converter = scenario.acquisition.model_copy(update={"noise_v_per_rthz": 0.0})
    return scenario.model_copy(update={"accelerometers": sensors, "transducer": gauge, "acquisition": converter})
