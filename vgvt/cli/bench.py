"""``vgvt bench``: scenarios × seeds × identifiers as one long table."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vgvt.cli.console import log, progress, show
from vgvt.cli.document import write_document
from vgvt.cli.options import BandOption, JsonOption
from vgvt.cli.results_folder import CELLS, checked_folder, telling_what_is_kept

if TYPE_CHECKING:
    import pandas

    from vgvt.bench.bench import BenchPlan
    from vgvt.bench.executors import MakeExecutor

_LIMITS = "Limits"
_WHERE = "Where it runs"


def bench(
    scenarios: Annotated[
        list[str] | None,
        typer.Argument(metavar="SCENARIO...", help="Bundled names or .toml files. Default: every bundled scenario."),
    ] = None,
    identifier: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME[:KEY=VALUE,...]", help="An entry; may be given again. Default: every installed identifier."
        ),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Campaigns of each scenario.")] = 5,
    seed: Annotated[int, typer.Option(min=0, help="Where the derived seeds start.")] = 0,
    engine: Annotated[
        str, typer.Option(metavar="linear|mujoco|own", help="Engine of the simulation; own: each scenario's own.")
    ] = "linear",
    band: BandOption = None,
    out: Annotated[
        Path, typer.Option(metavar="FOLDER", help="Where the table and what is done so far are kept.")
    ] = Path("bench"),
    csv: Annotated[bool, typer.Option("--csv", help="Write the table as CSV too.")] = False,
    page: Annotated[bool, typer.Option("--page/--no-page", help="Write the scoreboard as one page.")] = True,
    against: Annotated[
        Path | None, typer.Option(metavar="BASELINE", help="A baseline's .csv: fail where a method got worse.")
    ] = None,
    baseline: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a baseline for later benches to be held against.")
    ] = None,
    time_limit: Annotated[
        float, typer.Option(min=0.1, metavar="SECONDS", help="Time of one identification.", rich_help_panel=_LIMITS)
    ] = 60.0,
    memory_limit: Annotated[
        float, typer.Option(min=16, metavar="MIB", help="Memory of one identification.", rich_help_panel=_LIMITS)
    ] = 2048.0,
    workers: Annotated[
        int | None, typer.Option(min=0, help="Processes; 0: no pool. Default: one a core.", rich_help_panel=_WHERE)
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(
            metavar="local|ADDRESS", help="A Dask cluster: tcp://HOST:PORT, or local.", rich_help_panel=_WHERE
        ),
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Judge identifiers blind: every scenario with every seed before every one of them.

    Interrupted, the same command goes on where it stopped. Ends with status 1
    where a method got worse than the baseline of --against.
    """
    from vgvt.bench.bench import bench as work_off
    from vgvt.bench.guard import compare, read_baseline, write_baseline
    from vgvt.bench.table import write_csv, write_parquet
    from vgvt.cli.written_file import checked_file, is_baseline

    if baseline is not None:
        checked_file(baseline, "baseline", is_baseline)
    before = None if against is None else read_baseline(against)
    checked_folder(out, (CELLS, "bench.parquet"))
    plan = _plan(scenarios, identifier, seeds, seed, engine, band, time_limit, memory_limit)
    with telling_what_is_kept(out), progress("bench") as report:
        table = work_off(plan, out, executor_for(workers, cluster), report)
    paths = {"table": out / "bench.parquet"}
    write_parquet(paths["table"], table)
    if csv:
        paths["csv"] = out / "bench.csv"
        write_csv(paths["csv"], table)
    if page:
        paths["page"] = out / "scoreboard.html"
        _write_page(paths["page"], table)
    if baseline is not None:
        paths["baseline"] = baseline
        write_baseline(baseline, table)
    comparison = None if before is None else compare(before, table)
    worse = 0 if comparison is None else int((comparison["verdict"] == "worse").sum())
    if as_json:
        write_document(_document(table, paths, comparison))
    else:
        _show(table, paths, comparison)
    return 1 if worse else 0


def _plan(
    scenarios: list[str] | None,
    identifiers: list[str] | None,
    seeds: int,
    base_seed: int,
    engine: str,
    band: tuple[float, float] | None,
    time_limit_s: float,
    memory_limit_mib: float,
) -> BenchPlan:
    from vgvt.bench.bench import BenchPlan, entries_of
    from vgvt.bench.umpire import Limits
    from vgvt.cli.described import described_scenario
    from vgvt.data import InputError
    from vgvt.identification import available_identifiers, make_identifier
    from vgvt.scenario.library import bundled_scenarios

    if engine not in ("linear", "mujoco", "own"):
        raise InputError("--engine", f"there is no engine {engine!r}", "write linear, mujoco or own")
    entries = entries_of(identifiers or list(available_identifiers()))
    for entry in entries:
        make_identifier(entry.identifier, **dict(entry.settings))  # a misspelt name costs no time
    return BenchPlan(
        scenarios=tuple(described_scenario(name) for name in scenarios or bundled_scenarios()),
        seeds=seeds,
        entries=entries,
        limits=Limits(time_limit_s, memory_limit_mib),
        base_seed=base_seed,
        engine=None if engine == "own" else engine,
        band_hz=band,
    )


def executor_for(workers: int | None, cluster: str | None) -> MakeExecutor | None:
    """Where cells are worked off: a Dask cluster, a pool of so many processes, or here."""
    from vgvt.bench.executors import dask_cluster, process_pool
    from vgvt.cli.cores import available_cores

    count = available_cores() if workers is None else workers
    if cluster is not None:
        return dask_cluster(cluster, max(count, 1))
    return process_pool(count) if count > 1 else None


def _write_page(path: Path, table: pandas.DataFrame) -> None:
    from vgvt.view.scoreboard_page import write_scoreboard_page

    write_scoreboard_page(path, table)


def _document(table: pandas.DataFrame, paths: dict[str, Path], comparison: pandas.DataFrame | None) -> dict[str, Any]:
    from vgvt.bench.bench import failures
    from vgvt.bench.summary import summary

    lost = failures(table)
    document: dict[str, Any] = {
        **paths,
        "rows": len(table),
        "failures": lost[["scenario", "seed_number", "entry", "reason"]].to_dict("records"),
        "summary": summary(table).astype(object).where(lambda frame: frame.notna(), None).to_dict("records"),
    }
    if comparison is not None:
        document["against"] = comparison.astype(object).where(comparison.notna(), None).to_dict("records")
    return document


def _show(table: pandas.DataFrame, paths: dict[str, Path], comparison: pandas.DataFrame | None) -> None:
    from vgvt.bench.summary import summary
    from vgvt.view.bench_table import bench_table, comparison_table

    show(bench_table(summary(table)))
    log_failures(table)
    if comparison is not None:
        show(comparison_table(comparison))
    show(f"{len(table)} rows; " + ", ".join(f"{name} {path}" for name, path in paths.items()))


def log_failures(table: pandas.DataFrame) -> None:
    """Say how many rows have no claim and why, and what to do about those that the clock stopped."""
    from vgvt.bench.bench import failures
    from vgvt.bench.rows import OUT_OF_TIME

    reasons = failures(table)["reason"]
    for reason, count in reasons.value_counts().head(10).items():
        log(f"{count} without a claim: {reason}")
    if reasons.str.startswith(OUT_OF_TIME).any():
        log("The same command, given again, tries once more what ran out of time.")
