"""``vgvt reconcile --power`` without a campaign: what a test could see, before it is made."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vgvt.cli.console import log, progress, show
from vgvt.cli.document import document_text, write_document

if TYPE_CHECKING:
    from vgvt.reconcile.question.thresholds import Thresholds
    from vgvt.scenario.model import Scenario
    from vgvt.view.power_account import PowerRow

_SIMULATED, _LINED_UP = 0.2, 0.3
# Options that mean nothing without what was measured, and why.
_OF_A_CAMPAIGN = {
    "--workers": "shares a search among processes, and --power without CAMPAIGN searches for nothing",
    "--leave-out-faulty": "leaves out what was measured badly, and without CAMPAIGN nothing was measured",
    "--force": "does again what is answered already, and --power without CAMPAIGN is computed each time",
}


def refuse_what_needs_a_campaign(given: Mapping[str, bool]) -> None:
    """InputError for an option that is ``given`` and would change nothing, as no campaign is."""
    from vgvt.data import InputError

    for option, why in _OF_A_CAMPAIGN.items():
        if given[option]:
            raise InputError(option, why, "leave it out, or name what was measured: vgvt reconcile CAMPAIGN")


def power_before_the_test(
    scenario: Scenario,
    effects: Mapping[str, type],
    out: Path | None,
    band: tuple[float, float] | None,
    lines: int,
    as_json: bool,
    thresholds: Thresholds | None = None,
) -> int:
    """Print the table of detectability; with ``out`` write power.json and power.html there too.

    InputError before anything is computed where ``out`` cannot hold them.
    """
    from vgvt.cli.new_folders import none_left_empty
    from vgvt.cli.reconcile_folder import ReconcileFolder

    if out is None:
        document, rows = _computed(scenario, effects, band, lines, thresholds)
    else:
        with none_left_empty(out):
            ReconcileFolder(out).prepare()
            document, rows = _computed(scenario, effects, band, lines, thresholds)
            _write(out, scenario, document, rows)
    if as_json:
        write_document(document)
        return 0
    from vgvt.cli.reconcile_tables import power_table

    show(power_table(rows))
    return 0


def _computed(
    scenario: Scenario,
    effects: Mapping[str, type],
    band: tuple[float, float] | None,
    lines: int,
    thresholds: Thresholds | None,
) -> tuple[dict[str, Any], tuple[PowerRow, ...]]:
    """The table of detectability as a document, and its rows."""
    from vgvt.reconcile.next_test.before_test import expected_fit
    from vgvt.reconcile.next_test.power import power
    from vgvt.reconcile.next_test.power_rows import confusable, invisible, power_rows
    from vgvt.reconcile.question.suitable import check_excitation, within_excited
    from vgvt.reconcile.search.candidates import cannot_have, some_candidates

    check_excitation(scenario)
    if band is not None:
        tell_of_cut(band, within_excited(band, scenario.excitation.band_hz, scenario.name), scenario.name)
    with progress(f"power of {scenario.name}") as report:
        fit = expected_fit(scenario, lines=lines, band_hz=band, progress=lambda f, m: report(_SIMULATED * f, m))
        report(_LINED_UP, "derivatives")
        without = {name: error.problem for name, error in cannot_have(fit.problem, effects).items()}
        tried = some_candidates(fit.problem, effects)
        found = power(fit, tried, lambda f, m: report(_LINED_UP + (1 - _LINED_UP) * f, m), thresholds)
    rows = power_rows(found)
    for name, why in without.items():
        log(f"no variant of {name} is possible on {scenario.name}: {why}")
    document = {
        "scenario": scenario.name,
        "band_hz": [float(fit.problem.measured.frequency_hz[0]), float(fit.problem.measured.frequency_hz[-1])],
        "power": [p.document() for p in found],
        "places": [_places(r) for r in rows if r.variants > 1],
        "invisible": invisible(rows),
        "confusable": confusable(found),
        "cannot_have": without,
    }
    return document, rows


def tell_of_cut(asked: tuple[float, float] | None, used: tuple[float, float], name: str) -> None:
    """Log that a band reaches beyond what is excited, where it does."""
    if asked is not None and asked != used:
        log(f"--band {asked[0]:g} {asked[1]:g} is cut to {used[0]:g} to {used[1]:g} Hz: {name} excites no more")


def _places(row: PowerRow) -> dict[str, object]:
    """What is just visible at the best, the median and the worst of an effect's variants; None is never.

    And from which others the best is not told.
    """
    sizes = {"best": row.smallest, "median": row.median, "worst": row.worst}
    told: dict[str, object] = {k: v if math.isfinite(v) else None for k, v in sizes.items()}
    what = {"effect": row.effect, "parameter": row.parameter, "unit": row.unit, "variants": row.variants}
    elsewhere = [{"variant": label, "cosine": cosine} for label, cosine in row.elsewhere]
    variants = {"best_variant": row.variant, "worst_variant": row.worst_variant, "not_told_from": elsewhere}
    return what | told | variants | {"reason": row.reason}


def _write(out: Path, scenario: Scenario, document: Mapping[str, Any], rows: Any) -> None:
    from vgvt import __version__
    from vgvt.files.atomically import replacing
    from vgvt.view.reconcile_page import write_power_page

    facts = {"scenario": f"{scenario.name}: {scenario.summary}", "made by": f"vgvt {__version__}"}
    write_power_page(out / "power.html", f"What {scenario.name} could see", facts, rows)
    with replacing(out / "power.json") as temporary:
        temporary.write_text(document_text(document), encoding="utf-8")
