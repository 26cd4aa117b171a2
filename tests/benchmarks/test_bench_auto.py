"""What the methods with a limit cost beside a realisation; `pytest tests/benchmarks --benchmark-only`.

The figures to quote are ratios within one run of this file, never seconds. The limits are in seconds on one core: three
for `auto`, one each for `quadrature`, `cfdd` and `era`, with at most 500 MiB.
"""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from vgvt.data import Campaign
from vgvt.identification.example import Example
from vgvt.identification.protocol import Identifier
from vgvt_identifiers.auto import Auto
from vgvt_identifiers.cfdd import Cfdd
from vgvt_identifiers.era import Era
from vgvt_identifiers.maximum_likelihood import MaximumLikelihood
from vgvt_identifiers.quadrature import Quadrature

# A pair 2 % apart is one mode to methods that see one peak; ERA's twelve states a response hold eight of the ten.
METHODS = [(Auto(), 10), (MaximumLikelihood(), 10), (Quadrature(), 9), (Cfdd(), 9), (Era(), 8)]


@pytest.fixture(scope="module")
def twenty_channels() -> Campaign:
    """Ten modes, twenty responses at once, 200 Hz, ninety seconds."""
    example = Example(
        frequency_hz=(4.1, 6.3, 9.2, 13.7, 13.97, 17.0, 21.3, 24.0, 26.9, 31.2),
        damping_ratio=(0.01,) * 10,
        stations=10,
        sample_rate_hz=200.0,
        duration_s=90.0,
        sweep_s=80.0,
        band_hz=(3.0, 35.0),
        noise_m_s2=0.05,
    )
    campaign = example.campaign()
    first = campaign.runs[0]
    channels = (first.channels[0], *(c for run in campaign.runs for c in run.channels[1:]))
    samples = np.vstack([first.samples[:1], *(run.samples[1:] for run in campaign.runs)])
    return replace(campaign, runs=(replace(first, channels=channels, samples=samples),))


@pytest.mark.benchmark(group="twenty channels, ninety seconds at 200 Hz")
def test_realisation(benchmark: BenchmarkFixture, twenty_channels: Campaign) -> None:
    """`control.eigensys_realization` of a 500 x 100 Hankel matrix of the first response."""
    control = pytest.importorskip("control")
    samples = twenty_channels.runs[0].samples
    spectrum = np.fft.rfft(samples[1]) * np.conj(np.fft.rfft(samples[0])) / (np.abs(np.fft.rfft(samples[0])) ** 2 + 1.0)
    impulse = np.fft.irfft(spectrum)[:640]
    benchmark(control.eigensys_realization, impulse, 20, m=500, n=100)


@pytest.mark.benchmark(group="twenty channels, ninety seconds at 200 Hz")
@pytest.mark.parametrize(("method", "modes"), METHODS, ids=[m.name for m, _ in METHODS])
def test_identification(benchmark: BenchmarkFixture, twenty_channels: Campaign, method: Identifier, modes: int) -> None:
    """The whole identification, spectra included."""
    tracemalloc.start()
    method.identify(twenty_channels, (3.0, 35.0))
    benchmark.extra_info["peak_mib"] = tracemalloc.get_traced_memory()[1] / 2**20
    tracemalloc.stop()
    assert benchmark.extra_info["peak_mib"] < 500
    model = benchmark.pedantic(method.identify, args=(twenty_channels, (3.0, 35.0)), rounds=5)
    assert len(model) >= modes
