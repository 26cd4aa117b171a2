"""What moves above half of the sample rate is not taken for motion below it, and what moves below passes as it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_rig import band_spectra, revised

from vgvt.scenario import Scenario
from vgvt.simulation import simulated_campaign
from vgvt.simulation.converter import Converter

RATE = 125.0


@pytest.fixture(name="slow")
def slowly_sampled(small: Scenario) -> Scenario:
    """The small rig, 3 to 35 Hz, at 125 samples a second."""
    return revised(small, acquisition={"sample_rate_hz": RATE})


def tone(converter: Converter, frequency_hz: float) -> np.ndarray:
    """Samples of a sine that has gone on for ever."""
    read = np.sin(2 * np.pi * frequency_hz * converter.times_s())
    return converter.delivered(read[None])[0][40:]


def test_a_tone_of_the_band_passes_without_delay(slow: Scenario) -> None:
    converter = Converter.of(slow)
    times = np.arange(converter.samples)[40:] / RATE
    for frequency in (3.0, 20.0, RATE / 2.56):
        assert np.abs(tone(converter, frequency) - np.sin(2 * np.pi * frequency * times)).max() < 3e-5


def test_a_tone_above_does_not_come_back_as_one_below(slow: Scenario) -> None:
    """Sampled as it is 105 Hz would be 20 Hz."""
    converter = Converter.of(slow)
    for frequency in (RATE * (1 - 1 / 2.56), 105.0, 200.0):
        assert np.abs(tone(converter, frequency)).max() < 3e-5


def test_where_the_excitation_goes_further_up_so_does_what_passes(small: Scenario) -> None:
    converter = Converter.of(revised(small, acquisition={"sample_rate_hz": 80.0}))
    times = np.arange(converter.samples)[60:-1] / 80.0
    read = np.sin(2 * np.pi * 35.0 * converter.times_s())
    assert np.abs(converter.delivered(read[None])[0][60:-1] - np.sin(2 * np.pi * 35.0 * times)).max() < 3e-5


def test_far_above_the_excitation_nothing_is_filtered(small: Scenario) -> None:
    converter = Converter.of(revised(small, acquisition={"sample_rate_hz": 1000.0}))
    assert converter.instants == 1
    read = np.random.default_rng(1).standard_normal((2, converter.times_s().size))
    assert converter.delivered(read) is read


@pytest.mark.parametrize("engine", ["linear", pytest.param("mujoco", marks=pytest.mark.slow)])
def test_accelerance_does_not_hang_on_the_sample_rate(small: Scenario, slow: Scenario, engine: str) -> None:
    """Without a filter A/F of this rig is wrong by 7 % at 125 samples a second, at lines where images meet modes."""
    few, many = (simulated_campaign(s, engine=engine).runs[0] for s in (slow, small))
    # Less the last sample both records are as long, and have the same lines.
    whole = [replace(record, samples=record.samples[:, :-1]) for record in (few, many)]
    low, high = (band_spectra(record, 5.0, 34.0) for record in whole)
    for response in (2, 3):
        got, wanted = (s[response] / s[1] for s in (low, high))
        scale = np.hypot(np.abs(wanted), np.median(np.abs(wanted)))
        assert (np.abs(got - wanted) / scale).max() < 1e-3


def test_the_command_passes_the_filter_of_all_channels(slow: Scenario, small: Scenario) -> None:
    """Without a taper it starts and ends with a kink, of which unfiltered 1 % folds back into the band."""
    sharp = {"taper_s": 0.0, "start_hz": 20.0, "stop_hz": 35.0, "duration_s": 8.0}
    few, many = (simulated_campaign(revised(s, excitation=sharp), engine="linear").runs[0] for s in (slow, small))
    whole = [replace(record, samples=record.samples[:, :-1]) for record in (few, many)]
    low, high = (band_spectra(record, 20.0, 35.0)[0] / rate for record, rate in zip(whole, (RATE, 1000.0), strict=True))
    assert np.abs(low / high - 1).max() < 2e-3
