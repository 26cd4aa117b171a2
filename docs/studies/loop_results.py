"""Rows of the study as tables, a confusion matrix and its picture; every rate with its Wilson interval."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from loop_cases import OPEN_SET
from virtual_lab import IMAGES, save_figure, table

from vgvt.effects.registry import available_effects
from vgvt.files.atomically import replacing
from vgvt.reconcile.placebo import Placebo, calibrated_thresholds, write_thresholds

Row = dict[str, Any]
CONFIDENCE_Z = 1.959963984540054
"""Normal quantile of a two-sided 95 % interval."""
_AT_THE_LIMIT = 0.1
# What counts as equal in a verdict, too.
_AS_GOOD_NATS = 5.0
JUDGED = ("adequate", "explained", "ambiguous", "partly_explained", "unknown")


def wilson(hits: int, trials: int) -> tuple[float, float]:
    """Wilson's score interval of a rate at 95 % (J. Am. Stat. Assoc. 22, 1927); (0, 1) without a trial."""
    if trials == 0:
        return 0.0, 1.0
    z2 = CONFIDENCE_Z**2
    middle = (hits + z2 / 2) / (trials + z2)
    half = CONFIDENCE_Z * np.sqrt(hits * (trials - hits) / trials + z2 / 4) / (trials + z2)
    return max(float(middle - half), 0.0), min(float(middle + half), 1.0)


def rate(rows: Sequence[Row], hit: Callable[[Row], bool]) -> str:
    """``17 of 20, 85 % (64–95)``."""
    hits = sum(map(hit, rows))
    low, high = wilson(hits, len(rows))
    return f"{hits} of {len(rows)}, {100 * hits / len(rows):.0f} % ({100 * low:.0f}–{100 * high:.0f})" if rows else "–"


def judged(rows: Iterable[Row], group: str) -> list[Row]:
    """Rows of a group that came to a verdict."""
    return [r for r in rows if r["group"] == group and r["verdict"] in JUDGED]


def visible(row: Row) -> bool:
    """Above the detection limit; what has no size counts as such."""
    return not row["ratio"] < 1.0


def named(row: Row) -> bool:
    """Whether the verdict names anything."""
    return bool(row["named"])


def open_set_right(row: Row) -> bool:
    """Unknown, or partly explained with the right place where there is one."""
    return row["verdict"] == "unknown" or (row["verdict"] == "partly_explained" and bool(row["near"]))


def half_right(row: Row) -> bool:
    """Of two effects of which one was taken out: unknown, or explained in part by the other one and nothing else."""
    alone = row["answer"] == "part" and " | " not in row["named"]
    return row["verdict"] == "unknown" or (row["verdict"] == "partly_explained" and alone)


def other_told(row: Row) -> bool:
    """Of two effects of which one was taken out: whether the other one is named, or a lead."""
    return row["answer"] == "part" or row["truth"].split("+")[0] in row["leads"].split(" | ")


def twin(row: Row) -> bool:
    """Whether what is named does as well as the truth itself would, within what counts as equal: nothing tells them."""
    told = row.get("told_ahead_nats")
    return named(row) and told is not None and float(told) <= _AS_GOOD_NATS


def relative(row: Row) -> bool:
    """Whether everything that is named could be taken for the truth, as the catalogue says of either of the two.

    Of names that explain the data alike one is enough.
    """
    alike = _taken_for(row["truth"])
    return named(row) and all(alike & set(part.split(" or ")) for part in row["named"].split(" | "))


@cache
def _taken_for(truth: str) -> frozenset[str]:
    """Names of effects that one could be taken for, or the other way round."""
    catalogue: dict[str, Any] = dict(available_effects())
    stated = catalogue[truth].confused_with if truth in catalogue else ()
    return frozenset(stated).union(name for name, effect in catalogue.items() if truth in effect.confused_with)


def above_its_own(row: Row) -> bool:
    """Whether an effect is above the limit of its own aircraft; rows of older versions do not say."""
    own = row.get("own_ratio")
    return own is not None and float(own) >= 1.0


def at_the_limit(row: Row) -> bool:
    """Whether an effect is as large as gets a name in 95 of 100 campaigns, and not larger."""
    ratio = row.get("ratio")
    return ratio is not None and abs(float(ratio) - 1) <= _AT_THE_LIMIT


def in_set(row: Row) -> bool:
    """Whether the truth is named, alone or beside others."""
    return bool(row["answer"] in ("right", "in the set"))


def deviations_of(row: Row) -> list[float]:
    """Distances of the truth from what was fitted, in stated standard deviations; none in rows of older versions."""
    said = row.get("deviations") or ""
    return [float(part.rsplit(" ", 1)[1]) for part in said.split("; ") if part]


def headline(rows: Sequence[Row]) -> str:
    """The promises, and what was measured: by all versions that left rows, the one that left most, and the last one.

    Rows are in the order in which they were judged.
    """
    counts = Counter(r["core"] for r in rows)
    most = max(counts, key=lambda core: counts[core], default="none")
    last = rows[-1]["core"] if rows else "none"
    heads = [f"by one version, that of most campaigns ({most})"]
    parts = [list(rows), [r for r in rows if r["core"] == most]]
    if last != most:
        heads.append(f"by the last version ({last})")
        parts.append([r for r in rows if r["core"] == last])
    columns = [_promises(part) for part in parts]
    lines = [(what, promise, *(c[k][2] for c in columns)) for k, (what, promise, _) in enumerate(columns[0])]
    return table(("rate", "promise", "measured (95 % Wilson interval)", *heads), lines)


def _promises(rows: Sequence[Row]) -> list[tuple[str, str, str]]:
    """Every rate with what was promised of it."""
    effect, pair = [r for r in judged(rows, "effect") if visible(r)], judged(rows, "pair")
    never, removed, family, beside = (judged(rows, group) for group in ("never", "removed", "family", "beside"))
    return [
        ("placebo: an effect named", "≤ 2 %", rate(judged(rows, "placebo"), named)),
        ("placebo: not called adequate", "", rate(judged(rows, "placebo"), lambda r: r["verdict"] != "adequate")),
        ("truth in the set (≤ 3 members), above the limit", "≥ 95 %", rate(effect, in_set)),
        ("… of these within a tenth of the limit itself", "", rate([r for r in effect if at_the_limit(r)], in_set)),
        ("… of these beyond that", "≥ 95 %", rate([r for r in effect if not at_the_limit(r)], in_set)),
        ("… of those whose own aircraft's limit is known, above that", "≥ 95 %",
         rate([r for r in judged(rows, "effect") if above_its_own(r)], in_set)),
        ("wrong single name, above the limit", "≤ 2 %", rate(effect, lambda r: r["answer"] == "wrong")),
        ("nothing named, above the limit", "", rate(effect, lambda r: not named(r))),
        ("below the limit: wrong single name", "≤ 2 %",
         rate([r for r in judged(rows, "effect") if not visible(r)], lambda r: r["answer"] == "wrong")),
        ("never in a catalogue: unknown, or partly with its place", "≥ 90 %", rate(never, open_set_right)),
        ("never in a catalogue: a single wrong name", "", rate(never, lambda r: r["answer"] == "wrong")),
        ("removed from the catalogue: unknown, or partly with its place", "≥ 90 %", rate(removed, open_set_right)),
        ("… where what is named does not meet the data as well as the truth itself would (5 nats)", "≥ 90 %",
         rate([r for r in removed if not twin(r)], open_set_right)),
        ("removed from the catalogue: that, or a name that the catalogue says it could be taken for", "",
         rate(removed, lambda r: open_set_right(r) or relative(r))),
        ("removed with its whole family: unknown, or partly with its place", "≥ 90 %", rate(family, open_set_right)),
        ("two effects: both named", "≥ 75 %", rate(pair, in_set)),
        ("two effects, one of them removed: unknown, or partly by the other one alone", "", rate(beside, half_right)),
        ("… the other one named, or a lead", "", rate(beside, other_told)),
        ("stated intervals of 95 % that hold the true size or place, truth named alone", "95 %", rate(
            [{"off": d} for r in effect if r["answer"] == "right" for d in deviations_of(r)],
            lambda d: abs(d["off"]) <= CONFIDENCE_Z)),
        ("held-out χ² ≤ 1.15 of a fit that is told", "all", rate(
            [r for r in effect if r.get("oracle_held_out") and in_set(r)],
            lambda r: r["held_after"] <= 1.15 * r["oracle_held_out"])),
    ]  # fmt: skip


def by_verdict(rows: Sequence[Row]) -> str:
    """What was true behind each verdict: how many are right, and what the others were."""
    groups = {"placebo": "nothing missing", "effect": "one effect", "pair": "two", "removed": "removed",
              "family": "removed with its family", "beside": "one of two removed",
              "never": "never catalogued"}  # fmt: skip
    lines = []
    for verdict in JUDGED:
        mine = [r for r in rows if r["verdict"] == verdict]
        wrong = Counter(groups[r["group"]] for r in mine if not _verdict_right(r))
        beside = ", ".join(f"{name} {wrong[name]}" for name in groups.values() if wrong[name]) or "–"
        lines.append((verdict.replace("_", " "), _RIGHT[verdict], rate(mine, _verdict_right), beside))
    return table(("verdict", "right where", "right", "what the others were"), lines)


_RIGHT = {
    "adequate": "nothing is missing, or what is there is below what gets a name",
    "explained": "the truth is in the answer",
    "ambiguous": "the truth is in the answer",
    "partly_explained": "the truth, or all of it that can be, is in the answer, or sits at the place that is told",
    "unknown": "the truth is not in the catalogue",
}


def _verdict_right(row: Row) -> bool:
    """Whether a verdict says what is so, as far as it says it."""
    open_set = row["group"] in OPEN_SET
    if row["verdict"] == "adequate":
        return row["group"] == "placebo" or (row["group"] == "effect" and not visible(row))
    if row["verdict"] == "unknown":
        return open_set
    if row["group"] == "beside":
        return half_right(row)
    return open_set_right(row) if open_set else in_set(row)


def by_key(rows: Sequence[Row], key: str) -> str:
    """Single effects above the limit by a column: what was named, and what held-out data say."""
    groups: dict[Any, list[Row]] = defaultdict(list)
    for row in judged(rows, "effect"):
        if visible(row):
            groups[row[key]].append(row)
    lines = []
    for value in sorted(groups, key=str):
        mine = groups[value]
        before, after = (float(np.median([r[k] for r in mine])) for k in ("held_before", "held_after"))
        fit_before, fit_after = (float(np.median([r[k] for r in mine])) for k in ("nrmse_before", "nrmse_after"))
        lines.append(
            (
                str(value),
                rate(mine, in_set),
                rate(mine, lambda r: r["answer"] == "wrong"),
                f"{before:.2f} → {after:.2f}",
                f"{fit_before:.1f} → {fit_after:.1f} %",
            )
        )
    return table((key, "truth in the set", "wrong single name", "median held-out χ²/ν", "median held-out NRMSE"), lines)


def alone(rows: Sequence[Row]) -> str:
    """Effects that had themselves alone to be chosen from: whether they are found, and what held-out data say."""
    mine = judged(rows, "alone")
    beyond, at = [r for r in mine if visible(r) and not at_the_limit(r)], [r for r in mine if at_the_limit(r)]
    told = [r for r in mine if r["oracle_held_out"] and named(r)]
    lines = [
        ("named, beyond a tenth above what gets a name", rate(beyond, named)),
        ("named, within a tenth of it", rate(at, named)),
        ("named, below", rate([r for r in mine if not visible(r) and not at_the_limit(r)], named)),
        ("held-out χ² ≤ 1.15 of a fit that is told, where named",
         rate(told, lambda r: r["held_after"] <= 1.15 * r["oracle_held_out"])),
        ("stated intervals of 95 % that hold the truth", rate(
            [{"off": d} for r in mine if named(r) for d in deviations_of(r)], lambda d: abs(d["off"]) <= CONFIDENCE_Z)),
    ]  # fmt: skip
    each: dict[str, list[str]] = defaultdict(list)
    for r in sorted(mine, key=lambda r: (r["truth"], -r["size"], r["draw"])):
        told_left = f"{r['oracle_held_out']:.3g}" if r["oracle_held_out"] else "–"
        each[r["truth"]].append(
            f"{r['ratio']:.2g} × at {100 * r['noise']:g} %: {r['verdict'].replace('_', ' ')}, "
            f"{r['held_before']:.3g} → {r['held_after']:.3g} ({told_left}), "
            f"{r['nrmse_before']:.1f} → {r['nrmse_after']:.1f} %"
        )
    versions = ", ".join(f"{core} ({n})" for core, n in Counter(r["core"] for r in mine).most_common())
    unseen = sum(r["verdict"] == "not visible" for r in rows)
    said = f"{len(mine)} campaigns, {unseen} more in which nothing can be seen. Source of the analysis: {versions}."
    head = ("effect", "size over what gets a name, noise: verdict, held-out χ²/ν (a fit that is told), held-out NRMSE")
    draws = [(name, "; ".join(found)) for name, found in each.items()]
    return f"{said}\n\n{table(('rate', 'measured (95 % Wilson interval)'), lines)}\n\n{table(head, draws)}"


def with_laboratory(rows: Sequence[Row]) -> list[Row]:
    """Rows with a column for where their records come from: the simulator by one of its engines, or the second one."""
    stepped = "simulation, stepped in time"
    return [{**r, "laboratory": stepped if r["engine"] == "mujoco" else r["source"]} for r in rows]


def placebo_limits(rows: Sequence[Row], file: Path) -> None:
    """Write thresholds as TOML with their provenance, as :mod:`vgvt.reconcile.placebo` makes them of the placebos."""
    mine = [r for r in judged(rows, "placebo") if "noise_per_dof" in r]
    found = [
        Placebo(
            r["train_before"], r["smooth_before"], r["held_before"], r["evidence_nats"], r["noise_per_dof"],
            r["held_out_noise_per_dof"], strain_sd=r.get("strain_before"),
        )
        for r in mine
    ]  # fmt: skip
    versions = ", ".join(sorted({r["core"] for r in mine}))
    noises = ", ".join(f"{100 * v:g} %" for v in sorted({r["noise"] for r in mine}))
    made_by = f"docs/studies/closing_the_loop.py (Hati; noise {noises}; source of the analysis {versions})"
    write_thresholds(file, calibrated_thresholds(found, made_by))


def confusion(rows: Sequence[Row]) -> Counter[tuple[str, str]]:
    """How often each truth got each answer: the truth where it is in the set, else the first name, else the verdict."""
    counts: Counter[tuple[str, str]] = Counter()
    for row in rows:
        if row["verdict"] not in JUDGED or row["group"] in ("pair", "beside"):
            continue
        truth = row["truth"] or "no effect"
        label = f"{truth} ({row['group']})" if row["group"] in OPEN_SET else truth
        if row["answer"] in ("right", "in the set"):
            said = truth
        elif row["named"]:
            said = row["named"].split(" | ")[0].split(" or ")[0]
        else:
            said = row["verdict"]
        counts[label, said] += 1
    return counts


def write_matrix(counts: Counter[tuple[str, str]], file: Path) -> None:
    """The confusion matrix as a long table."""
    lines = ["truth,answer,cases", *(f"{t},{a},{n}" for (t, a), n in sorted(counts.items()))]
    with replacing(file) as part:
        part.write_text("\n".join(lines) + "\n", encoding="utf-8")


def picture(counts: Counter[tuple[str, str]], file: Path = IMAGES / "study-closing-the-loop.svg") -> None:
    """The confusion matrix: truths down, answers across, shares as shades and counts as numbers."""
    truths = sorted({t for t, _ in counts}, key=lambda t: (t != "no effect", t.endswith(")"), t))
    verdicts = [v for v in ("adequate", "unknown", "partly_explained", "ambiguous") if any(a == v for _, a in counts)]
    answers = [*verdicts, *sorted({a for _, a in counts} - set(verdicts))]
    cells = np.array([[counts[t, a] for a in answers] for t in truths], dtype=float)
    share = cells / cells.sum(axis=1, keepdims=True)
    size = (2.8 + 0.27 * len(answers), 2.0 + 0.21 * len(truths))
    figure, axes = plt.subplots(figsize=size, layout="constrained")
    axes.imshow(share, cmap="Blues", vmin=0, vmax=1, aspect="auto")
    for i, j in zip(*np.nonzero(cells), strict=True):
        axes.text(
            j, i, f"{cells[i, j]:.0f}", ha="center", va="center", fontsize=7, color="w" if share[i, j] > 0.6 else "k"
        )
    axes.set_xticks(range(len(answers)), [a.replace("_", " ") for a in answers], rotation=90, fontsize=7)
    axes.set_yticks(range(len(truths)), truths, fontsize=7)
    axes.set_xticks(np.arange(len(answers)) - 0.5, minor=True)
    axes.set_yticks(np.arange(len(truths)) - 0.5, minor=True)
    axes.grid(which="minor", color="0.9")
    axes.tick_params(which="minor", length=0)
    axes.set(xlabel="answer", ylabel="truth")
    save_figure(figure, file)
    plt.close(figure)
