"""Noise of known size and colour on the records of a campaign, and the variance of A/F that follows."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vgvt.data import Campaign, ChannelRole
from vgvt.reconcile.question.data import Measured


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
        values, variances, longest = [], [], max(run.samples.shape[1] for run in campaign.runs)
        for run in campaign.runs:
            signals = run.samples - run.samples.mean(axis=1, keepdims=True)
            spectra = np.fft.rfft(signals, longest, axis=1)[:, measured.lines]
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
