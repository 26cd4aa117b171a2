"""What realisation costs beside `control.eigensys_realization`; run with `pytest tests/benchmarks --benchmark-only`.

The figures to quote are ratios within one run of this file, never seconds.
"""

from __future__ import annotations

import control
import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from vgvt.data import Campaign, Channel, ChannelRole, Geometry, Record
from vgvt.identification import make_identifier
from vgvt.identification.example import DRIVE_NODE, Example
from vgvt_identifiers.data_correlation import realise_correlated
from vgvt_identifiers.hankel import realise

ROWS, COLUMNS, ORDER = 500, 100, 12
RESPONSES = 4
_PLATE = Example(stations=10, sample_rate_hz=200.0, duration_s=64.0, sweep_s=60.0, band_hz=(3.0, 40.0), noise_m_s2=0.02)


@pytest.fixture(scope="module")
def impulse() -> np.ndarray:
    """Impulse responses of six modes in noise, as many samples as the paper's Hankel matrix takes."""
    generator = np.random.default_rng(0)
    roots = np.exp((-0.02 + 1j) * np.linspace(0.5, 2.6, 6))
    amplitude = generator.standard_normal((RESPONSES, 6)) + 1j * generator.standard_normal((RESPONSES, 6))
    clean = 2 * (amplitude @ roots[:, None] ** np.arange(ROWS + COLUMNS + 1)).real
    return np.asarray(clean + 0.05 * generator.standard_normal(clean.shape))


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    """Twenty accelerometers at once, 200 samples a second, 64 s."""
    runs = _PLATE.campaign().runs
    channels: tuple[Channel, ...] = (runs[0].channels[0], *(c for r in runs for c in r.channels[1:]))
    assert sum(c.role is ChannelRole.RESPONSE for c in channels) == 20
    samples = np.vstack([runs[0].samples[:1], *(r.samples[1:] for r in runs)])
    geometry = Geometry((*_PLATE.nodes, DRIVE_NODE), _PLATE.positions_m())
    return Campaign("twenty at once", geometry, (Record(1, 200.0, channels, samples),), _PLATE.band_hz)


@pytest.mark.benchmark(group="realisation of one response, 500 x 100")
def test_control_of_one_response(benchmark: BenchmarkFixture, impulse: np.ndarray) -> None:
    markov = np.concatenate([[0.0], impulse[0]])[None, None, :]
    system, _ = benchmark(control.eigensys_realization, markov, ORDER, m=ROWS, n=COLUMNS)
    assert system.nstates == ORDER


@pytest.mark.benchmark(group="realisation of one response, 500 x 100")
def test_realisation_of_one_response(benchmark: BenchmarkFixture, impulse: np.ndarray) -> None:
    model = benchmark(realise, impulse[:1], ROWS, COLUMNS, ORDER)
    assert model.a.shape == (ORDER, ORDER)


@pytest.mark.benchmark(group="realisation of one response, 500 x 100")
def test_realisation_with_roots_and_their_sensitivity(benchmark: BenchmarkFixture, impulse: np.ndarray) -> None:
    def everything() -> np.ndarray:
        model = realise(impulse[:1], ROWS, COLUMNS, ORDER)
        return np.asarray(model.sensitivity(model.roots()))

    assert np.isfinite(benchmark(everything)).all()


@pytest.mark.benchmark(group="realisation of four responses, 2000 x 100")
def test_control_of_four_responses(benchmark: BenchmarkFixture, impulse: np.ndarray) -> None:
    markov = np.concatenate([np.zeros((RESPONSES, 1, 1)), impulse[:, None, :]], axis=2)
    system, _ = benchmark.pedantic(
        control.eigensys_realization, args=(markov, ORDER), kwargs={"m": ROWS, "n": COLUMNS}, rounds=3
    )
    assert system.nstates == ORDER


@pytest.mark.benchmark(group="realisation of four responses, 2000 x 100")
def test_realisation_of_four_responses(benchmark: BenchmarkFixture, impulse: np.ndarray) -> None:
    model = benchmark(realise, impulse, ROWS, COLUMNS, ORDER)
    assert model.a.shape == (ORDER, ORDER)


@pytest.mark.benchmark(group="realisation of four responses, 2000 x 100")
def test_correlated_realisation_of_four_responses(benchmark: BenchmarkFixture, impulse: np.ndarray) -> None:
    model = benchmark(realise_correlated, impulse, ROWS, 50, ORDER)
    assert model.a.shape == (ORDER, ORDER)


@pytest.mark.benchmark(group="20 channels, 200 Hz, 64 s")
@pytest.mark.parametrize("name", ["era", "era-dc", "pem", "quadrature"])
def test_identification(benchmark: BenchmarkFixture, campaign: Campaign, name: str) -> None:
    method = make_identifier(name)
    model = benchmark.pedantic(method.identify, args=(campaign, campaign.band_hz), rounds=2, warmup_rounds=1)
    assert len(model) == 3


@pytest.mark.benchmark(group="20 channels, 200 Hz, 64 s")
def test_control_of_twenty_responses(benchmark: BenchmarkFixture, impulse: np.ndarray) -> None:
    """The yardstick: one bare realisation of each of twenty responses, without spectra, uncertainty or decision."""
    markov = np.concatenate([[0.0], impulse[0]])[None, None, :]

    def every() -> None:
        for _ in range(20):
            control.eigensys_realization(markov, ORDER, m=ROWS, n=COLUMNS)

    benchmark.pedantic(every, rounds=2)
