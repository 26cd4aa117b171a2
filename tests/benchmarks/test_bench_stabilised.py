"""What the stabilised methods cost with twenty channels; run with `pytest tests/benchmarks --benchmark-only`.

`control.eigensys_realization` of one response is the yardstick: quote ratios within one run, never seconds.
"""

from __future__ import annotations

from dataclasses import replace

import control
import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from vgvt.data import Campaign, Record
from vgvt.identification import make_identifier, run_identifier
from vgvt.identification.example import Example

ROWS, COLUMNS, ORDER = 500, 100, 12
_PLATE = Example(stations=10, sample_rate_hz=200.0, duration_s=64.0, sweep_s=60.0, noise_m_s2=0.02)


@pytest.fixture(scope="module")
def roving() -> Campaign:
    """Ten runs of two roving accelerometers, 200 samples a second, 64 s."""
    return _PLATE.campaign()


@pytest.fixture(scope="module")
def at_once(roving: Campaign) -> Campaign:
    """The same with all twenty accelerometers in one run."""
    channels = (roving.runs[0].channels[0], *(c for r in roving.runs for c in r.channels[1:]))
    samples = np.vstack([roving.runs[0].samples[:1], *(r.samples[1:] for r in roving.runs)])
    return replace(roving, runs=(Record(1, 200.0, channels, samples),))


@pytest.mark.benchmark(group="twenty channels at 200 Hz")
def test_control_of_one_response(benchmark: BenchmarkFixture) -> None:
    generator = np.random.default_rng(0)
    roots = np.exp((-0.02 + 1j) * np.linspace(0.5, 2.6, 6))
    markov = np.concatenate([[0.0], (roots[:, None] ** np.arange(ROWS + COLUMNS + 1)).real.sum(axis=0)])
    markov = markov + 0.01 * generator.standard_normal(markov.size)
    system, _ = benchmark(control.eigensys_realization, markov[None, None], ORDER, m=ROWS, n=COLUMNS)
    assert system.nstates == ORDER


@pytest.mark.benchmark(group="twenty channels at 200 Hz")
@pytest.mark.parametrize("name", ["plscf", "subspace"])
@pytest.mark.parametrize("sensors", ["at_once", "roving"])
def test_identification(benchmark: BenchmarkFixture, request: pytest.FixtureRequest, name: str, sensors: str) -> None:
    campaign = request.getfixturevalue(sensors)
    model = benchmark.pedantic(run_identifier, args=(make_identifier(name), campaign), rounds=3, warmup_rounds=1)
    assert len(model) == 3


@pytest.mark.benchmark(group="twenty channels at 200 Hz")
def test_plscf_with_common_poles(benchmark: BenchmarkFixture, roving: Campaign) -> None:
    method = make_identifier("plscf", poles="common")
    model = benchmark.pedantic(run_identifier, args=(method, roving), rounds=3, warmup_rounds=1)
    assert len(model) == 3
