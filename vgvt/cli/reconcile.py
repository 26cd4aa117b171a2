"""``vgvt reconcile``: what does a measured campaign say that a scenario lacks?"""

from __future__ import annotations

import re
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vgvt.cli.console import bullets, log, progress, show
from vgvt.cli.document import write_document
from vgvt.cli.options import BandOption, JsonOption, LeaveOutFaultyOption
from vgvt.cli.reconcile_placebos import FEWEST, refuse_beside_placebos, rehearse

if TYPE_CHECKING:
    from vgvt.cli.reconcile_folder import ReconcileFolder
    from vgvt.data import Campaign
    from vgvt.reconcile.decision.verdict import Verdict
    from vgvt.reconcile.question.hypothesis import Hypothesis
    from vgvt.reconcile.question.problem import Problem
    from vgvt.reconcile.question.thresholds import Thresholds
    from vgvt.scenario.model import Scenario

_LINES = 500
_FEWEST_LINES = 50
_POWER_SHARE = 0.1
_MOST_PROCESSES = 4


def reconcile(
    campaign: Annotated[
        str | None,
        typer.Argument(
            metavar="[CAMPAIGN]", help="What was measured, as in vgvt identify. Left out with --power alone."
        ),
    ] = None,
    scenario: Annotated[
        str,
        typer.Option(
            "--scenario", metavar="SCENARIO", help="Always needed: what is believed, a bundled name or a .toml file."
        ),
    ] = "",
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="FOLDER", help="Folder for the files; reconciled/CAMPAIGN-SCENARIO when left out."
        ),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Seed of the hold-out split, instead of the scenario's own.")
    ] = None,
    band: BandOption = None,
    lines: Annotated[
        int, typer.Option(min=_FEWEST_LINES, help="About how many lines of each response to use.")
    ] = _LINES,
    only: Annotated[
        list[str] | None, typer.Option("--only", metavar="EFFECT", help="Try this effect only; may be given again.")
    ] = None,
    without: Annotated[
        list[str] | None, typer.Option("--without", metavar="EFFECT", help="Leave this effect out; may be given again.")
    ] = None,
    power: Annotated[
        bool, typer.Option("--power", help="Say how small each effect could be and still be seen.")
    ] = False,
    placebos: Annotated[
        int | None,
        typer.Option(
            "--placebos", min=FEWEST, metavar="N", help="Try N campaigns of SCENARIO in which nothing is missing."
        ),
    ] = None,
    thresholds: Annotated[
        Path | None, typer.Option("--thresholds", metavar="FILE", help="Limits of one's own test, as --placebos wrote.")
    ] = None,
    leave_out_faulty: LeaveOutFaultyOption = False,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes. Default: one a core, at most four.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Do it again where the answer is there already.")] = False,
    as_json: JsonOption = False,
) -> int:
    """Trace what a scenario does not explain of a campaign to an effect, or say that none does.

    Writes reconciled.toml, verdict.json and report.html. Exit status 0 with
    any verdict. Without CAMPAIGN, --power says before the test what it could see,
    and --placebos how often it would be given a name when nothing is missing.
    """
    from vgvt.cli.options import resolved_scenario
    from vgvt.cli.reconcile_power import power_before_the_test, refuse_what_needs_a_campaign, tell_of_cut
    from vgvt.data import InputError
    from vgvt.reconcile.question.thresholds import thresholds_of

    if not scenario:
        raise InputError("--scenario", "is missing", "write --scenario NAME or --scenario FILE.toml: what is believed")
    believed = resolved_scenario(scenario, seed, None, own_runs=campaign is None)
    chosen = chosen_effects(only or [], without or [])
    effects = undeclared(believed, chosen)
    if only:
        tell_of_declared(believed, sorted(chosen.keys() - effects.keys()))
    limits = None if thresholds is None else thresholds_of(thresholds)
    if placebos is not None:
        refuse_beside_placebos(
            {"CAMPAIGN": campaign is not None, "--power": power, "--leave-out-faulty": leave_out_faulty}
        )
        return rehearse(
            believed, placebos, effects, limits, out, band=band, lines=lines, workers=_processes(workers),
            force=force, as_json=as_json,
        )  # fmt: skip
    if campaign is None:
        if not power:
            advice = "name what was measured, or add --power or --placebos N to ask what a test could see"
            raise InputError("CAMPAIGN", "is missing", advice)
        refuse_what_needs_a_campaign(
            {"--workers": workers is not None, "--leave-out-faulty": leave_out_faulty, "--force": force}
        )
        return power_before_the_test(believed, effects, out, band, lines, as_json, limits)
    from vgvt.cli.new_folders import none_left_empty
    from vgvt.cli.reconcile_folder import ReconcileFolder, fingerprint_of
    from vgvt.cli.soundness import sound_campaign
    from vgvt.reconcile.question.suitable import banded, check_suitable, remarks

    measured = banded(sound_campaign(campaign, leave_out_faulty, still_mounted=True), band)
    check_suitable(measured, believed)
    for remark in remarks(measured, believed):
        log(remark)
    tell_of_cut(band, measured.band_hz, measured.name)
    folder = ReconcileFolder(out if out is not None else own_folder(measured.name, believed.name))
    options = {"lines": lines, "power": power, "thresholds": None if limits is None else asdict(limits)}
    fingerprint = fingerprint_of(measured, believed, effects, options)
    with none_left_empty(folder.cache), _alone(folder):
        folder.sweep()
        if force:
            folder.forget()
        document = None if force else folder.answer(fingerprint)
        if document is None:
            document = _reconciled(
                measured, believed, effects, folder, lines, limits, power, fingerprint, _processes(workers)
            )
        else:
            log(f"took the verdict that {folder.path} already holds; --force does it again")
            if document["reconciled_edited"]:
                log(f"{folder.scenario} was edited since: the verdict speaks of what it said before")
    not_tried: dict[str, str] = document.get("not_tried", {})
    for name in sorted(not_tried.keys() & {*(only or ())}):
        log(f"--only: {name} was not tried, as no variant of it could show in this campaign: {not_tried[name]}")
    if as_json:
        write_document(document)
        return 0
    _show(document, folder)
    return 0


def own_folder(campaign: str, scenario: str) -> Path:
    """``reconciled/CAMPAIGN-SCENARIO``: one folder, and there, whatever records are called (``GVT 2/3``, ``../a``)."""
    name = re.sub(r'[\x00-\x1f\x7f/\\:*?"<>|]+', "-", campaign).lstrip("-. ")
    return Path("reconciled") / f"{name or 'campaign'}-{scenario}"


@contextmanager
def _alone(folder: ReconcileFolder) -> Iterator[None]:
    """The block with the folder made and to itself; InputError where that cannot be."""
    from vgvt.cli.folder_lock import alone_in

    folder.prepare()
    with alone_in(folder.path, folder.lock, "vgvt reconcile"):
        yield


def _processes(asked: int | None) -> int:
    """How many processes share the work: where nobody asked one a core, and no more than a round has work for."""
    from vgvt.cli.cores import available_cores

    return min(available_cores(), _MOST_PROCESSES) if asked is None else asked


def chosen_effects(only: list[str], without: list[str]) -> dict[str, type]:
    """The installed effects by name, those asked for; InputError for a name that there is not."""
    from vgvt.data import InputError
    from vgvt.data.suggestion import choose_one_of
    from vgvt.effects.registry import available_effects

    found = available_effects()
    for option, names in (("--only", only), ("--without", without)):
        for name in names:
            if name not in found:
                several = [part.strip() for part in name.split(",") if part.strip() in found]
                again = f"give {option} once for each effect: {' '.join(f'{option} {part}' for part in several)}"
                advice = again if len(several) > 1 else choose_one_of(name, tuple(found))
                raise InputError(option, f"there is no effect {name!r}", advice)
    kept = {name: cls for name, cls in found.items() if (not only or name in only) and name not in without}
    if not kept:
        raise InputError("--only and --without", "leave no effect to try", "leave one of them out")
    return kept


def undeclared(scenario: Scenario, effects: Mapping[str, type]) -> dict[str, type]:
    """Effects that a scenario has not in a table of its own already; InputError where that leaves none."""
    from vgvt.data import InputError

    declared = {table.name for table in scenario.effect}
    kept = {name: cls for name, cls in effects.items() if name not in declared}
    if not kept:
        raise InputError(
            "--only and --without",
            f"leave nothing to try: scenario {scenario.name} has {', '.join(sorted(effects))} in [[effect]] already",
            "choose another effect, or take that table out of the scenario to have its size found",
        )
    return kept


def tell_of_declared(scenario: Scenario, names: Sequence[str]) -> None:
    """Say which of the effects that were asked for by name are part of what is believed, and not tried."""
    if names:
        has = f"scenario {scenario.name} has {', '.join(names)} in [[effect]] already"
        log(f"--only: {has}: not tried a second time; take a table out to have its size found")


def _reconciled(
    campaign: Campaign,
    scenario: Scenario,
    effects: Mapping[str, type],
    folder: ReconcileFolder,
    lines: int,
    thresholds: Thresholds | None,
    with_power: bool,
    fingerprint: str,
    workers: int,
) -> dict[str, Any]:
    """Reconcile and write the three files."""
    from vgvt.files.manifest import file_sha256
    from vgvt.reconcile.loop import reconcile as close_the_loop
    from vgvt.reconcile.outcome.account import account_of
    from vgvt.reconcile.search.candidates import candidates
    from vgvt.view.reconcile_document import account_document
    from vgvt.view.reconcile_page import write_reconcile_page
    from vgvt.view.reconcile_wording import disproofs, next_steps, verdict_sentence, warnings_of

    start = time.perf_counter()
    with _kept_on_interrupt(folder), progress(f"reconcile {campaign.name}") as report:
        share = 1.0 - _POWER_SHARE
        verdict = close_the_loop(
            campaign, scenario, effects=effects, thresholds=thresholds, lines=lines, folder=folder.cache,
            workers=workers,
            progress=lambda fraction, message, _: report(share * fraction, message),
        )  # fmt: skip
        problem = verdict.attribution.null.problem
        tried = candidates(problem, effects)
        # "Nothing is needed" is worth as much as what could have been seen.
        asked = with_power or verdict.kind == "adequate"
        seen = _power(verdict, tried, lambda f, m: report(share + _POWER_SHARE * f, m)) if asked else ()
        spent = time.perf_counter() - start
        account = account_of(
            verdict,
            title=f"{campaign.name} against {scenario.name}",
            facts=_facts(campaign, scenario, tried, spent),
            power=seen,
        )
        write_reconcile_page(folder.cache / folder.report.name, account)
    document: dict[str, Any] = {
        **verdict.document(),
        **account_document(account),
        "sentence": verdict_sentence(account),
        "next_steps": next_steps(account),
        "would_disprove_it": disproofs(account),
        "warnings": warnings_of(account),
        "power": [p.document() for p in seen],
        "not_tried": _not_tried(problem, effects, tried),
        "campaign": campaign.name,
        **folder.places,
        "reconciled_sha256": file_sha256(folder.cache / folder.scenario.name),
        "reconciled_edited": False,
        "timing_s": spent,
        "fingerprint": fingerprint,
    }
    kept = folder.publish(document)
    if kept is not None:
        log(f"{folder.scenario} was edited since it was written: what it said is kept as {kept}")
    return document


def _not_tried(problem: Problem, effects: Mapping[str, type], tried: tuple[Hypothesis, ...]) -> dict[str, str]:
    """Effects to choose from of which this campaign could show no variant, by name, and why."""
    from vgvt.reconcile.search.candidates import cannot_have

    left = {name: cls for name, cls in effects.items() if name not in {h.name for h in tried}}
    why = cannot_have(problem, left)
    return {name: why[name].problem if name in why else "there is nothing here that it could act on" for name in left}


def _power(verdict: Verdict, tried: tuple[Hypothesis, ...], report: Any) -> tuple[Any, ...]:
    """Detectability around the model that a verdict ends with, of what has no name in it: no name is given twice."""
    from vgvt.reconcile.next_test.power import power as detectability

    final = verdict.attribution.final
    named = {hypothesis.name for hypothesis in final.hypotheses}
    return detectability(final, [h for h in tried if h.name not in named], report, verdict.thresholds)


def _facts(campaign: Campaign, scenario: Scenario, tried: tuple[Hypothesis, ...], spent_s: float) -> dict[str, str]:
    from vgvt import __version__

    low, high = campaign.band_hz
    return {
        "campaign": campaign.name,
        "scenario": f"{scenario.name}: {scenario.summary}",
        "band": f"{low:g} to {high:g} Hz",
        "runs": str(len(campaign.runs)),
        "effects tried": str(len({h.name for h in tried})),
        "seed of the hold-out": str(scenario.seed),
        "time": f"{spent_s:.0f} s",
        "made by": f"vgvt {__version__}",
    }


@contextmanager
def _kept_on_interrupt(folder: ReconcileFolder) -> Iterator[None]:
    """Say what a second call can go on from."""
    try:
        yield
    except (KeyboardInterrupt, SystemExit):
        if folder.begun:
            what = "the rounds and derivatives" if any(folder.rounds) else "the derivatives"
            log(f"kept in {folder.path}: {what} computed so far; the same command goes on from them")
        else:
            log(f"stopped; nothing new was kept in {folder.path}")
        raise


def _show(document: Mapping[str, Any], folder: ReconcileFolder) -> None:
    from vgvt.cli.reconcile_tables import effects_table, error_table

    show(str(document["sentence"]), "")
    told = document["effects"] or document["leads"]
    show(bullets(document["reasons"]), effects_table(told) if told else "")
    show(error_table(document))
    for line in document["warnings"]:
        log(f"calibrated far from what the scenario states: {line}")
    show("What to do:", bullets(document["next_steps"]), "")
    show("What would disprove it:", bullets(document["would_disprove_it"]), "")
    show(f"{document['timing_s']:.0f} s; files in {folder.path}; open {folder.report} in a browser")
