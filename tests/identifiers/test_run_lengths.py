"""Runs of different lengths and sample rates: no mode that is not there, and the frequencies that are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Campaign
from vgvt.identification import make_identifier, run_identifier
from vgvt.identification.example import Example
from vgvt_identifiers.common_lines import Measured, common_lines
from vgvt_identifiers.spectra import campaign_spectra

RATE = 128.0
BAND = (3.0, 30.0)
FREQUENCY = np.array((6.3, 13.7, 26.9))


def example(
    seconds: tuple[float, ...], sweep_s: float = 20.0, rate: float = RATE, noise_m_s2: float = 0.05
) -> Campaign:
    """The example plate, noisy, with each run cut to so many seconds."""
    whole = Example(noise_m_s2=noise_m_s2, duration_s=max(seconds), sweep_s=sweep_s, sample_rate_hz=rate).campaign()
    runs = tuple(
        replace(record, samples=record.samples[:, : round(s * rate)])
        for record, s in zip(whole.runs, seconds, strict=True)
    )
    return replace(whole, runs=runs, band_hz=BAND)


@pytest.mark.parametrize("name", ["quadrature", "vector-fitting"])
def test_one_long_run_among_short_ones_adds_no_modes(name: str) -> None:
    """Padded to the long one, the others had lines of interpolated noise in between: a dozen modes for three."""
    claim = run_identifier(make_identifier(name), example((48.0, 24.0, 24.0, 24.0)))
    np.testing.assert_allclose(claim.natural_frequency_hz, FREQUENCY, atol=2e-3)
    assert any("differ in length" in line for line in claim.advice)


def test_a_longer_run_has_the_lines_of_the_shorter_among_its_own() -> None:
    """Twice as long: every second line; a third of a second longer: its end is left off. No line is interpolated."""
    spectra = campaign_spectra(example((48.0, 24.0, 24.0, 24.3)), BAND)
    assert spectra.frequency_hz[0] == pytest.approx(3.0)
    assert np.diff(spectra.frequency_hz) == pytest.approx(1 / 24.0)
    assert [run.run for run in spectra.runs] == [1, 2, 3, 4]
    assert any("run 4: of 24.3 s the first 24 s are used" in remark for remark in spectra.remarks)
    record = example((48.0, 24.0, 24.0, 24.3)).runs[0]
    own = np.fft.rfft(record.samples - record.samples.mean(axis=1, keepdims=True), axis=1)
    lines = 2 * np.rint(spectra.frequency_hz * 24.0).astype(int)
    np.testing.assert_allclose(spectra.runs[0].accelerance, own[1:, lines] / own[0, lines], rtol=1e-9)


def test_noise_is_told_as_large_as_in_runs_of_one_length() -> None:
    """The median over lines and responses of the variances, of runs that were cut short of the silence at the end."""
    variance = []
    for seconds in ((24.0,) * 4, (24.0, 24.0, 36.0, 36.0)):
        runs = campaign_spectra(example(seconds), BAND).runs[2:]
        variance.append(np.median([run.variance for run in runs]))
        power = [np.median(run.variance * np.abs(run.force) ** 2) for run in runs]
        # The spectrum of white noise of 0.05 m/s2 over the whole record.
        assert np.mean(power) == pytest.approx(0.05**2 * RATE * seconds[2], rel=0.15)
    assert variance[1] == pytest.approx(variance[0], rel=0.1)


def test_a_run_whose_beginning_lacks_part_of_the_band_is_left_out() -> None:
    """A sweep of 36 s has come to 20 Hz in the 24 s of the other runs; noise fills the band at any time."""
    short = example((24.0,) * 4)
    slow = example((36.0,) * 4, sweep_s=36.0)
    mixed = replace(short, runs=(*short.runs[:3], slow.runs[3]))
    spectra = campaign_spectra(mixed, BAND)
    assert [run.run for run in spectra.runs] == [1, 2, 3]
    assert any("run 4 left out" in remark and "whole band" in remark for remark in spectra.remarks)


def test_steady_noise_may_be_cut_anywhere() -> None:
    force = np.random.default_rng(2).standard_normal(round(46.0 * RATE))
    common = common_lines([Measured(1, RATE, force[:3072], 1), Measured(2, RATE, force, 1)], BAND)
    assert common.samples == {1: 3072, 2: 3072}


def test_a_run_that_broke_off_does_not_take_the_lines_of_the_others() -> None:
    spectra = campaign_spectra(example((48.0, 48.0, 5.0, 48.0)), BAND)
    assert [run.run for run in spectra.runs] == [1, 2, 4]
    assert np.diff(spectra.frequency_hz) == pytest.approx(1 / 48.0)
    assert any("run 3 left out: it lasts 5 s" in remark for remark in spectra.remarks)


def test_runs_of_two_rates_have_one_axis() -> None:
    """3073 samples at 128 Hz and 24 s at 100 Hz: lines were named by a length that the second had not, by 4.4e-5."""
    first = example((3073 / 128.0,) * 4, noise_m_s2=0.005)
    second = example((24.0,) * 4, rate=100.0, noise_m_s2=0.005)
    claim = run_identifier(make_identifier("quadrature"), replace(first, runs=first.runs[:2] + second.runs[2:]))
    np.testing.assert_allclose(claim.natural_frequency_hz, FREQUENCY, rtol=1e-5)


@pytest.mark.parametrize("samples", [2400, 2401])
def test_lines_between_samples_are_those_of_a_tone(samples: int) -> None:
    """A tone on a line of 23.996 s at 128 Hz, sampled at 100 Hz, is there with its size and phase, and on no other."""
    noise = np.random.default_rng(1).standard_normal(3071)
    time = np.arange(samples) / 100.0
    tone = np.cos(2 * np.pi * 200 / (3071 / 128.0) * time + 0.4)
    forces = [Measured(1, 128.0, noise, 2), Measured(2, 100.0, noise[:samples], 2)]
    common = common_lines(forces, (1.0, 30.0))
    assert common.samples == {1: 3071, 2: 2399}
    lines = np.arange(150, 250)
    found = common.transform(tone[: common.samples[2]], 100.0, lines)
    size = np.abs(found)
    assert lines[np.argmax(size)] == 200
    assert found[50] == pytest.approx(1200 * np.exp(0.4j), rel=2e-3)
    assert np.delete(size, 50).max() < 2.0
