"""``vgvt sweep``: a scenario with some of its fields changed, simulated, identified and scored many times over."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vgvt.cli.bench import executor_for, log_failures
from vgvt.cli.console import log, progress, show
from vgvt.cli.document import write_document
from vgvt.cli.options import BandOption, JsonOption, ScenarioArgument
from vgvt.cli.results_folder import CELLS, checked_folder, telling_what_is_kept

if TYPE_CHECKING:
    import pandas

    from vgvt.scenario.sweeps import Variant


def sweep(
    scenario: ScenarioArgument,
    setting: Annotated[
        list[str],
        typer.Option(
            "--set", metavar="KEY=VALUES", help="A key and its values: a,b,c, or low..high[:count][:log]. Repeatable."
        ),
    ],
    design: Annotated[
        str, typer.Option(metavar="grid|list|latin", help="Every combination, value by value, or a latin hypercube.")
    ] = "grid",
    samples: Annotated[int, typer.Option(min=1, help="Points of a latin hypercube.")] = 20,
    design_seed: Annotated[int, typer.Option(min=0, help="Seed of a latin hypercube.")] = 0,
    identifier: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME[:KEY=VALUE,...]", help="An entry; may be given again. Default: quadrature."),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Campaigns of each variant.")] = 1,
    seed: Annotated[int, typer.Option(min=0, help="Where the derived seeds start.")] = 0,
    engine: Annotated[
        str, typer.Option(metavar="linear|mujoco|own", help="Engine of the simulation; own: the scenario's.")
    ] = "linear",
    band: BandOption = None,
    out: Annotated[
        Path, typer.Option(metavar="FOLDER", help="Where the table and what is done so far are kept.")
    ] = Path("sweep"),
    csv: Annotated[bool, typer.Option("--csv", help="Write the table as CSV too.")] = False,
    time_limit: Annotated[float, typer.Option(min=0.1, metavar="SECONDS", help="Time of one identification.")] = 120.0,
    workers: Annotated[int | None, typer.Option(min=0, help="Processes; 0: no pool. Default: one a core.")] = None,
    cluster: Annotated[
        str | None, typer.Option(metavar="local|ADDRESS", help="A Dask cluster: tcp://HOST:PORT, or local.")
    ] = None,
    as_json: JsonOption = False,
) -> int:
    r"""Change fields of a scenario and see what becomes of the identification.

    Keys are those of the scenario file: excitation.duration_s, airframe.beam\[wing].cells. Interrupted, the
    same command goes on where it stopped.
    """
    from vgvt.bench.bench import BenchPlan, bench, entries_of
    from vgvt.bench.swept import with_swept_columns, write_swept_parquet
    from vgvt.bench.table import write_csv
    from vgvt.bench.umpire import Limits
    from vgvt.data import InputError
    from vgvt.identification import make_identifier

    if engine not in ("linear", "mujoco", "own"):
        raise InputError("--engine", f"there is no engine {engine!r}", "write linear, mujoco or own")
    its_engine = None if engine == "own" else engine
    variants = _variants(scenario, setting, design, samples, design_seed, its_engine)
    entries = entries_of(identifier or ["quadrature"])
    for entry in entries:
        make_identifier(entry.identifier, **dict(entry.settings))  # a misspelt name costs no time
    checked_folder(out, (CELLS, "sweep.parquet"))
    plan = BenchPlan(
        scenarios=tuple(v.scenario for v in variants),
        seeds=seeds,
        entries=entries,
        limits=Limits(time_s=time_limit),
        base_seed=seed,
        engine=its_engine,
        band_hz=band,
    )
    with telling_what_is_kept(out), progress("sweep") as report:
        table = with_swept_columns(bench(plan, out, executor_for(workers, cluster), report), variants)
    paths = {"table": out / "sweep.parquet"}
    write_swept_parquet(paths["table"], table)
    if csv:
        paths["csv"] = out / "sweep.csv"
        write_csv(paths["csv"], table)
    if as_json:
        write_document(_document(table, variants, paths))
    else:
        _show(table, variants, paths)
    return 0


def _variants(
    name: str, settings: list[str], design: str, samples: int, seed: int, engine: str | None
) -> tuple[Variant, ...]:
    from vgvt.bench.swept import require_free
    from vgvt.cli.described import described_scenario
    from vgvt.data import InputError
    from vgvt.effects.places import require_in_the_runs, require_on_aircraft
    from vgvt.effects.whole_numbers import whole_parameters
    from vgvt.scenario.sweeps import DESIGNS, sweep
    from vgvt.scenario.swept_axis import Axis

    if design not in DESIGNS:
        raise InputError("--design", f"there is no design {design!r}", f"write {', '.join(DESIGNS)}")
    axes = [Axis.parse(text) for text in settings]
    require_free([axis.key for axis in axes], engine)
    variants = sweep(described_scenario(name), axes, design, samples, seed, whole_parameters())  # checked above
    for variant in variants:
        require_on_aircraft(variant.scenario)  # a misspelt parameter of an effect costs no time
        require_in_the_runs(variant.scenario)
    if design == "latin" and len(variants) < samples:
        log(f"vgvt: {samples} samples are {len(variants)} different variants, each of which is tried once")
    return variants


def _document(table: pandas.DataFrame, variants: tuple[Variant, ...], paths: dict[str, Path]) -> dict[str, Any]:
    lost = table[table["outcome"] == "failed"]
    return {
        **paths,
        "rows": len(table),
        "variants": [{"scenario": v.scenario.name, "values": v.values} for v in variants],
        "failures": lost[["scenario", "seed_number", "entry", "reason"]].to_dict("records"),
        "summary": _summary(table, list(variants[0].values)).to_dict("records"),
    }


def _summary(table: pandas.DataFrame, keys: list[str]) -> pandas.DataFrame:
    """One row per variant and entry: modes found, missed and false, and the mean size of the errors."""
    grouped = table.groupby(["scenario", *keys, "entry"], sort=True, dropna=False)
    counts = {
        status: grouped["status"].agg(lambda column, status=status: int((column == status).sum()))
        for status in ("found", "missed", "false")
    }
    errors = {
        f"mean_abs_{name}": grouped[name].agg(lambda column: column.abs().mean())
        for name in ("frequency_error_percent", "damping_error_percent")
    }
    import pandas

    frame = pandas.DataFrame({**counts, **errors}).reset_index()
    return frame.astype(object).where(frame.notna(), None)


def _show(table: pandas.DataFrame, variants: tuple[Variant, ...], paths: dict[str, Path]) -> None:
    from rich.table import Table
    from rich.text import Text

    keys = list(variants[0].values)
    shown = Table(title=f"{len(variants)} variants")
    for heading in (*keys, "entry", "found", "missed", "false", "mean |Δf| %", "mean |Δζ| %"):
        shown.add_column(Text(heading), justify="right")
    for row in _summary(table, keys).to_dict("records"):
        errors = (row["mean_abs_frequency_error_percent"], row["mean_abs_damping_error_percent"])
        numbers = ("" if e is None else f"{e:.3g}" for e in errors)
        shown.add_row(*(str(row[key]) for key in (*keys, "entry", "found", "missed", "false")), *numbers)
    show(shown)
    log_failures(table)
    show(f"{len(table)} rows; " + ", ".join(f"{name} {path}" for name, path in paths.items()))
