"""How far reconcile can be trusted: ``python docs/studies/closing_the_loop.py FOLDER`` runs the study or goes on.

Every case is one small file in FOLDER, so that a study can be stopped at any time and continued; ``--report`` only
adds them to the baseline of the scoreboard, and fills docs/studies/closing-the-loop.md and its figure from all that is
there.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial
from itertools import zip_longest
from pathlib import Path
from typing import Any

from command_line import (
    add_how_long,
    cases_asked_for,
    cases_stay,
    made,
    one_of,
    parser_of_cases,
    raise_if_asked,
    whole_number,
    worked_off,
)
from loop_cases import NOISE, SECOND, SHORT, SIMULATION, SIZES, Case, linear_effects, second_laboratory_effects
from loop_results import (
    JUDGED,
    Row,
    alone,
    by_key,
    by_verdict,
    confusion,
    headline,
    judged,
    picture,
    placebo_limits,
    with_laboratory,
    write_matrix,
)
from loop_rows import BASELINES, CASES, kept, merged, read_rows, with_whole_catalogue, write_rows
from loop_work import core, work
from rich.console import Console
from virtual_lab import PAGES, write_results

from vgvt.bench.completion import in_order_of_completion
from vgvt.bench.executors import process_pool
from vgvt.bench.store import Store
from vgvt.data import InputError
from vgvt.scenario.streams import named_stream

PLACEBOS, DRAWS, OPEN_DRAWS, PAIRS = 200, 20, 20, 60
# Every fortieth campaign comes from MuJoCo's time domain: each of them takes as long as ten others.
IN_TIME = 40
GROUPS = ("placebo", "effect", "never", "removed", "family", "pair", "beside")


def plan(draws: int, placebos: int, open_draws: int, pairs: int, base: int = 1, short: bool = False) -> list[Case]:
    """All cases, in an order in which a study that is stopped early is still balanced."""
    names, (twins, never) = linear_effects(), second_laboratory_effects()
    names = tuple(n for n in names if not short or n in SHORT)
    queues: list[list[Case]] = []

    def source(k: int) -> dict[str, Any]:
        own = {"source": SECOND} if k % 2 else {"source": SIMULATION}
        return own | {"engine": "mujoco" if k % IN_TIME == IN_TIME - 2 else "linear", "base": base}

    queues.append([Case("placebo", (), k, 0.0, NOISE[k % 3], **source(k)) for k in range(placebos)])
    # Three draws of an effect have every size and every noise, nine all pairs; a step of 41 meets all names in time.
    effects = [
        Case("effect", (name,), k, SIZES[(2 - k) % 3], NOISE[(i + k + k // 3) % 3], base=base,
             engine="mujoco" if (k * len(names) + i) % (IN_TIME + 1) == 9 else "linear")
        for k in range(draws) for i, name in enumerate(names)
    ]  # fmt: skip
    queues.append(effects)
    queues.append(
        [Case("effect", (n,), k, 0.0, NOISE[(k + 1) % 3], SECOND, base=base) for k in range(draws // 2) for n in twins]
    )
    queues.append(
        [Case("never", (n,), k, 0.0, NOISE[(k + 1) % 3], SECOND, base=base) for k in range(open_draws) for n in never]
    )
    for group in ("removed", "family"):
        taken_out = [
            Case(group, (n,), k, SIZES[2], NOISE[(k + 1) % 3], base=base)
            for k in range(max(1, open_draws // 10))
            for n in names
        ]
        queues.append(taken_out)
    pair = [(names[i % len(names)], names[(7 * i + 3) % len(names)]) for i in range(pairs)]
    queues.extend(
        [Case(group, p, k, SIZES[2], NOISE[(k + 1) % 3], base=base) for k, p in enumerate(pair) if p[0] != p[1]]
        for group in ("pair", "beside")
    )
    return [replace(case, short=short) for case in interleaved(queues)]


def alone_plan(draws: int, base: int = 1) -> list[Case]:
    """Every effect of the catalogue as the only one that is known: whether it is found at all, draw by draw."""
    return [
        Case("alone", (name,), k, SIZES[(2 - k) % 3], NOISE[(i + k + k // 3) % 3], base=base)
        for k in range(draws) for i, name in enumerate(linear_effects())
    ]  # fmt: skip


def interleaved(queues: Sequence[Sequence[Case]]) -> list[Case]:
    """Queues merged so that all are equally far at any time."""
    ranked = [((k + 0.5) / len(q), i, case) for i, q in enumerate(queues) for k, case in enumerate(q)]
    return [case for _, _, case in sorted(ranked, key=lambda r: r[:2])]


def in_turn(cases: Sequence[Case], base: int) -> list[Case]:
    """One case of every group after the other, each group in an order drawn for the seed: a fair sample of all."""
    groups = [[c for c in cases if c.group == name] for name in dict.fromkeys(c.group for c in cases)]
    drawn = [[g[k] for k in named_stream(base, "in turn", g[0].group).permutation(len(g))] for g in groups]
    return [case for same in zip_longest(*drawn) for case in same if case is not None]


def small_plan(base: int = 1, short: bool = False) -> list[Case]:
    """A handful of cases that touch everything: for a machine that has minutes."""
    quiet = NOISE[1]
    cases = [
        Case("placebo", (), 0, 0.0, quiet, base=base),
        Case("effect", ("local-absorber",), 0, SIZES[2], quiet, base=base),
        Case("never", ("double-absorber",), 0, 0.0, quiet, SECOND, base=base),
        Case("placebo", (), 1, 0.0, quiet, SECOND, base=base),
        Case("effect", ("channel-delay",), 0, SIZES[2], quiet, SECOND, base=base),
        Case("effect", ("suspension-surge",), 0, SIZES[2], quiet, base=base),
        Case("removed", ("local-absorber",), 0, SIZES[2], quiet, base=base),
        Case("pair", ("local-absorber", "channel-delay"), 0, SIZES[2], quiet, base=base),
    ]
    return [replace(case, short=short) for case in cases]


def results_of(
    cases: Sequence[Any], folder: Path, workers: int, minutes: float, do: Callable[[Any], list[Row]] = work
) -> Generator[tuple[Any, list[Row], bool]]:
    """Every case, its rows and whether they were there already; done ones first, none begun after ``minutes``."""
    store = Store(folder, core())
    left = []
    for case in cases:
        rows = store.rows(case)
        if rows is None:
            left.append(case)
        else:
            yield case, rows, True
    # The clock on the wall: workers are other processes. They live to the end and keep what they once derived.
    in_time = partial(_begun_before, time.time() + 60 * minutes, do)
    pool = in_order_of_completion(left, process_pool(workers) if workers > 1 else None, in_time)
    with closing(pool):
        for case, rows in pool:
            if rows:
                store.keep(case, rows)
                yield case, rows, False


def _begun_before(end: float, do: Callable[[Any], list[Row]], case: Any) -> list[Row]:
    """The rows of a case; none once the time is up."""
    return do(case) if time.time() < end else []


def run(
    cases: Sequence[Any], folder: Path, workers: int, minutes: float, do: Callable[[Any], list[Row]] = work
) -> None:
    """Work off the cases with progress and the time left."""
    console, fresh, start = Console(stderr=True), 0, time.monotonic()
    with closing(results_of(cases, folder, workers, minutes, do)) as every:
        for done, (case, found, old) in enumerate(every, 1):
            raise_if_asked()
            if not old:
                fresh += 1
                left_min = (time.monotonic() - start) / fresh * (len(cases) - done) / 60
                said = found[0].get("named") or found[0].get("test") or found[0].get("reason", "")
                console.print(
                    f"{done}/{len(cases)}, {left_min:.0f} min left: {case.title}: {found[0]['verdict']} {said}",
                    highlight=False, soft_wrap=True,
                )  # fmt: skip


def results(rows: Sequence[Row]) -> str:
    """The tables of the page."""
    judged = sum(r["verdict"] in JUDGED for r in rows)
    other = Counter(r["verdict"] for r in rows if r["verdict"] not in JUDGED)
    beside = "; ".join(f"{n} {name}" for name, n in sorted(other.items())) or "none"
    versions = Counter(r["core"] for r in rows)
    said = ", ".join(f"{core} ({n})" for core, n in versions.most_common())
    tables = {
        "verdict": by_verdict(rows),
        "effect": by_key(rows, "truth"),
        "noise": by_key(rows, "noise"),
        "size": by_key(rows, "size"),
        "laboratory": by_key(with_laboratory(rows), "laboratory"),
    }
    return "\n\n".join(
        (
            f"{judged} campaigns came to a verdict; without one: {beside}. Source of the analysis (cases): {said}.",
            headline(rows),
            *(f"### By {what}\n\n{found}" for what, found in tables.items()),
        )
    )


def report(fresh: Sequence[Row], folder: Path, cases: Path = CASES) -> None:
    """Add fresh rows to the baseline; fill the page, the confusion matrix and what placebos say of thresholds from all.

    The page shows campaigns for which the whole catalogue was to choose from; those of a short one are the folder's.
    """
    seen = [r for r in fresh if r["verdict"] != "not visible"]
    rows = merged(read_rows(cases), with_whole_catalogue(seen))
    write_rows(rows, cases)
    whole = with_whole_catalogue(rows)
    counts = confusion(whole)
    write_results(PAGES / "closing-the-loop.md", results(whole))
    picture(counts)
    write_matrix(counts, BASELINES / "closing-the-loop-confusion.csv")
    try:
        placebo_limits(whole, folder / "thresholds.toml")
    except InputError as error:
        Console(stderr=True).print(f"no thresholds: {error}", highlight=False)


def report_alone(rows: Sequence[Row]) -> None:
    """Fill that part of the page and write its baseline; InputError where there is nothing to fill it from."""
    if not judged(rows, "alone"):
        raise InputError("--report --alone", "the folder keeps no such case", "run it first: --alone without --report")
    write_results(PAGES / "closing-the-loop.md", alone(rows), "of each effect alone")
    write_rows(judged(rows, "alone"), BASELINES / "closing-the-loop-alone.csv")


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line."""
    parser = parser_of_cases(__doc__)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--small", action="store_true", help="a handful of cases instead of all")
    which.add_argument("--alone", action="store_true", help="each effect with itself alone to choose from")
    parser.add_argument("--short", action="store_true", help="a catalogue of twenty effects instead of all")
    parser.add_argument("--draws", type=whole_number(1), default=DRAWS, help="campaigns an effect")
    parser.add_argument("--placebos", type=whole_number(0), default=PLACEBOS, help="campaigns without any effect")
    parser.add_argument("--only", type=one_of(GROUPS), help=f"only this group: {', '.join(GROUPS)}")
    parser.add_argument("--in-turn", action="store_true", help="groups in turn, each in random order: a fair sample")
    add_how_long(parser)
    parser.add_argument("--seed", type=int, default=1, help="a whole number: each draws a study of its own")
    given = cases_asked_for(parser, words)
    if given.alone and (given.only or given.short):
        parser.error("--alone is a group of its own, and a catalogue: write neither --only nor --short beside it")
    return given


def asked_for(given: argparse.Namespace) -> list[Case]:
    """The cases that the command line asks for."""
    if given.small:
        every = small_plan(given.seed, given.short)
    elif given.alone:
        every = alone_plan(given.draws, given.seed)
    else:
        every = plan(given.draws, given.placebos, OPEN_DRAWS, PAIRS, given.seed, given.short)
    every = [c for c in every if given.only in (None, c.group)]
    return in_turn(every, given.seed) if given.in_turn else every


def go_on(given: argparse.Namespace) -> None:
    """Run what is not there yet, or fill the page."""
    if given.report:
        rows = kept(given.folder)
    else:
        made(given.folder)
        every = asked_for(given)
        ours = {case.key for case in every}
        kept(given.folder, ours)  # what is cut is told before the work and not after it
        run(every, given.folder, given.workers, given.minutes)
        rows = kept(given.folder, ours)
    write_rows(rows, given.folder / "cases.csv")
    if given.report and given.alone:
        report_alone(rows)
    elif given.report:
        report(rows, given.folder)


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    given = arguments(words)
    return worked_off(lambda: go_on(given), cases_stay(given.folder))


if __name__ == "__main__":
    sys.exit(main())
