"""``vgvt run``: simulate, identify, score and report, into one folder."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vgvt.cli.console import log, show
from vgvt.cli.document import document_text, write_document
from vgvt.cli.identify import claimed, made_identifier, write_claim
from vgvt.cli.options import BandOption, EngineOption, JsonOption, ScenarioArgument, SeedOption
from vgvt.cli.score import card_document, fitted, scored
from vgvt.cli.simulate import ForceOption, OutOption, Simulated, simulated, simulation_document

if TYPE_CHECKING:
    from vgvt.data import FrfFit, Scorecard
    from vgvt.files.claim import Claim


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """What the identifiers said of a simulated campaign and how right they were."""

    claims: dict[str, Claim]
    scorecards: dict[str, Scorecard]
    fits: dict[str, FrfFit]
    timing_s: dict[str, float]


def run(
    scenario: ScenarioArgument,
    identifier: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="An identifier; may be given again. Default: auto.")
    ] = None,
    setting: Annotated[
        list[str] | None,
        typer.Option(metavar="[NAME.]KEY=VALUE", help="A setting of the identifier (NAME); may be given again."),
    ] = None,
    band: BandOption = None,
    out: OutOption = None,
    seed: SeedOption = None,
    engine: EngineOption = None,
    report: Annotated[bool, typer.Option("--report/--no-report", help="Write the one-file page report.html.")] = True,
    force: ForceOption = False,
    as_json: JsonOption = False,
) -> int:
    """Run a virtual test from the scenario to the score table.

    A folder that already holds the same scenario's campaign is taken up where
    it stands: only identification, score and report are done again.
    """
    from vgvt.cli.options import settings_by_identifier

    start = time.perf_counter()
    # Made before the simulation, so that a misspelt name costs no time.
    names = identifier or ["auto"]
    settings = settings_by_identifier(setting or [], names)
    methods = {name: made_identifier(name, settings[name]) for name in names}
    result = simulated(scenario, out, seed, engine, force)
    for record in result.campaign.runs:
        if record.overloaded:
            where = f" ({'; '.join(record.notes)})" if record.notes else ""
            channels = ", ".join(record.overloaded)
            log(f"run {record.run}: {channels} overloaded{where}; the clipped record is used as it is")
    try:
        judged = _judge(result, methods, band)
        if report:
            _write_report(result, judged)
        else:
            result.folder.report.unlink(missing_ok=True)
        judged.timing_s["total"] = time.perf_counter() - start
        _complete_manifest(result, judged)
    except BaseException:
        log(f"kept in {result.folder.path}: campaign and truth; the same command takes them up again")
        raise
    if as_json:
        write_document(_run_document(result, judged, report))
        return 0
    _show(result, judged, report)
    return 0


def _judge(result: Simulated, methods: dict[str, Any], band: tuple[float, float] | None) -> Judged:
    from vgvt.files.atomically import replacing
    from vgvt.files.claim import claim_document

    judged = Judged({}, {}, {}, dict(result.timing_s))
    for name, method in methods.items():
        start = time.perf_counter()
        claim = claimed(method, result.campaign, band)
        judged.timing_s[f"identify_{name}"] = time.perf_counter() - start
        card, fit = scored(result.truth, claim, band), fitted(result.campaign, claim, band)
        write_claim(result.folder.claim(name), claim_document(claim))
        with replacing(result.folder.scorecard(name)) as temporary:
            temporary.write_text(document_text(card_document(card, fit)), encoding="utf-8")
        judged.claims[name], judged.scorecards[name] = claim, card
        if fit is not None:
            judged.fits[name] = fit
    return judged


def _write_report(result: Simulated, judged: Judged) -> None:
    from vgvt.signals import estimate_frf
    from vgvt.view import write_report

    start = time.perf_counter()
    write_report(
        result.folder.report,
        title=f"{result.scenario.name}: virtual ground vibration test",
        campaign=result.campaign,
        frf=estimate_frf(result.campaign, "auto"),
        claims={name: claim.model for name, claim in judged.claims.items()},
        truth=result.truth,
        scorecards=judged.scorecards,
        facts=_facts(result),
        fits=judged.fits,
    )
    judged.timing_s["report"] = time.perf_counter() - start


def _facts(result: Simulated) -> dict[str, str]:
    from vgvt import __version__

    scenario = result.scenario
    return {
        "aircraft": scenario.airframe.name,
        "scenario": f"{scenario.name}: {scenario.summary}",
        "engine": scenario.simulation.engine,
        "seed": str(scenario.seed),
        "made by": f"vgvt {__version__}",
    }


def _complete_manifest(result: Simulated, judged: Judged) -> None:
    from vgvt.cli.memory import peak_memory_mib
    from vgvt.files import write_manifest

    before = result.folder.manifest_document() or {}
    facts = {key: before[key] for key in ("scenario", "scenario_sha256", "engine")}
    facts["identifiers"] = {name: claim.model.settings for name, claim in judged.claims.items()}
    # A resumed run simulated nothing: an old simulation's time beside a new total would add up to nonsense.
    facts["timing_s"] = judged.timing_s
    facts["peak_memory_mib"] = peak_memory_mib()
    write_manifest(result.folder.path, seeds=before["seeds"], facts=facts)


def _run_document(result: Simulated, judged: Judged, report: bool) -> dict[str, Any]:
    from vgvt.cli.memory import peak_memory_mib

    return {
        **simulation_document(result),
        "identifiers": {name: card_document(card, judged.fits.get(name)) for name, card in judged.scorecards.items()},
        "report": result.folder.report if report else None,
        "timing_s": judged.timing_s,
        "peak_memory_mib": peak_memory_mib(),
    }


def _show(result: Simulated, judged: Judged, report: bool) -> None:
    from vgvt.view import scorecard_table

    for card in judged.scorecards.values():
        show(scorecard_table(card))
        for line in (*card.remarks, *card.advice):
            log(line)
    total = judged.timing_s["total"]
    simulation = sum(result.timing_s.values())
    spent = f"{total:.1f} s" + ("" if result.resumed else f", of which simulation {simulation:.1f} s")
    page = f"; open {result.folder.report} in a browser" if report else ""
    show(f"{spent}; files in {result.folder.path}{page}")
