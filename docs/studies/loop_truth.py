"""A lab that differs from its scenario as far as the tolerances allow, and no further: the blind half of the study.

Draws the true aircraft, rig and instruments (:mod:`vgvt.reconcile.question.drawn`); what it draws, nobody tells the
analysis.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Campaign, ChannelRole, Record
from vgvt.reconcile.question.drawn import drawn_lab
from vgvt.scenario import Scenario, load_scenario

Array = NDArray[np.float64]
# Nature has no cells: the truth has many more than the analysis.
ANALYSIS_CELLS, TRUE_CELLS = 12, 60
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
    return drawn_lab(scenario, generator, cells)


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
