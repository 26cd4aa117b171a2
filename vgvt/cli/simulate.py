"""``vgvt simulate``: a scenario becomes a campaign and, sealed beside it, the truth."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vgvt.cli.boundary import CommandError
from vgvt.cli.console import log, progress, show
from vgvt.cli.document import write_document
from vgvt.cli.new_folders import none_left_empty
from vgvt.cli.options import EngineOption, JsonOption, ScenarioArgument, SeedOption

if TYPE_CHECKING:
    from vgvt.cli.run_folder import RunFolder
    from vgvt.data import Campaign, Truth
    from vgvt.scenario.model import Scenario
    from vgvt.simulation import SimulationResult

OutOption = Annotated[
    Path | None, typer.Option("--out", metavar="FOLDER", help="Folder for the files; runs/SCENARIO when left out.")
]
ForceOption = Annotated[bool, typer.Option("--force", help="Replace the run that the folder holds.")]


@dataclass(frozen=True, slots=True, eq=False)
class Simulated:
    """A campaign on disk, the truth beside it and how long it took."""

    folder: RunFolder
    scenario: Scenario
    campaign: Campaign
    truth: Truth
    timing_s: dict[str, float]
    resumed: bool


def simulate(
    scenario: ScenarioArgument,
    out: OutOption = None,
    seed: SeedOption = None,
    engine: EngineOption = None,
    force: ForceOption = False,
    as_json: JsonOption = False,
) -> int:
    """Simulate the test of a scenario and keep its campaign and its sealed truth."""
    result = simulated(scenario, out, seed, engine, force)
    if as_json:
        write_document(simulation_document(result))
        return 0
    from vgvt.view import modal_table

    truth, high_hz = result.truth, result.campaign.band_hz[1]
    show(
        modal_table(truth.bare.band(0.0, high_hz), f"true modes of the bare airframe, up to {high_hz:g} Hz"),
        modal_table(truth.as_tested[0].band(0.0, high_hz), f"true modes as tested in run {truth.runs[0]}"),
        f"campaign in {result.folder.campaign}",
    )
    return 0


def simulated(name: str, out: Path | None, seed: int | None, engine: str | None, force: bool) -> Simulated:
    """Simulate into a run folder, or take the campaign that it already holds."""
    from vgvt.cli.options import as_chosen, resolved_scenario
    from vgvt.cli.run_folder import default_folder, prepared_folder, scenario_sha256

    original = resolved_scenario(name, None, None)
    # Not read again: a pipe gives its text once.
    scenario = as_chosen(original, seed, engine)
    path = out if out is not None else default_folder(scenario, original.seed, original.simulation.engine)
    was_there = path.exists()
    # Ctrl-C may come at any point after the folders were made, of which a run's last is that of the truth.
    with none_left_empty(path / "sealed"):
        folder, reusable = prepared_folder(path, scenario_sha256(scenario), force)
        timing = {} if reusable else _simulate_into(folder, scenario, was_there)
    if reusable:
        log(f"took the campaign that {path} already holds; --force simulates it again")
    from vgvt.files import read_campaign
    from vgvt.files.truth import read_truth

    # Read back even when just written, so that a first and a resumed run see the same numbers.
    campaign, truth = read_campaign(folder.campaign), read_truth(folder.truth)
    return Simulated(folder, scenario, campaign, truth, timing, reusable)


def simulation_document(result: Simulated) -> dict[str, Any]:
    """The document of ``vgvt simulate``; ``vgvt run`` adds the identifiers to it."""
    from vgvt.files.claim import mode_documents
    from vgvt_scoreboard import merge_truth

    # The sealed truth reaches far above the band; a reader wants what the test could have met.
    shown_hz = 2.0 * result.campaign.band_hz[1]
    return {
        "scenario": result.scenario.name,
        "folder": result.folder.path,
        "campaign": result.folder.campaign,
        "seed": result.scenario.seed,
        "engine": result.scenario.simulation.engine,
        "resumed": result.resumed,
        "truth": {
            "bare": mode_documents(result.truth.bare.band(0.0, shown_hz)),
            "as_tested": mode_documents(merge_truth(result.truth).model.band(0.0, shown_hz)),
        },
        "overloaded": overloads(result.campaign),
        "timing_s": dict(result.timing_s),
    }


def overloads(campaign: Campaign) -> dict[int, list[str]]:
    """The channels that clipped, by run; nothing where none did."""
    return {record.run: list(record.overloaded) for record in campaign.runs if record.overloaded}


def _simulate_into(folder: RunFolder, scenario: Scenario, was_there: bool) -> dict[str, float]:
    from vgvt.cli.described import say_what_is_not_as_described
    from vgvt.simulation import simulate as simulate_scenario

    say_what_is_not_as_described(scenario)
    try:
        with (
            _untouched_on_failure(folder.path, was_there, "simulating"),
            progress(f"simulate {scenario.name}") as report,
        ):
            result = simulate_scenario(scenario, progress=report)
    except FloatingPointError as error:
        raise CommandError(str(error), "or try --engine linear") from error
    return _write_into(folder, scenario, result, was_there)


def _write_into(folder: RunFolder, scenario: Scenario, result: SimulationResult, was_there: bool) -> dict[str, float]:
    """Write everything beside its place, then swap: until then what the folder held stays whole."""
    from vgvt.cli.run_folder import scenario_sha256
    from vgvt.files import write_campaign, write_manifest
    from vgvt.files.truth import write_truth
    from vgvt.scenario import to_toml

    facts = {
        "scenario": scenario.name,
        "scenario_sha256": scenario_sha256(scenario),
        "engine": scenario.simulation.engine,
    }
    start = time.perf_counter()
    with _untouched_on_failure(folder.path, was_there, "writing"), folder.staging() as staged:
        staged.scenario.write_text(to_toml(scenario), encoding="utf-8")
        write_truth(staged.truth, result.truth)
        write_campaign(staged.campaign, result.campaign, manifest={**facts, "seed": scenario.seed})
        timing = {**result.timing_s, "write": time.perf_counter() - start}
        write_manifest(staged.path, seeds={"scenario": scenario.seed}, facts={**facts, "timing_s": timing})
        folder.take_over(staged)
    return timing


@contextmanager
def _untouched_on_failure(path: Path, was_there: bool, doing: str) -> Iterator[None]:
    """Say what the folder holds when the work on a run that is to come into it ends early."""
    from vgvt.cli.run_folder import HalfSwappedError

    try:
        yield
    except HalfSwappedError:
        raise
    except BaseException:
        kept = f"{path} is as it was" if was_there else f"nothing was kept in {path}"
        log(f"stopped while {doing}; {kept}")
        raise
