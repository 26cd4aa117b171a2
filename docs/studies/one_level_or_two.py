"""Is it nonlinear? ``python docs/studies/one_level_or_two.py FOLDER``: eight truths, each at one level and at two.

What `vgvt reconcile` says of a joint that stiffens, slips or has play, of a drift between runs and of a joint that is
just soft, given runs at one level of drive or at two. Joints that depend on level come from two laboratories: the
simulator's time domain, and finite elements that share no code with it. Every case is one small file in FOLDER;
``--report`` fills docs/studies/one-level-or-two.md from them, and from what it showed last where there is none.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, Literal

import loop_truth as lab
from command_line import (
    cases_asked_for,
    cases_stay,
    made,
    one_of,
    parser_of_cases,
    raise_if_asked,
    worked_off,
)
from kept_documents import cut_off, keep, read_kept
from loop_cases import LINES, SECOND, SHORT, SIMULATION, find_the_second_laboratory
from loop_work import core
from rich.console import Console
from virtual_lab import PAGES, table, write_results

from vgvt.data import Campaign, InputError, Record
from vgvt.effects import available_effects
from vgvt.files.atomically import replacing
from vgvt.reconcile import Verdict, reconcile
from vgvt.scenario import Scenario
from vgvt.scenario.effect import EffectTable
from vgvt.scenario.streams import named_stream
from vgvt.simulation import simulate

NONLINEAR = ("cubic-root-stiffness", "root-friction", "root-freeplay")
NOISE = 0.003
BASELINE = PAGES.parents[1] / "scoreboard" / "baselines" / "one-level-or-two.csv"
COLUMNS = (
    "truth", "laboratory", "levels", "verdict", "named", "held-out χ²/ν", "next best, nats behind", "CPU s", "source",
)  # fmt: skip
RUNS = lab.RUNS[:3]
"""Nodes of three runs; each is recorded twice, at the same level or at two."""


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """An effect with its settings, and the drive's amplitudes, the quiet one and the loud one.

    In V at the shaker of the simulator, in N at the gauge of the second laboratory. ``model_form`` is what the analysis
    is told that its model misses of each response when driven so, relative; by default what the scenario states.
    """

    name: str
    settings: dict[str, Any]
    quiet: float
    loud: float
    source: str = SIMULATION
    model_form: float | None = None

    @property
    def title(self) -> str:
        """The effect, and the laboratory where it is the second."""
        return self.name if self.source == SIMULATION else f"{self.name}, {self.source}"

    @property
    def engine(self) -> Literal["mujoco", "linear"]:
        """What solves it: where superposition holds, exactly and with as many cells as the study's other truths."""
        return "mujoco" if self.name in NONLINEAR else "linear"


# Play is driven just beyond what opens the joint against the wing's weight (between 2 and 2.5 V). The same aircraft
# without any joint is off by 1.2 % there, four times the noise, as it turns through finite angles (tests/reconcile/
# test_levels.py measures it): a lab that steps its nominal scenario at the drive of its test knows that beforehand.
TRUTHS = (
    Truth("cubic-root-stiffness", {"cubic_n_m_per_rad3": 2e7, "root_stiffness_n_m_per_rad": 2000.0}, 0.25, 1.0),
    Truth("root-friction", {"friction_n_m": 0.3, "root_stiffness_n_m_per_rad": 2000.0}, 0.25, 1.0),
    Truth("root-freeplay", {"gap_rad": 2e-3, "root_stiffness_n_m_per_rad": 2000.0, "kind": "bending"}, 0.6, 2.5,
          model_form=0.012),
    Truth("run-drift", {"drift": 0.02}, 0.25, 1.0),
    Truth("root-compliance", {"bending": 0.2, "torsion": 0.0}, 0.25, 1.0),
    # No finite rotation and no cells there: the joint with play is driven well beyond what opens it (4.7 N).
    Truth("cubic-root-stiffness", {"cubic_n_m_per_rad3": 2e7, "root_stiffness_n_m_per_rad": 2000.0}, 1.0, 4.0, SECOND),
    Truth("root-friction", {"friction_n_m": 0.3, "root_stiffness_n_m_per_rad": 2000.0}, 0.5, 2.0, SECOND),
    Truth("root-freeplay", {"gap_rad": 2e-3, "root_stiffness_n_m_per_rad": 2000.0, "kind": "bending"}, 2.0, 8.0,
          SECOND),
)  # fmt: skip


def nominal() -> Scenario:
    """The scenario that the analysis gets: three runs of four sensors, twice."""
    scenario = lab.nominal()
    acquisition = scenario.acquisition.model_copy(update={"runs": (*RUNS, *RUNS)})
    return scenario.model_copy(update={"acquisition": acquisition})


def told(truth: Truth) -> Scenario:
    """The same with what it is told of its model's error."""
    scenario = nominal()
    if truth.model_form is None:
        return scenario
    tolerances = scenario.tolerances.model_copy(update={"model_form": truth.model_form})
    return scenario.model_copy(update={"tolerances": tolerances})


@lru_cache(maxsize=1)
def records(truth: Truth) -> dict[float, tuple[Campaign, tuple[Any, ...]]]:
    """What the drawn aircraft with the effect answers, without instruments' errors: six runs at either amplitude.

    Where runs differ in their sensors alone three are stepped and stand for both halves.
    """
    if truth.source == SECOND:
        return {level: _finite_elements(truth, level) for level in (truth.quiet, truth.loud)}
    scenario = nominal()
    cells = lab.STEPPED_CELLS if truth.engine == "mujoco" else lab.TRUE_CELLS
    true = lab.drawn(lab.quiet(scenario), named_stream(20260101, "one level or two", truth.name), cells)
    half = truth.engine == "mujoco"
    acquisition = true.acquisition.model_copy(update={"runs": RUNS}) if half else true.acquisition
    effect = EffectTable(name=truth.name, **truth.settings)
    true = true.model_copy(update={"effect": (effect,), "seed": 7, "acquisition": acquisition})
    found = {}
    for volt in (truth.quiet, truth.loud):
        driven = true.model_copy(update={"excitation": true.excitation.model_copy(update={"amplitude_v": volt})})
        campaign = simulate(driven, engine=truth.engine).campaign
        runs = campaign.runs
        found[volt] = (campaign, _twice(runs) if half else runs)
    return found


def _twice(runs: tuple[Record, ...]) -> tuple[Record, ...]:
    return (*runs, *(replace(run, run=run.run + len(RUNS)) for run in runs))


def _finite_elements(truth: Truth, level: float) -> tuple[Campaign, tuple[Record, ...]]:
    """The campaign of the second laboratory at a level, and its runs twice."""
    find_the_second_laboratory()
    import jointed_laboratory as jointed

    stiffness = truth.settings["root_stiffness_n_m_per_rad"]
    laws: dict[str, Callable[[], Any]] = {
        "cubic-root-stiffness": lambda: jointed.Cubic(truth.settings["cubic_n_m_per_rad3"]),
        "root-friction": lambda: jointed.Friction(truth.settings["friction_n_m"]),
        "root-freeplay": lambda: jointed.Play(truth.settings["gap_rad"], stiffness),
    }
    scenario = nominal()
    acquisition = scenario.acquisition.model_copy(update={"runs": RUNS})
    drawn = lab.drawn(lab.quiet(scenario), named_stream(20260101, "one level or two", truth.title))
    true = drawn.model_copy(update={"acquisition": acquisition})
    campaign: Campaign = jointed.jointed_campaign(true, laws[truth.name](), stiffness, (level,) * len(RUNS))
    return campaign, _twice(campaign.runs)


def campaign_of(truth: Truth, levels: int) -> Campaign:
    """The campaign as the analysis gets it: the first three runs quiet, or all loud."""
    parts = records(truth)
    campaign, loud = parts[truth.loud]
    first = parts[truth.quiet if levels == 2 else truth.loud][1]
    runs = (*first[: len(RUNS)], *loud[len(RUNS) :])
    joined = replace(campaign, runs=runs, name="campaign", notes={})
    return lab.read_by_instruments(joined, nominal(), named_stream(20260101, "instruments", truth.title), NOISE)


def row_of(truth: Truth, levels: int) -> dict[str, Any]:
    """The verdict on a case in plain values."""
    started = time.process_time()
    catalogue = {n: c for n, c in available_effects().items() if n in (*SHORT, *NONLINEAR)}
    verdict = reconcile(
        campaign_of(truth, levels), told(truth), effects=catalogue, lines=LINES, most=1, with_tests=False
    )
    return {
        "truth": truth.name, "source": truth.source, "levels": levels,
        "verdict": verdict.kind.value, "named": _named(verdict),
        "held_before": _held(verdict, "before"), "held_after": _held(verdict, "after"),
        "rivals": [(r.name, round(r.gain_nats, 1), r.held_out) for r in _rivals(verdict)[:5]],
        "reasons": list(verdict.reasons), "core": core(), "cpu_s": round(time.process_time() - started),
    }  # fmt: skip


def _named(verdict: Verdict) -> str:
    return " | ".join(" or ".join(dict.fromkeys((e.name, *e.equivalent))) for e in verdict.effects)


def _held(verdict: Verdict, end: str) -> float:
    return float(getattr(verdict, end).held_out.chi2_per_dof)


def _rivals(verdict: Verdict) -> Any:
    found = verdict.attribution
    return found.rounds[0].rivals if found.rounds else found.last_rivals


def printed(row: dict[str, Any]) -> dict[str, str]:
    """A case as the page shows it."""
    named = row["named"] or "–"
    rivals = [x for x in row["rivals"] if x[0] not in named]
    top = max((x[1] for x in row["rivals"]), default=0.0)
    behind = f"{rivals[0][0]}, {top - rivals[0][1]:.0f}" if rivals and row["named"] else "–"
    held = f"{row['held_before']:.2f} → {row['held_after']:.2f}"
    verdict = row["verdict"].replace("_", " ")
    plain = (row["truth"], row["source"], str(row["levels"]), verdict, named, held, behind, str(row["cpu_s"]))
    return dict(zip(COLUMNS, (*plain, row["core"]), strict=True))


def known(file: Path = BASELINE) -> list[dict[str, str]]:
    """The cases that were shown last, whichever version they are of."""
    with file.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def merged(old: Iterable[dict[str, str]], new: Iterable[dict[str, str]]) -> list[dict[str, str]]:
    """Cases as the page shows them, the new in place of the old, in the order of the truths."""
    order = {(t.name, t.source, str(levels)): k for k, t in enumerate(TRUTHS) for levels in (1, 2)}
    found = {(r["truth"], r["laboratory"], r["levels"]): r for r in (*old, *new)}
    kept = [key for key in found if key in order]
    return [found[key] for key in sorted(kept, key=lambda key: (order[key], key[2]))]


def results(rows: Iterable[dict[str, str]]) -> str:
    """The table of the page."""
    lines = [(f"`{r['truth']}`", *(r[c] for c in COLUMNS[1:])) for r in rows]
    return table(COLUMNS, lines)


def kept(file: Path) -> dict[str, Any]:
    """The row of a case; InputError where its file is cut off."""
    advice = "remove it: the case is done again when the study goes on in this folder"
    row: dict[str, Any] = read_kept(file, advice)
    if not isinstance(row, dict) or not row.keys() >= {"truth", "levels", "verdict", "named"}:
        raise cut_off(file, advice)
    return row


def is_done(file: Path) -> bool:
    """Whether a case is there, and whole."""
    try:
        return file.is_file() and bool(kept(file))
    except InputError:
        return False


def report(folder: Path) -> None:
    """Fill the page from the cases in a folder, and from those that were shown last where there is none."""
    rows = merged(known(), [printed(kept(file)) for file in sorted(folder.glob("*.json"))])
    with replacing(BASELINE) as part, part.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    write_results(PAGES / "one-level-or-two.md", results(rows))


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line."""
    parser = parser_of_cases(__doc__)
    names = dict.fromkeys(name for t in TRUTHS for name in (t.name, t.title))
    said = f"this truth alone, of both laboratories or of one: {'; '.join(repr(n) for n in names)}"
    parser.add_argument("--only", type=one_of(names), metavar="TRUTH", help=said)
    return cases_asked_for(parser, words)


def go_on(folder: Path, only: str | None) -> None:
    """Run what is not there yet."""
    made(folder)
    console = Console(stderr=True)
    for truth in TRUTHS:
        for levels in (2, 1):
            file = folder / f"{truth.title.replace(', ', '-').replace(' ', '-')}-{levels}.json"
            if only not in (None, truth.name, truth.title) or is_done(file):
                continue
            row = row_of(truth, levels)
            keep(file, row)
            console.print(f"{truth.title}, levels {levels}: {row['verdict']} {row['named']}", highlight=False)
            raise_if_asked()


def main(words: Sequence[str] | None = None) -> int:
    """Run what is not there yet, or fill the page; returns the exit status."""
    given = arguments(words)
    work = partial(report, given.folder) if given.report else partial(go_on, given.folder, given.only)
    return worked_off(work, cases_stay(given.folder))


if __name__ == "__main__":
    sys.exit(main())
