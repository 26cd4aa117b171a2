"""Instruments end at their full scale: records are cut off there and say so, and are the same below it."""

from __future__ import annotations

import numpy as np
import pytest
from small_rig import revised

from vgvt.data import Record
from vgvt.scenario import Scenario
from vgvt.scenario.instruments import NoiseSpectrum
from vgvt.simulation import simulated_campaign
from vgvt.simulation.command import drive_commands, limited_drives, peak_command_v, sample_times_s

G = 9.80665


def first_run(scenario: Scenario) -> Record:
    return simulated_campaign(scenario, engine="linear").runs[0]


@pytest.fixture(scope="module", name="noisy")
def with_noise(small: Scenario) -> Scenario:
    noise = NoiseSpectrum(frequency_hz=(1.0,), density=(1e-4,))
    return revised(
        small, transducer={"noise": noise, "high_pass_hz": 0.15}, accelerometers={"noise": noise, "range_g": 500.0}
    )


@pytest.fixture(scope="module", name="plain")
def without_an_end(noisy: Scenario) -> Record:
    return first_run(revised(noisy, transducer={"range_n": None}, generator={"range_v": None}))


def test_a_force_beyond_the_transducer_s_scale_reads_as_that(noisy: Scenario, plain: Record) -> None:
    end = 0.4 * float(np.abs(plain.samples[1]).max())
    cut = first_run(revised(noisy, transducer={"range_n": end}))
    step = 2 * 10.0 / 2**32 / plain.channels[1].sensitivity_v_per_unit
    np.testing.assert_allclose(cut.samples[1], np.clip(plain.samples[1], -end, end), atol=2 * step)
    assert (np.abs(cut.samples[1]) > end - step).sum() > 50
    assert cut.overloaded == ("force",)
    assert cut.notes == (f"force: reached the force transducer's ±{end:g} N",)
    np.testing.assert_array_equal(cut.samples[[0, 2, 3]], plain.samples[[0, 2, 3]])


def test_each_accelerometer_ends_by_itself(noisy: Scenario, plain: Record) -> None:
    peaks = np.abs(plain.samples[2:]).max(axis=1) / G
    assert peaks.max() > 1.05 * peaks.min(), "the two sensors must differ"
    end = float(np.sqrt(peaks.max() * peaks.min()))
    cut = first_run(revised(noisy, accelerometers={"range_g": end}))
    (name,) = cut.overloaded
    assert name == plain.channels[2 + int(np.argmax(peaks))].name
    assert cut.notes == (f"{name}: reached the accelerometer's ±{end:g} g",)
    assert np.abs(cut.samples[2:]).max() == pytest.approx(end * G, rel=1e-6)


def test_nothing_changes_where_nothing_ends(noisy: Scenario, plain: Record) -> None:
    """To the last bit, and with the generator's end just above the amplitude, too."""
    ended = first_run(revised(noisy, transducer={"range_n": 44.5}, generator={"range_v": 0.0501}))
    np.testing.assert_array_equal(ended.samples, plain.samples)
    assert (ended.overloaded, ended.notes) == ((), ())


def test_the_sensor_ends_before_the_converter_and_both_are_told(noisy: Scenario, plain: Record) -> None:
    end = 0.5 * float(np.abs(plain.samples[1]).max())
    volts = 0.8 * end * plain.channels[1].sensitivity_v_per_unit
    cut = first_run(revised(noisy, transducer={"range_n": end}, acquisition={"range_v": volts}))
    (note,) = (note for note in cut.notes if note.startswith("force"))
    assert note == f"force: reached the force transducer's ±{end:g} N and the converter's ±{volts:g} V"
    assert np.abs(cut.samples[1]).max() == pytest.approx(0.8 * end, rel=1e-6)


def test_the_generator_cuts_the_peaks_of_noise_off_before_they_shake_anything(small: Scenario) -> None:
    noise = {"kind": "random", "start_hz": 3.0, "amplitude_v": 0.05, "duration_s": 8.0}
    free = revised(small, excitation=noise, generator={"range_v": None})
    limited = revised(free, generator={"range_v": 0.1})
    assert peak_command_v(limited) == peak_command_v(free) > 0.12
    assert (limited_drives(free, 0), limited_drives(limited, 0)) == ((), (0,))
    sent = drive_commands(limited, 0, sample_times_s(limited))
    np.testing.assert_array_equal(sent, np.clip(drive_commands(free, 0, sample_times_s(free)), -0.1, 0.1))
    ours, theirs = first_run(limited), first_run(free)
    assert (ours.overloaded, ours.notes) == (("drive",), ("drive: reached the generator's ±0.1 V",))
    assert theirs.overloaded == ()
    assert np.abs(ours.samples[1] - theirs.samples[1]).max() > 0.01 * np.abs(theirs.samples[1]).max()


def test_the_generator_s_steps_are_sent(small: Scenario) -> None:
    coarse = revised(small, generator={"range_v": 10.0, "bits": 12})
    sent, asked = (
        drive_commands(s, 0, sample_times_s(s))[0] for s in (coarse, revised(coarse, generator={"bits": None}))
    )
    step_v = 20.0 / 2**12
    np.testing.assert_allclose(sent / step_v, np.round(sent / step_v), atol=1e-9)
    assert 0.4 * step_v < np.abs(sent - asked).max() <= 0.5 * step_v * (1 + 1e-9)
    assert len(np.unique(sent)) > 15
