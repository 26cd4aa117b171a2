"""``vgvt reconcile --placebos``: how often a test in which nothing is missing would be given a name, and its limits."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vgvt.cli.console import bullets, log, progress, show
from vgvt.cli.document import write_document

if TYPE_CHECKING:
    from vgvt.reconcile.question.thresholds import Thresholds
    from vgvt.scenario.model import Scenario

# Of fewer the limits would be several times as high: what lies above the middle is all that they are made of.
FEWEST = 10
_FILE = "thresholds.toml"
_CONFIDENCE = 0.95
# What a limit is of, in words.
_WORDS = {
    "chi2_per_dof": "fitted data, χ² per dof beyond noise",
    "smooth_per_dof": "… its smooth part",
    "held_out_per_dof": "held-out data, χ² per dof beyond noise",
    "evidence_nats": "a name, nats, where noise is most",
    "evidence_form_nats": "… where model_form is all",
    "strain_sd": "tolerances together, deviations, where noise is most",
    "strain_form_sd": "… where model_form is all",
}


_BESIDE = {
    "CAMPAIGN": ("was measured, and --placebos tries campaigns of the scenario", "leave CAMPAIGN out"),
    "--power": ("asks for something else than --placebos does", "ask for one, then for the other"),
    "--leave-out-faulty": ("leaves out what was measured badly, and --placebos measures nothing", "leave it out"),
}


def refuse_beside_placebos(given: Mapping[str, bool]) -> None:
    """InputError for an argument that is ``given`` and has no part in a rehearsal."""
    from vgvt.data import InputError

    for name, (problem, advice) in _BESIDE.items():
        if given[name]:
            raise InputError(name, problem, advice)


@dataclass(frozen=True, slots=True)
class Rehearse:
    """One campaign of a rehearsal, by its number, and the key that its result is kept under."""

    number: int

    @property
    def key(self) -> str:
        """A name of its file."""
        return f"placebo-{self.number:04d}"

    @property
    def title(self) -> str:
        """The campaign in words."""
        return f"placebo {self.number}"


def rehearse(
    scenario: Scenario,
    count: int,
    effects: Mapping[str, type],
    thresholds: Thresholds | None,
    out: Path | None,
    *,
    band: tuple[float, float] | None,
    lines: int,
    workers: int,
    force: bool,
    as_json: bool,
) -> int:
    """Take ``count`` campaigns of the scenario through the loop, print how often it named something, and write limits.

    Each campaign that is done is kept in ``out``, and taken from there where the same is asked again.
    """
    from vgvt.cli.folder_lock import alone_in
    from vgvt.cli.new_folders import none_left_empty
    from vgvt.cli.results_folder import CELLS, checked_folder, telling_what_is_kept
    from vgvt.reconcile.placebo import Placebo, own_thresholds, write_thresholds
    from vgvt.reconcile.question.suitable import check_excitation, within_excited

    check_excitation(scenario)
    if band is not None:
        band = within_excited(band, scenario.excitation.band_hz, scenario.name)
    folder = checked_folder(out or Path("reconciled") / f"placebos-{scenario.name}", (CELLS, _FILE))
    work = partial(_rows, scenario=scenario, effects=dict(effects), thresholds=thresholds, lines=lines, band_hz=band)
    made_by = _fingerprint(scenario, effects, thresholds, lines, band)
    with none_left_empty(folder / CELLS), alone_in(folder, folder / CELLS / "lock", "vgvt reconcile --placebos"):
        with telling_what_is_kept(folder), progress(f"placebos of {scenario.name}") as report:
            rows = _worked_off(folder, made_by, count, work, workers, force, report)
        said = f"vgvt reconcile --scenario {scenario.name} --placebos {count}"
        limits = own_thresholds([Placebo(**row["placebo"]) for row in rows], f"{said}, {_version()}")
        write_thresholds(folder / _FILE, limits)
    document = _document(scenario, rows, limits, folder)
    if as_json:
        write_document(document)
    else:
        _show(document)
    return 0


def _worked_off(
    folder: Path,
    made_by: str,
    count: int,
    work: Callable[[Rehearse], list[dict[str, Any]]],
    workers: int,
    force: bool,
    report: Callable[[float, str], None],
) -> list[dict[str, Any]]:
    """The row of every campaign, in order: kept ones, and those that had to be made."""
    from vgvt.bench.completion import in_order_of_completion
    from vgvt.bench.store import Store
    from vgvt.cli.bench import executor_for

    store = Store(folder, made_by)
    every = [Rehearse(k + 1) for k in range(count)]
    known = {} if force else {r.number: rows for r in every if (rows := store.rows(r))}
    if known:
        log(f"took {len(known)} of {count} campaigns from {folder}; --force makes them again")
    left = [r for r in every if r.number not in known]
    if left:
        log(f"each of {len(left)} campaigns is told when its verdict is there: minutes where a test is large")
    report(len(known) / count, f"{len(known)} of {count} campaigns")
    pool = executor_for(workers, None) if len(left) > 1 else None
    for one, rows in in_order_of_completion(left, pool, work):
        store.keep(one, rows)
        known[one.number] = rows
        report(len(known) / count, f"{len(known)} of {count} campaigns, the last one {rows[0]['verdict']}")
    return [known[r.number][0] for r in every]


def _rows(
    one: Rehearse,
    scenario: Scenario,
    effects: Mapping[str, type],
    thresholds: Thresholds | None,
    lines: int,
    band_hz: tuple[float, float] | None,
) -> list[dict[str, Any]]:
    """One campaign in plain values, as it is kept."""
    from vgvt.reconcile.rehearsal import rehearsed

    found = rehearsed(scenario, one.number, effects=effects, thresholds=thresholds, lines=lines, band_hz=band_hz)
    return [
        {
            "number": found.number,
            "verdict": found.kind.value,
            "named": list(found.named),
            "placebo": asdict(found.placebo),
        }
    ]


def _fingerprint(
    scenario: Scenario,
    effects: Mapping[str, type],
    thresholds: Thresholds | None,
    lines: int,
    band: tuple[float, float] | None,
) -> str:
    """Hash of all that a campaign and its verdict follow from, its number aside."""
    from vgvt.cli.run_folder import scenario_sha256
    from vgvt.reconcile.question.effect_code import code_of

    facts = {
        "scenario": scenario_sha256(scenario),
        "version": _version(),
        "effects": sorted(effects),
        "code": code_of(effects, scenario),
        "thresholds": None if thresholds is None else asdict(thresholds),
        "lines": lines,
        "band_hz": band,
    }
    return hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()


def _version() -> str:
    from vgvt import __version__

    return f"vgvt {__version__}"


def _document(
    scenario: Scenario, rows: Sequence[Mapping[str, Any]], limits: Thresholds, folder: Path
) -> dict[str, Any]:
    import scipy.stats

    from vgvt.reconcile.question.thresholds import stored_thresholds

    named = sum(bool(row["named"]) for row in rows)
    interval = scipy.stats.binomtest(named, len(rows)).proportion_ci(_CONFIDENCE, method="wilson")
    return {
        "scenario": scenario.name,
        "campaigns": len(rows),
        "verdicts": dict(sorted(Counter(row["verdict"] for row in rows).items())),
        "named": named,
        "named_interval": [float(interval.low), float(interval.high)],
        "names": dict(sorted(Counter(name for row in rows for name in row["named"]).items())),
        "best_nats": sorted((row["placebo"]["best_nats"] for row in rows), reverse=True),
        "thresholds": asdict(limits),
        "shipped": asdict(stored_thresholds()),
        "placebos": [dict(row) for row in rows],
        "folder": str(folder),
        "thresholds_file": str(folder / _FILE),
    }


def _show(document: Mapping[str, Any]) -> None:
    from vgvt.view.fitted_table import FittedTable

    count, named, (low, high) = document["campaigns"], document["named"], document["named_interval"]
    show(
        f"Of {count} campaigns in which nothing is missing {named or 'none'} {'was' if named < 2 else 'were'} given a "
        f"name: of all such tests {100 * low:.0f} to {100 * high:.0f} % would be (95 %).",
        "",
    )
    verdicts = ", ".join(f"{number} {kind.replace('_', ' ')}" for kind, number in document["verdicts"].items())
    names = ", ".join(f"{name} {number}" for name, number in document["names"].items())
    best = ", ".join(f"{nats:.1f}" for nats in document["best_nats"][:3])
    said = [f"verdicts: {verdicts}", f"the best candidates gained {best} nats"]
    show(bullets([*said, f"names: {names}"] if names else said), "")
    own, shipped = document["thresholds"], document["shipped"]
    columns = ("limit of", "this test", "as shipped")
    rows = tuple((words, f"{own[key]:.3g}", f"{shipped[key]:.3g}") for key, words in _WORDS.items())
    show(
        FittedTable(
            columns=columns, rows=rows, whole=frozenset(columns[1:]), right=frozenset(columns[1:]),
            title="what campaigns in which nothing is missing stay below",
        ),
    )  # fmt: skip
    show(
        f"limits in {document['thresholds_file']}: vgvt reconcile CAMPAIGN … --thresholds {document['thresholds_file']}"
    )
