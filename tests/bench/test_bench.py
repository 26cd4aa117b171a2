"""The bench as a whole: the same table wherever it runs, and nothing done twice."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pandas
import pytest
from patience import soon

import vgvt.bench.bench as bench_module
from vgvt.bench.bench import BenchPlan, bench, failures
from vgvt.bench.cell import derived_seed, run_cell
from vgvt.bench.completion import in_order_of_completion
from vgvt.bench.entry import Entry
from vgvt.bench.executors import dask_cluster, process_pool
from vgvt.bench.rows import COLUMNS, MEASURED
from vgvt.bench.summary import summary
from vgvt.bench.table import read_table, table_of, write_csv, write_parquet
from vgvt.bench.umpire import Limits
from vgvt.data import InputError


def comparable(table: pandas.DataFrame) -> pandas.DataFrame:
    return table.drop(columns=list(MEASURED))


@pytest.fixture(scope="module")
def plan(light_scenario) -> BenchPlan:
    return BenchPlan((light_scenario,), seeds=2, entries=(Entry("quadrature"),), limits=Limits())


@pytest.fixture(scope="module")
def serial(plan, tmp_path_factory) -> pandas.DataFrame:
    return bench(plan, tmp_path_factory.mktemp("serial"))


def test_the_table_has_a_row_for_every_mode_of_every_seed(serial, plan) -> None:
    assert list(serial.columns) == list(COLUMNS)
    assert sorted(set(serial["seed_number"])) == [0, 1]
    assert serial["seed"].nunique() == 2
    assert (serial["status"] == "found").sum() == 6
    assert failures(serial).empty
    numbers = summary(serial).iloc[0]
    assert numbers["found"] == 3
    assert 0 < numbers["rms_error_over_bound"] < 10
    assert numbers["split"] == 0
    found = serial[serial["status"] == "found"]
    error = (found["claimed_hz"] - found["true_hz"]).abs()
    pandas.testing.assert_series_equal(
        found["frequency_efficiency"], found["frequency_bound_hz"] / error, check_names=False
    )
    for name in MEASURED:
        assert (serial.groupby("seed_number")[name].nunique() == 1).all()
    assert serial["frf_fit_percent"].isna().all()  # this method states no residues


def test_a_claim_with_residues_is_held_against_the_measured_responses(light_scenario) -> None:
    plan = BenchPlan((light_scenario,), seeds=1, entries=(Entry("plscf"),), limits=Limits())
    rows = run_cell(plan.cells()[0])
    fits, gaps = {row["frf_fit_percent"] for row in rows}, {row["nu_gap"] for row in rows}
    assert len(rows) == 3 and len(fits) == len(gaps) == 1
    assert 90 < fits.pop() < 100
    assert 0 < gaps.pop() < 0.5


@pytest.mark.parametrize("amplitude_v", [None, 0.01])
def test_two_scenarios_of_one_name_are_refused(light_scenario, amplitude_v) -> None:
    """Their campaigns have the same seeds and the same key in the table: they would be merged."""
    quieter = light_scenario.excitation.model_copy(update={"amplitude_v": amplitude_v})
    other = light_scenario.model_copy(update={"excitation": quieter} if amplitude_v else {})
    with pytest.raises(InputError, match="2 scenarios of this bench are called so") as refusal:
        BenchPlan((light_scenario, other), 1, (Entry("quadrature"),), Limits())
    assert "'quick'" in refusal.value.where


def test_seeds_derive_from_names() -> None:
    seeds = {derived_seed(base, name, k) for base in (0, 1) for name in ("quick", "bff") for k in range(3)}
    assert len(seeds) == 12
    assert derived_seed(0, "quick", 0) == derived_seed(0, "quick", 0)


def test_a_pool_of_processes_gives_the_same_table(serial, plan, tmp_path) -> None:
    pandas.testing.assert_frame_equal(comparable(bench(plan, tmp_path, process_pool(2))), comparable(serial))


def test_an_interrupted_bench_goes_on_and_ends_with_the_same_table(serial, plan, tmp_path, monkeypatch) -> None:
    done = []

    def first_only(cells, make, work):
        for cell, rows in in_order_of_completion(cells, make, work):
            done.append(cell.key)
            yield cell, rows
            raise KeyboardInterrupt

    monkeypatch.setattr(bench_module, "in_order_of_completion", first_only)
    with pytest.raises(KeyboardInterrupt):
        bench(plan, tmp_path)
    monkeypatch.undo()
    # The generator stopped after the first cell was handed over, before it was kept: half a file must not count.
    (tmp_path / "cells").mkdir(exist_ok=True)
    (tmp_path / "cells" / f"{plan.cells()[0].key}.json").write_text('{"version": "')
    reports: list[tuple[float, str]] = []
    table = bench(plan, tmp_path, progress=lambda fraction, message: reports.append((fraction, message)))
    pandas.testing.assert_frame_equal(comparable(table), comparable(serial))
    again: list[float] = []
    bench(plan, tmp_path, progress=lambda fraction, _: again.append(fraction))
    assert reports[-1][0] == again[0] == 1.0


def test_a_scenario_that_cannot_be_simulated_is_a_row_with_a_reason(light_scenario, tmp_path, monkeypatch) -> None:
    def refuse(_scenario):
        raise InputError("scenario", "no rest", "hang it higher")

    monkeypatch.setattr("vgvt.bench.cell.simulate", refuse)
    table = bench(BenchPlan((light_scenario,), 1, (Entry("quadrature"),), Limits()), tmp_path)
    assert table["outcome"].tolist() == ["failed"]
    assert "no rest" in table["reason"].iloc[0]
    assert summary(table)["failed"].tolist() == [1]


def test_tables_survive_parquet_and_csv(serial, tmp_path) -> None:
    write_parquet(tmp_path / "t.parquet", serial)
    pandas.testing.assert_frame_equal(read_table(tmp_path / "t.parquet"), serial)
    write_csv(tmp_path / "t.csv", serial)
    pandas.testing.assert_frame_equal(read_table(tmp_path / "t.csv"), serial, rtol=1e-8)


def test_a_damaged_table_is_refused_with_its_name(tmp_path) -> None:
    (tmp_path / "t.parquet").write_bytes(b"PAR1 cut in half")
    with pytest.raises(InputError, match=r"t\.parquet"):
        read_table(tmp_path / "t.parquet")
    with pytest.raises(InputError, match="no such file"):
        read_table(tmp_path / "none.parquet")
    (tmp_path / "other.csv").write_text("a,b\n1,2\n")
    with pytest.raises(InputError, match="scenario"):
        read_table(tmp_path / "other.csv")


def test_an_empty_table_has_the_columns() -> None:
    assert list(table_of([]).columns) == list(COLUMNS)


def test_a_cluster_that_is_not_there_is_named() -> None:
    with pytest.raises(InputError, match="no address"):
        dask_cluster("localhost", 1)


@pytest.mark.slow
def test_a_dask_cluster_that_loses_a_worker_gives_the_same_table(light_scenario, tmp_path) -> None:
    import distributed

    plan = BenchPlan((light_scenario,), seeds=6, entries=(Entry("quadrature"),), limits=Limits())
    serial = bench(plan, tmp_path / "serial")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None
    ) as cluster:
        victim = next(iter(cluster.workers.values())).pid
        seen = threading.Event()

        def kill_in_the_middle() -> None:
            seen.wait(60)
            time.sleep(0.3)
            os.kill(victim, signal.SIGKILL)

        killer = threading.Thread(target=kill_in_the_middle)
        killer.start()
        table = bench(
            plan,
            tmp_path / "dask",
            dask_cluster(cluster.scheduler_address, 2),
            lambda fraction, _: seen.set() if fraction > 0 else None,
        )
        killer.join()
    pandas.testing.assert_frame_equal(comparable(table), comparable(serial))


def _die_once(cell):
    """Kills its worker the first time it sees a cell; the folder in the environment remembers."""
    from pathlib import Path

    mark = Path(os.environ["VGVT_TEST_MARKS"]) / cell.key
    if not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return run_cell(cell)


@pytest.mark.slow
def test_a_pool_that_loses_a_worker_gives_the_same_rows(serial, plan, tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("VGVT_TEST_MARKS", str(tmp_path))
    rows = [row for _, done in in_order_of_completion(plan.cells()[:1], process_pool(1), _die_once) for row in done]
    pandas.testing.assert_frame_equal(
        comparable(table_of(rows)), comparable(serial[serial["seed_number"] == 0].reset_index(drop=True))
    )


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="asks /proc who is alive")
def test_workers_do_not_outlive_whoever_began_them(tmp_path: Path) -> None:
    """One that was killed had told nobody: its workers went on to the end of what they were at, for minutes.

    Nor does what they had on disk, theirs to take away then.
    """
    told, temporary = tmp_path / "worker.txt", tmp_path / "temporary"
    temporary.mkdir()
    code = f"""
import os, tempfile, time
from pathlib import Path
from vgvt.bench.executors import process_pool

def at_work():
    tempfile.mkdtemp(prefix="vgvt-contest-")
    Path({str(told)!r}).write_text(str(os.getpid()))
    time.sleep(600)

if __name__ == "__main__":
    with process_pool(1)() as pool:
        pool.submit(at_work).result()
"""
    script = tmp_path / "script.py"
    script.write_text(code)
    parent = subprocess.Popen([sys.executable, str(script)], env={**os.environ, "TMPDIR": str(temporary)})
    try:
        assert soon(lambda: told.exists() and told.read_text().isdigit())
        worker = int(told.read_text())
        assert _alive(worker)
    finally:
        parent.kill()
        parent.wait()
    assert soon(lambda: not _alive(worker))
    assert list(temporary.iterdir()) == []


def _alive(process: int) -> bool:
    """Whether a process runs; one that is dead but unburied does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
