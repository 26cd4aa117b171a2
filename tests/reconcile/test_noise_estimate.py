"""The variance that a campaign's lines are given is that of the noise which was added to its records."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from vgvt.data import Campaign, ChannelRole
from vgvt.reconcile.data import Measured, measured_frfs
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import simulate

BANDS = 10
RUNS = ((1, 6, 13, 18), (3, 8, 11, 20), (5, 10, 15, 16), (2, 9, 14, 17), (4, 7, 12, 19))


def roving(sweep_s: float) -> Scenario:
    """Hati in five runs of four roving sensors; a short sweep leaves few lines to a peak and a force that drops out."""
    scenario = load_scenario("hati-unsymmetric")
    sweep = {"start_hz": 3.0, "stop_hz": 35.0, "duration_s": sweep_s, "ring_down_s": 3.0}
    changes = {
        "acquisition": scenario.acquisition.model_copy(update={"sample_rate_hz": 250.0, "runs": RUNS}),
        "excitation": scenario.excitation.model_copy(update=sweep),
    }
    return scenario.model_copy(update=changes)


SCENARIOS = {
    "Hati, 14 s": lambda: roving(14.0),
    "Hati, 60 s": lambda: roving(60.0),
    "beam": lambda: load_scenario("teaching-beam"),
}


@cache
def without_noise(name: str) -> Campaign:
    """The campaign of a scenario with ideal instruments."""
    scenario = SCENARIOS[name]()
    silent = {"noise": None}
    changes = {
        "accelerometers": scenario.accelerometers.model_copy(update=silent),
        "transducer": scenario.transducer.model_copy(update=silent),
        "acquisition": scenario.acquisition.model_copy(update={"noise_v_per_rthz": 0.0, "bits": 32}),
    }
    return simulate(scenario.model_copy(update=changes), engine="linear").campaign


@dataclass(frozen=True)
class Noise:
    """White noise, or ``coloured`` with 5 Hz / f more power, of every accelerometer and a third of it of the gauge.

    ``share`` is its spectrum over the median of the channel's own in the band.
    """

    share: float
    coloured: bool

    def shape(self, frequency_hz: np.ndarray) -> np.ndarray:
        """Amplitude over that of white noise."""
        return np.sqrt(1 + self.coloured * 5.0 / np.maximum(frequency_hz, 0.5))

    def density(self, samples: np.ndarray, rate_hz: float, band: tuple[float, float], role: ChannelRole) -> float:
        """Standard deviation of a sample of the white noise that goes onto a channel (N,)."""
        frequency = np.fft.rfftfreq(samples.size, 1 / rate_hz)
        inside = (frequency >= band[0]) & (frequency <= band[1])
        own = float(np.median(np.abs(np.fft.rfft(samples - samples.mean()))[inside]))
        return self.share * own / np.sqrt(samples.size) / (3 if role is ChannelRole.REFERENCE else 1)

    def on(self, campaign: Campaign, generator: np.random.Generator) -> Campaign:
        """The campaign with a draw of the noise."""
        runs = []
        for run in campaign.runs:
            samples = np.array(run.samples, dtype=float)
            frequency = np.fft.rfftfreq(samples.shape[1], 1 / run.sample_rate_hz)
            for k, channel in enumerate(run.channels):
                sd = self.density(run.samples[k], run.sample_rate_hz, campaign.band_hz, channel.role)
                drawn = np.fft.rfft(sd * generator.standard_normal(samples.shape[1]))
                samples[k] += np.fft.irfft(drawn * self.shape(frequency), samples.shape[1])
            runs.append(replace(run, samples=samples))
        return replace(campaign, runs=tuple(runs))

    def variance(self, campaign: Campaign, measured: Measured) -> tuple[np.ndarray, np.ndarray]:
        """The accelerance without noise and its variance with it, (C, L), from the DFT of white noise alone."""
        values, variances = [], []
        for run in campaign.runs:
            spectra = np.fft.rfft(run.samples - run.samples.mean(axis=1, keepdims=True), axis=1)[:, measured.lines]
            power = [
                run.samples.shape[1]
                * (self.density(x, run.sample_rate_hz, campaign.band_hz, c.role) * self.shape(measured.frequency_hz))
                ** 2
                for c, x in zip(run.channels, run.samples, strict=True)
            ]
            force = next(k for k, c in enumerate(run.channels) if c.role is ChannelRole.REFERENCE)
            for k, channel in enumerate(run.channels):
                if channel.role is ChannelRole.RESPONSE:
                    g = spectra[k] / spectra[force]
                    values.append(g)
                    variances.append((power[k] + np.abs(g) ** 2 * power[force]) / np.abs(spectra[force]) ** 2)
        return np.array(values), np.array(variances)


def by_band(values: np.ndarray) -> np.ndarray:
    """Means of (C, L) over all channels in ten bands of equally many lines, (10,)."""
    return np.array([part.mean() for part in np.array_split(values, BANDS, axis=1)])


def holds(name: str, noise: Noise, draws: int) -> None:
    """The estimate over the true variance: 1 within 10 % over all lines and within 25 % in each of ten bands."""
    campaign = without_noise(name)
    generator = np.random.default_rng(7)
    estimated, squared, at_peaks = [], [], []
    for _ in range(draws):
        measured = measured_frfs(noise.on(campaign, generator), lines=200)
        assert not measured.remarks
        exact, variance = noise.variance(campaign, measured)
        ratio = measured.noise / variance
        estimated.append(by_band(ratio))
        squared.append(float(np.mean(np.abs(measured.values - exact) ** 2 / variance)))
        at_peaks.append(ratio[np.abs(exact) > np.quantile(np.abs(exact), 0.9, axis=1, keepdims=True)].mean())
    # The judge itself: what the draws do to A/F has the variance that theory says.
    assert np.mean(squared) == pytest.approx(1.0, abs=0.07)
    bands = np.mean(estimated, axis=0)
    assert bands.mean() == pytest.approx(1.0, abs=0.1), bands
    assert np.abs(bands - 1).max() < 0.25, bands
    assert np.mean(at_peaks) == pytest.approx(1.0, abs=0.25)


def test_a_short_roving_sweep_is_given_its_own_noise() -> None:
    holds("Hati, 14 s", Noise(0.01, False), 12)


@pytest.mark.slow
@pytest.mark.parametrize("name", list(SCENARIOS))
@pytest.mark.parametrize("share", [0.003, 0.01, 0.03])
def test_white_noise_is_estimated_as_it_is(name: str, share: float) -> None:
    holds(name, Noise(share, False), 50)


@pytest.mark.slow
@pytest.mark.parametrize("name", list(SCENARIOS))
def test_coloured_noise_is_estimated_as_it_is(name: str) -> None:
    holds(name, Noise(0.01, True), 50)


def test_noise_at_the_end_of_a_record_is_no_ringing_but_a_cut_record_rings() -> None:
    generator = np.random.default_rng(2)
    noisy = Noise(0.1, False).on(without_noise("Hati, 14 s"), generator)
    assert measured_frfs(noisy, lines=100).remarks == ()
    # The last 3 s are silent; a record that ends before them ends in the swing of the last mode.
    cut = replace(noisy, runs=tuple(replace(r, samples=r.samples[:, : -round(3.2 * 250)]) for r in noisy.runs))
    remarks = measured_frfs(cut, lines=100).remarks
    assert len(remarks) == len(RUNS)
    assert all("ringing" in r for r in remarks)
