"""The loop closed on the measured campaign: ten raw runs against the nominal scenario that was frozen beforehand.

    python docs/studies/hati_reconciled.py [STAGE ...]

Stages, each kept under docs/_build/hati-reconciled and not done again: null (the nominal model as it stands and
calibrated, no effect added), main (the whole catalogue), first (the same, at most one effect: a quicker look),
fine-floor (a model-form error of 0.4 %), without (the catalogue without what was named), shuffled (channel labels
permuted), wrong-place (what was named, offered elsewhere), splits (six more hold-outs). Where nothing has a name, the
leads, which come nearest, stand for it in the controls. Afterwards the page's tables and figures are written. All of it
is derived from records under the MIT licence (PAAW/mAEWing1).
"""

from __future__ import annotations

import argparse
import os
import resource
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from command_line import one_of, parser_of, raise_if_asked, worked_off
from kept_documents import cut_off, keep, read_kept
from loop_work import core
from numpy.typing import NDArray
from virtual_lab import PAGES

from vgvt.data import Campaign, ChannelRole, InputError
from vgvt.effects.registry import available_effects
from vgvt.files import open_campaign
from vgvt.files.atomically import replacing
from vgvt.reconcile.evidence.localise import localise
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.evidence.rivals import Rival
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.loop import reconcile
from vgvt.reconcile.outcome.augment import posterior_of
from vgvt.reconcile.outcome.mode_errors import model_modes
from vgvt.reconcile.question.figures_of_merit import compare
from vgvt.reconcile.question.holdout import Split
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.question.thresholds import stored_thresholds
from vgvt.reconcile.search.candidates import places
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.streams import named_stream

RAW = "hati-2015-09-24"
FOLDER = PAGES.parent / "_build" / "hati-reconciled"
FINE_FLOOR = 0.004
WORKERS = 2
SPLITS = ("odd runs", "even runs", "forward row", "aft row", "right wing", "left wing")
"""What is fitted in each of the further hold-outs; the other half is judged."""
Document = dict[str, Any]


CORE = core()


def nominal() -> Scenario:
    """The frozen scenario."""
    return load_scenario(PAGES / "hati-measured.toml")


def stored(stage: str) -> Document | None:
    """What a stage came to, if it is there; InputError where its file is cut off."""
    path = FOLDER / f"{stage}.json"
    if not path.is_file():
        return None
    advice = f"remove it and run the stage again: {stage}"
    found: Document = read_kept(path, advice)
    if not isinstance(found, dict):
        raise cut_off(path, advice)
    return found


def run_whole(stage: str, campaign: Campaign, scenario: Scenario, **choices: Any) -> Document:
    """A whole reconciliation with its verdict, posterior, rivals, time, and the load under which it was taken."""
    wall, worked = time.perf_counter(), _processor_s()

    def tell(fraction: float, message: str, left: float | None) -> None:
        raise_if_asked()
        print(f"{stage} {time.strftime('%H:%M:%S')} {fraction:.0%} {message}", flush=True)  # noqa: T201

    verdict = reconcile(campaign, scenario, folder=FOLDER / stage, workers=WORKERS, progress=tell, **choices)
    found = verdict.attribution
    nearest = found.final if found.led is None else found.led
    document = verdict.document() | {
        "core": CORE,
        "wall_s": time.perf_counter() - wall,
        "processor_s": _processor_s() - worked,
        "load": os.getloadavg()[0],
        "converged": {"before": found.null.converged, "after": nearest.converged},
        "posterior_before": posterior_of(found.null),
        "posterior": posterior_of(nearest),
        "with_leads": None if found.led is None else _compared(found.led),
        "rounds": [[_rival(r) for r in addition.rivals] for addition in found.rounds or found.leads],
        "last_rivals": [_rival(r) for r in found.last_rivals],
        "vetoed": [_rival(r) for r in found.vetoed],
        "scores": {"before": found.null.u.tolist(), "after": nearest.u.tolist(), "effects": nearest.e.tolist()},
    }
    _keep_arrays(stage, found.null, nearest)
    return document


def _processor_s() -> float:
    """Processor time of this process so far, and of those that it started and that have ended."""
    return time.process_time() + sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])


def _rival(r: Rival) -> Document:
    return {
        "effect": r.hypothesis.label,
        "gain_nats": r.gain_nats,
        "raw_nats": r.raw_nats,
        "held_out": r.held_out,
        "parameters": {k: list(v) for k, v in r.fit.values(len(r.fit.hypotheses) - 1).items()},
    }


def _compared(found: Fit) -> Document:
    return compare(found.foretold, found.problem.measured, found.problem.split).document()


def _keep_arrays(stage: str, before: Fit, after: Fit) -> None:
    measured, limits = before.problem.measured, stored_thresholds()
    left = residual(before, limits)
    _save(
        stage,
        frequency_hz=measured.frequency_hz, values=measured.values, noise=measured.noise, sigma=measured.sigma,
        before=before.foretold, after=after.foretold, train=before.problem.split.train,
        run=[c.run_number for c in measured.channels], node=[c.dof.node for c in measured.channels],
        table_before=left.table, table_after=residual(after, limits).table, bands_hz=left.bands_hz,
    )  # fmt: skip


def _save(stage: str, **arrays: Any) -> None:
    with replacing(FOLDER / f"{stage}.npz") as part, part.open("wb") as stream:
        np.savez(stream, **arrays)


def shuffled(campaign: Campaign, seed: int) -> Campaign:
    """The same records with the places of the responses permuted."""
    dofs = list(campaign.response_dofs)
    order = named_stream(seed, "shuffled").permutation(len(dofs))
    new = {dof: dofs[k] for dof, k in zip(dofs, order, strict=True)}

    def relabelled(run: Any) -> Any:
        channels = tuple(
            replace(c, dof=new[c.dof]) if c.role is ChannelRole.RESPONSE and c.dof is not None else c
            for c in run.channels
        )
        return replace(run, channels=channels)

    return replace(campaign, runs=tuple(relabelled(run) for run in campaign.runs))


def named(document: Document) -> list[tuple[Hypothesis, dict[str, float]]]:
    """The effects that a stage named, or its leads, as hypotheses with their fitted values."""
    found = []
    for effect in document["effects"] or document["leads"]:
        hypothesis = Hypothesis(available_effects()[effect["name"]], effect["settings"])
        found.append((hypothesis, {k: v["value"] for k, v in effect["parameters"].items()}))
    return found


def half(problem: Problem, what: str) -> NDArray[np.bool_]:
    """The channels that one of the further hold-outs fits, (C,) bool."""
    run = np.array([c.run_number for c in problem.measured.channels])
    node = np.array([c.dof.node for c in problem.measured.channels])
    return np.asarray({
        "odd runs": run % 2 == 1, "even runs": run % 2 == 0, "forward row": node % 2 == 1, "aft row": node % 2 == 0,
        "right wing": node <= 10, "left wing": node > 10,
    }[what])  # fmt: skip


def problem_as_run() -> Problem:
    """The problem of the main stage."""
    return make_problem(open_campaign(RAW), nominal(), cache=FOLDER / "cache")


def after_fit(
    before: Fit, effects: list[tuple[Hypothesis, dict[str, float]]], found: NDArray[np.float64] | None = None
) -> Fit:
    """The model with effects, fitted from the one without and from scores that were ``found`` with them: the better."""
    start = np.concatenate([h.scores(values) for h, values in effects])
    starts = [before.u] if found is None else [before.u, found]
    fits = [fit(before.problem, tuple(h for h, _ in effects), u, start, ((0.15, 3), *NEAR)) for u in starts]
    return max(fits, key=lambda f: f.evidence_nats)


def run_splits(main: Document) -> Document:
    """Errors on what was not fitted, before and after, for every further hold-out."""
    problem, effects, rows = problem_as_run(), named(main), {}
    for what in SPLITS:
        train = half(problem, what)
        parts = Split(train, ~train, np.zeros_like(train))
        part = replace(problem, split=parts)
        before = calibrate(part)
        row: Document = {"before": compare(before.foretold, problem.measured, parts).document()}
        if effects:
            after = after_fit(before, effects, np.array(main["scores"]["after"]))
            row["after"] = compare(after.foretold, problem.measured, parts).document()
            row["effects"] = [after.values(k) for k in range(len(effects))]
        rows[what] = row
        print(f"splits {time.strftime('%H:%M:%S')} {what}", flush=True)  # noqa: T201
    return rows


def run_wrong_places(main: Document) -> Document:
    """What each named effect with a place gains elsewhere: mirrored, and at the nearest other place of the grid."""
    problem, rows = problem_as_run(), {}
    before = fit(problem, (), np.array(main["scores"]["before"]), np.zeros(0), NEAR)
    for hypothesis, values in named(main):
        here = {**hypothesis.settings, **values}
        if not {"x_m", "y_m"} <= set(here):
            rows[hypothesis.name] = {"place": None}
            continue
        x, y = float(here["x_m"]), float(here["y_m"])
        others = sorted(places(problem), key=lambda p: np.hypot(p[0] - x, p[1] - y))
        wrong = {
            "as found": (x, y),
            "mirrored": (x, -y),
            "nearest other": next(p for p in others if np.hypot(p[0] - x, p[1] - y) > 0.05),
        }
        rest = {k: v for k, v in values.items() if k not in ("x_m", "y_m")}
        kept = {k: v for k, v in hypothesis.settings.items() if k not in ("x_m", "y_m")}
        row: Document = {}
        for label, (px, py) in wrong.items():
            fixed = Hypothesis(hypothesis.cls, {**kept, "x_m": px, "y_m": py})
            found = after_fit(before, [(fixed, rest)])
            row[label] = {
                "x_m": px, "y_m": py, "raw_nats": found.evidence_nats - before.evidence_nats,
                "errors": compare(found.foretold, problem.measured, problem.split).document(),
            }  # fmt: skip
        rows[hypothesis.name] = row
    return rows


def run_null() -> Document:
    """The nominal model as it stands and calibrated, no effect added: errors, modes, where a free force would help."""
    wall, own = time.perf_counter(), time.process_time()
    problem = problem_as_run()
    stated = fit(problem, (), np.zeros(problem.size), np.zeros(0), ())
    calibrated = calibrate(problem)
    document: Document = {"core": CORE, "converged": calibrated.converged, "posterior": posterior_of(calibrated)}
    for label, model in (("stated", stated), ("calibrated", calibrated)):
        modes = model_modes(model)
        left = residual(model, stored_thresholds())
        document[label] = {
            "errors": compare(model.foretold, problem.measured, problem.split).document(),
            "frequency_hz": modes.frequency_hz.tolist(), "damping_ratio": modes.damping_ratio.tolist(),
            "bands_hz": left.bands_hz.tolist(), "table": left.table.tolist(), "reasons": list(left.reasons),
            "lag_one": left.lag_one, "smooth_per_dof": left.smooth_per_dof,
        }  # fmt: skip
    measured = problem.measured
    _save(
        "null",
        frequency_hz=measured.frequency_hz, values=measured.values, noise=measured.noise, sigma=measured.sigma,
        before=stated.foretold, after=calibrated.foretold, train=problem.split.train,
        run=[c.run_number for c in measured.channels], node=[c.dof.node for c in measured.channels],
        table_before=np.array(document["stated"]["table"]), table_after=np.array(document["calibrated"]["table"]),
        bands_hz=np.array(document["stated"]["bands_hz"]),
    )  # fmt: skip
    document["calibration_s"] = [time.perf_counter() - wall, time.process_time() - own, os.getloadavg()[0]]
    keep(FOLDER / "null-without-places.json", document, indent=None, default=float)
    found = localise(calibrated)
    document["localisation"] = [
        {"place": p.label, "explained": p.explained, "type": p.type, "size": p.size, "unit": p.unit}
        for p in found.places[:8]
    ]
    document["localised_s"] = [time.perf_counter() - wall, time.process_time() - own, os.getloadavg()[0]]
    return document


def without(main: Document) -> dict[str, type]:
    """The catalogue without what was named, or came nearest, and without what explains the data as well."""
    gone = {n for e in main["effects"] or main["leads"] for n in (e["name"], *e["equivalent"])}
    return {k: v for k, v in available_effects().items() if k not in gone}


def work(stage: str) -> Document:
    """One stage; all but the first need what the first came to."""
    scenario = nominal()
    if stage == "null":
        return run_null()
    if stage in ("main", "first"):
        return run_whole(stage, open_campaign(RAW), scenario, most=3 if stage == "main" else 1)
    if stage == "fine-floor":
        return run_whole(stage, open_campaign(RAW), scenario, floor=FINE_FLOOR)
    if stage == "shuffled":
        return run_whole(stage, shuffled(open_campaign(RAW), scenario.seed), scenario)
    main = stored("main") or stored("first")
    if main is None:
        raise InputError(f"stage {stage}", "wants what 'main' or 'first' names", f"write main {stage}")
    if stage == "without":
        return run_whole(stage, open_campaign(RAW), scenario, effects=without(main))
    return run_splits(main) if stage == "splits" else run_wrong_places(main)


STAGES = ("null", "main", "without", "splits", "wrong-place", "shuffled", "fine-floor")
LATER = ("without", "splits", "wrong-place")
"""Stages that need what the stage main, or first, came to."""


def run(stages: Sequence[str]) -> None:
    """Do what is missing of some stages."""
    for stage in [stage for stage in stages if stored(stage) is None]:
        keep(FOLDER / f"{stage}.json", work(stage), default=float)


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line; ``stages`` are those to run."""
    parser = parser_of(__doc__)
    said = "what to run (all but first, and the page, if nothing is said)"
    parser.add_argument("stages", nargs="*", type=one_of((*STAGES, "first")), metavar="STAGE", help=said)
    parser.add_argument("--page", action="store_true", help="only write the page of what is kept")
    given = parser.parse_intermixed_args(words)
    if given.page and given.stages:
        parser.error("--page writes the page of all that is kept: name no STAGE beside it")
    known = any((FOLDER / f"{stage}.json").is_file() for stage in ("main", "first"))
    for k, stage in enumerate(given.stages):
        if stage in LATER and not known and not {"main", "first"} & set(given.stages[:k]):
            parser.error(f"stage {stage} needs what the whole catalogue names, which was not run: write main {stage}")
    return given


def go_on(stages: Sequence[str], page_alone: bool) -> None:
    """Run what is missing; write the page where no stage is named."""
    if not page_alone:
        run(stages or STAGES)
    if not stages:
        import hati_reconciled_page

        hati_reconciled_page.write()


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    given = arguments(words)
    kept = f"stages that are done are kept in {FOLDER}; the same command goes on from there"
    return worked_off(lambda: go_on(given.stages, given.page), kept)


if __name__ == "__main__":
    sys.exit(main())
