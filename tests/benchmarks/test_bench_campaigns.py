"""What a bench adds to the identification itself, and how it scales; `pytest tests/benchmarks --benchmark-only`.

The figures to quote are ratios within one run of this file, never seconds: a campaign by the whole bench over the
bare identification, and eight campaigns by one process over those by two. Both need an idle machine.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from vgvt.bench.bench import BenchPlan, bench
from vgvt.bench.cell import seeded
from vgvt.bench.entry import Entry
from vgvt.bench.executors import process_pool
from vgvt.bench.umpire import Limits
from vgvt.identification import make_identifier
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import simulate

_ENTRY = Entry("auto")
_LIMITS = Limits(time_s=300.0)


@pytest.fixture(scope="module")
def hati() -> Scenario:
    return load_scenario("hati-unsymmetric")


@pytest.mark.benchmark(group="hati, ten runs of a minute, auto")
def test_identification_alone(benchmark: BenchmarkFixture, hati: Scenario) -> None:
    """The method on a campaign in memory."""
    campaign = simulate(seeded(hati, 0, 0, "linear")).campaign
    method = make_identifier(_ENTRY.identifier)
    model = benchmark.pedantic(method.identify, args=(campaign, campaign.band_hz), rounds=2, warmup_rounds=1)
    assert len(model) == 3


@pytest.mark.benchmark(group="hati, ten runs of a minute, auto")
def test_a_cell_of_the_bench(benchmark: BenchmarkFixture, hati: Scenario, tmp_path: Path) -> None:
    """Simulation, hand-over, a process of its own, identification, score."""
    folders = iter(tmp_path / str(k) for k in range(9))

    def cell() -> int:
        table = bench(BenchPlan((hati,), 1, (_ENTRY,), _LIMITS), next(folders))
        return int((table["status"] == "found").sum())

    assert benchmark.pedantic(cell, rounds=2, warmup_rounds=1) == 3


@pytest.mark.benchmark(group="eight campaigns")
@pytest.mark.parametrize("workers", [1, 2])
def test_scaling(benchmark: BenchmarkFixture, workers: int, tmp_path: Path) -> None:
    """The same eight campaigns by one worker and by two, starting them included."""
    folders = iter(tmp_path / str(k) for k in range(9))
    plan = BenchPlan((load_scenario("teaching-beam"),), 8, (_ENTRY,), _LIMITS)
    table = benchmark.pedantic(lambda: bench(plan, next(folders), process_pool(workers)), rounds=1)
    assert table["seed_number"].nunique() == 8
    assert not (table["outcome"] == "failed").any()
