"""The acquisition chain: steps of the converter, clipping, noise of the right size, AC coupling."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.signal
from small_rig import revised

from vgvt.data import Record
from vgvt.scenario import Scenario
from vgvt.scenario.instruments import NoiseSpectrum
from vgvt.simulation import simulated_campaign


def first_run(scenario: Scenario) -> Record:
    return simulated_campaign(scenario, engine="linear").runs[0]


def test_samples_are_whole_converter_steps(small: Scenario) -> None:
    coarse = first_run(revised(small, acquisition={"bits": 12}))
    step_v = 2 * 10.0 / 2**12
    for channel, row in zip(coarse.channels, coarse.samples, strict=True):
        volts = row * channel.sensitivity_v_per_unit
        np.testing.assert_allclose(volts / step_v, np.round(volts / step_v), atol=1e-6)
        assert len(np.unique(np.round(volts / step_v))) > 3


def test_clipping_is_flagged_and_bounded(small: Scenario) -> None:
    quiet = first_run(small)
    assert quiet.overloaded == ()
    range_v = 0.5 * float(np.abs(quiet.samples[2] * quiet.channels[2].sensitivity_v_per_unit).max())
    loud = first_run(revised(small, acquisition={"range_v": range_v}))
    assert loud.channels[2].name in loud.overloaded
    assert np.abs(loud.samples[2] * loud.channels[2].sensitivity_v_per_unit).max() <= range_v


def test_noise_has_the_density_of_the_sensor(small: Scenario) -> None:
    """Welch's estimate over a silent record meets the scenario's spectrum, in g per root hertz."""
    spectrum = NoiseSpectrum(frequency_hz=(5.0, 100.0), density=(7e-4, 5e-5))
    silent = {"amplitude_v": 1e-12, "ring_down_s": 190.0}
    record = first_run(revised(small, accelerometers={"noise": spectrum}, excitation=silent))
    frequency, density = scipy.signal.welch(record.samples[2] / 9.80665, record.sample_rate_hz, nperseg=2000)
    expected = np.exp(np.interp(np.log(np.maximum(frequency, 1e-3)), np.log([5, 100]), np.log([7e-4, 5e-5])))
    for low, high in ((5, 10), (20, 40), (80, 300)):
        band = (frequency >= low) & (frequency <= high)
        assert np.sqrt(np.mean(density[band] / expected[band] ** 2)) == pytest.approx(1.0, abs=0.08)


def test_another_sensor_changes_no_noise(small: Scenario) -> None:
    """Named streams: a third accelerometer leaves the noise of the first two as it was."""
    noisy = revised(small, acquisition={"noise_v_per_rthz": 1e-5}, accelerometers={"mass_kg": 0.0})
    two = first_run(revised(noisy, acquisition={"runs": ((1, 10),)}))
    three = first_run(revised(noisy, acquisition={"runs": ((1, 10, 4),)}))
    quiet_two = first_run(revised(noisy, acquisition={"runs": ((1, 10),), "noise_v_per_rthz": 0.0}))
    quiet_three = first_run(revised(noisy, acquisition={"runs": ((1, 10, 4),), "noise_v_per_rthz": 0.0}))
    np.testing.assert_allclose(two.samples - quiet_two.samples, (three.samples - quiet_three.samples)[:4], atol=1e-6)
    assert np.abs(two.samples - quiet_two.samples).max() > 1e-4


def test_ac_coupling_is_a_first_order_high_pass(small: Scenario) -> None:
    """Coupled over uncoupled spectrum is (jf/fc)/(1 + jf/fc)."""
    corner = 0.5
    plain = np.fft.rfft(first_run(small).samples[2])
    coupled = np.fft.rfft(first_run(revised(small, accelerometers={"high_pass_hz": corner})).samples[2])
    frequency = np.fft.rfftfreq(2 * plain.size - 2, 1e-3)[: plain.size]
    band = (frequency > 3) & (frequency < 30)
    ratio = 1j * frequency[band] / corner
    assert np.median(np.abs(coupled[band] / plain[band] / (ratio / (1 + ratio)) - 1)) < 2e-3
