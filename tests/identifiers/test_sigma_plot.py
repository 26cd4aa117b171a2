"""Sigma-plot peaks: found by the same rule whether narrow or wide, and not made of noise, colour or leakage."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Campaign, ChannelRole
from vgvt.identification.example import Example
from vgvt.signals.local_polynomial import local_polynomial_fit
from vgvt_identifiers.quadrature import Quadrature
from vgvt_identifiers.sigma_plot import sigma_peaks
from vgvt_identifiers.spectra import LOCAL_HALF_WIDTH, campaign_spectra, line_variance

BASE = Example(
    frequency_hz=(5.2, 11.7, 17.3, 26.1),
    damping_ratio=(0.01,) * 4,
    stations=3,
    sample_rate_hz=128.0,
    duration_s=40.0,
    sweep_s=40.0,
)


def peaks_of(campaign: Campaign) -> list[float]:
    return [p.frequency_hz for p in sigma_peaks(campaign_spectra(campaign, campaign.band_hz))]


def noise_only(seed: int, colour: bool = False) -> Campaign:
    """The sweep, and sensors that see none of it."""
    generator = np.random.default_rng([12, seed])
    campaign = replace(BASE, seed=seed).campaign()
    runs = []
    for record in campaign.runs:
        samples = record.samples.copy()
        for i, channel in enumerate(record.channels):
            if channel.role is ChannelRole.RESPONSE:
                white = generator.standard_normal(samples.shape[1])
                samples[i] = np.cumsum(white) if colour else white
        runs.append(replace(record, samples=samples))
    return replace(campaign, runs=tuple(runs))


@pytest.mark.parametrize("damping", [0.0005, 0.002, 0.01, 0.03])
@pytest.mark.parametrize("noise_m_s2", [0.0, 0.1])
def test_four_modes_are_peaks_within_half_their_width_or_a_line(damping: float, noise_m_s2: float) -> None:
    example = replace(BASE, damping_ratio=(damping,) * 4, noise_m_s2=noise_m_s2, seed=5)
    found = np.array(peaks_of(example.campaign()))
    for true_hz in example.frequency_hz:
        assert np.abs(found - true_hz).min() < max(damping * true_hz, 1.01 / example.duration_s)


def test_the_raw_maximum_is_reported() -> None:
    campaign = replace(BASE, damping_ratio=(0.01,) * 4, noise_m_s2=0.05).campaign()
    spectra = campaign_spectra(campaign, campaign.band_hz)
    for peak in sigma_peaks(spectra):
        near = np.abs(spectra.frequency_hz - peak.frequency_hz) < 0.1
        assert spectra.power[peak.line] == spectra.power[near].max()
        assert spectra.frequency_hz[peak.line] == peak.frequency_hz


def test_white_noise_makes_no_peaks_more_often_than_stated() -> None:
    """At a false alarm of 1 % a campaign, more than one alarm in 25 campaigns has a chance under 3 %."""
    assert sum(bool(peaks_of(noise_only(seed))) for seed in range(25)) <= 1


def test_drift_that_the_record_cuts_off_makes_no_modes() -> None:
    """A random walk leaks into every line; divided by the force that makes ripples, which no pole explains."""
    for seed in range(12):
        campaign = noise_only(seed, colour=True)
        assert len(Quadrature().identify(campaign, campaign.band_hz)) == 0


def test_a_hole_in_the_force_is_no_peak() -> None:
    """Where the force drops out, noise divided by little force is large: a peak of the floor alone."""
    generator = np.random.default_rng(13)
    campaign = noise_only(3)
    runs = []
    for record in campaign.runs:
        spectrum = np.fft.rfft(record.samples[0])
        frequency = np.fft.rfftfreq(record.samples.shape[1], 1 / record.sample_rate_hz)
        spectrum *= 1 - 0.97 * np.exp(-(((frequency - 15.0) / 0.7) ** 2))
        samples = record.samples.copy()
        samples[0] = np.fft.irfft(spectrum, samples.shape[1]) + 1e-4 * generator.standard_normal(samples.shape[1])
        runs.append(replace(record, samples=samples))
    assert peaks_of(replace(campaign, runs=tuple(runs))) == []


def test_more_prominence_finds_fewer_peaks() -> None:
    campaign = replace(BASE, damping_ratio=(0.01,) * 4, noise_m_s2=0.05).campaign()
    spectra = campaign_spectra(campaign, campaign.band_hz)
    counts = [len(sigma_peaks(spectra, prominence_db=db)) for db in (0.5, 1.0, 10.0, 45.0)]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] >= 4
    assert counts[-1] == 0


def estimated(ratio: np.ndarray, force: np.ndarray) -> np.ndarray:
    """The line variance with the noise power of the local fit, as the spectra take it."""
    padded = np.pad(ratio * force, ((0, 0), (1, 0))), np.pad(force, (1, 0))[None]
    fit = local_polynomial_fit(*padded, np.arange(1, force.size + 1), half_width=LOCAL_HALF_WIDTH)
    return line_variance(ratio, force, fit.noise_power)


def test_the_line_variance_is_that_of_the_ratio() -> None:
    """White noise on a flat structure: E|e|^2 of A/F is known, here also where the force falls tenfold."""
    generator = np.random.default_rng(14)
    lines = 4000
    force = np.exp(2j * np.pi * generator.random(lines)) * np.where(np.arange(lines) < 2000, 10.0, 1.0)
    noise = (generator.standard_normal((3, lines)) + 1j * generator.standard_normal((3, lines))) / np.sqrt(2)
    estimate = estimated(2.0 + noise / force, force)
    assert estimate[:, 100:1900].mean() == pytest.approx(0.01, rel=0.2)
    assert estimate[:, 2100:3900].mean() == pytest.approx(1.0, rel=0.2)


def test_the_line_variance_is_not_misled_by_a_resonance_of_a_few_lines() -> None:
    frequency = np.arange(10.0, 20.0, 1 / 60)
    resonance = 1 / (2j * np.pi * (frequency - 15.0) + 2 * np.pi * 0.01)
    generator = np.random.default_rng(15)
    noise = 1e-3 * (
        generator.standard_normal((1, frequency.size)) + 1j * generator.standard_normal((1, frequency.size))
    )
    estimate = estimated(resonance + noise, np.ones(frequency.size, complex))
    assert np.sqrt(estimate[0, 295:306]).max() < 1e-2 < np.abs(resonance).max()
