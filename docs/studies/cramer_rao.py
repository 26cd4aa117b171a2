"""How close every method comes to the Cramér-Rao bound: ``python docs/studies/cramer_rao.py [SEEDS [METHOD ...]]``.

Fills docs/studies/cramer-rao.md. Every identification is kept in docs/_build/cramer-rao.csv, so that the script goes
on where it was stopped and a new method costs its own time only.
"""

from __future__ import annotations

import argparse
import csv
import sys
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from command_line import identifier_named, parser_of_seeds, raise_if_asked, whole_number, worked_off
from kept_documents import cut_off
from numpy.typing import NDArray
from told_noise import told_the_noise
from virtual_lab import PAGES, table, write_results

from vgvt.data import InputError, ModalModel
from vgvt.identification import Needs, available_identifiers, make_identifier, run_identifier
from vgvt.identification.bound import cramer_rao_bound
from vgvt.identification.conformance import without_force
from vgvt.identification.example import Example

KEPT = PAGES.parent / "_build" / "cramer-rao.csv"
SEEDS = 120
PAIR_HZ = (13.7, 13.974)
EXAMPLE = Example(
    frequency_hz=(6.3, *PAIR_HZ, 26.9),
    damping_ratio=(0.012, 0.009, 0.011, 0.007),
    stations=2,
    noise_m_s2=0.5,
)
WITHIN = 0.01  # of its frequency a claim must lie to be a mode's: half the distance of the pair
LIKELIHOOD = ("auto", "maximum-likelihood")
HEAD = ("method", "seed", "mode", "frequency_hz", "damping_ratio", "frequency_std_hz", "damping_ratio_std", "false")


@dataclass(frozen=True, slots=True, eq=False)
class Outcomes:
    """One method over (seeds, modes): claims and stated deviations, NaN where missed; false claims a seed (seeds,)."""

    frequency_hz: NDArray[np.float64]
    damping_ratio: NDArray[np.float64]
    frequency_std_hz: NDArray[np.float64]
    damping_ratio_std: NDArray[np.float64]
    false: NDArray[np.float64]


def identified(method: str, seed: int) -> list[tuple[str, ...]]:
    """One row a mode of what a method says about the campaign of one seed."""
    identifier = make_identifier(method)
    campaign = replace(EXAMPLE, seed=seed).campaign()
    if Needs.OUTPUT_ONLY in identifier.needs:
        campaign = without_force(campaign)
    model = run_identifier(identifier, campaign)
    pairs = claims_of_modes(model)
    false = len(model) - sum(k is not None for k in pairs)
    return [(method, str(seed), str(mode), *_values(model, k), str(false)) for mode, k in enumerate(pairs)]


def claims_of_modes(model: ModalModel) -> list[int | None]:
    """The claim nearest to each true mode, None without one near enough; no claim serves two modes."""
    free = set(range(len(model)))
    found: list[int | None] = []
    for hertz in EXAMPLE.frequency_hz:
        near = [k for k in free if abs(model.natural_frequency_hz[k] / hertz - 1) < WITHIN]
        best = min(near, key=lambda k: abs(model.natural_frequency_hz[k] - hertz)) if near else None
        free.discard(-1 if best is None else best)
        found.append(best)
    return found


def _values(model: ModalModel, k: int | None) -> tuple[str, ...]:
    nan = np.full(len(model), np.nan)
    columns = (
        model.natural_frequency_hz,
        model.damping_ratio,
        nan if model.natural_frequency_std_hz is None else model.natural_frequency_std_hz,
        nan if model.damping_ratio_std is None else model.damping_ratio_std,
    )
    return tuple("nan" if k is None else repr(float(column[k])) for column in columns)


def collected(methods: list[str], seeds: range, kept: Path = KEPT) -> dict[str, Outcomes]:
    """The outcomes of methods: all seeds that are kept, and those of ``seeds`` that are not yet, now."""
    done = {(r["method"], int(r["seed"])) for r in _rows(kept)}
    left = [(m, seed) for seed in seeds for m in methods if (m, seed) not in done]
    if left:
        _begin(kept)
        with kept.open("a", encoding="utf-8", newline="") as stream:
            for method, seed in left:
                csv.writer(stream).writerows(identified(method, seed))
                stream.flush()
                raise_if_asked()
    rows = _rows(kept)
    return {m: outcomes_of([tuple(r.values()) for r in rows if r["method"] == m]) for m in methods}


def _begin(kept: Path) -> None:
    """Let rows be added: below the head of the table, and not behind half a line."""
    kept.parent.mkdir(parents=True, exist_ok=True)
    data = kept.read_bytes() if kept.exists() else b""
    if b"\n" not in data:
        kept.write_text(f"{','.join(HEAD)}\n", encoding="utf-8")
    elif not data.endswith(b"\n"):
        with kept.open("a", encoding="utf-8") as stream:
            stream.write(len(HEAD) * "," + "\n")  # too long now to be taken for a row


def _rows(kept: Path) -> list[dict[str, str]]:
    """The rows of every seed that has a whole one of each mode; of what was done twice the later ones.

    InputError for a file that is something else.
    """
    data = kept.read_bytes() if kept.exists() else b""
    lines = csv.DictReader(data[: data.rfind(b"\n") + 1].decode("utf-8", errors="replace").splitlines())
    if tuple(lines.fieldnames or HEAD) != HEAD:
        raise cut_off(kept, "move it away: the study begins a new one")
    cases: dict[tuple[str, str], dict[str, dict[str, str]]] = {}
    for row in lines:
        if _is_whole(row):
            cases.setdefault((row["method"], row["seed"]), {})[row["mode"]] = row
    return [row for case in cases.values() if len(case) == len(EXAMPLE.frequency_hz) for row in case.values()]


def _is_whole(row: dict[str, str]) -> bool:
    try:
        for name in HEAD[1:]:
            float(row[name])
    except (TypeError, ValueError):
        return False
    return tuple(row) == HEAD


def outcomes_of(rows: list[tuple[str, ...]]) -> Outcomes:
    """The outcomes of one method from its rows, whose columns are ``HEAD``."""
    modes = len(EXAMPLE.frequency_hz)
    rows = sorted(rows, key=lambda r: (int(r[1]), int(r[2])))
    values = np.array([[float(value) for value in r[3:]] for r in rows]).reshape(-1, modes, 5)
    return Outcomes(*(values[:, :, i] for i in range(4)), values[:, 0, 4])


def efficiency_row(method: str, found: Outcomes) -> list[str]:
    """Name, seeds, found, false, rms errors over the bound of lone modes and of the pair, coverage."""
    bound_hz, bound_ratio = cramer_rao_bound(EXAMPLE)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a mode that a method never finds has no mean
        hertz = (found.frequency_hz - np.array(EXAMPLE.frequency_hz)) / bound_hz
        ratio = (found.damping_ratio - np.array(EXAMPLE.damping_ratio)) / bound_ratio
        rms_hz, rms_ratio = (np.sqrt(np.nanmean(e**2, axis=0)) for e in (hertz, ratio))
    inside = [
        np.abs(e * b)[np.isfinite(s)] <= 1.96 * s[np.isfinite(s)]
        for e, b, s in (
            (hertz, bound_hz, found.frequency_std_hz),
            (ratio, bound_ratio, found.damping_ratio_std),
        )
    ]
    hits = np.concatenate(inside)
    alone, pair = [0, 3], [1, 2]
    return [
        f"`{method}`",
        f"{len(found.false)}",
        f"{100 * np.isfinite(found.frequency_hz).mean():.0f}",
        f"{found.false.mean():.2f}",
        *(" / ".join(f"{rms[i]:.2f}" for i in group) for rms in (rms_hz, rms_ratio) for group in (alone, pair)),
        f"{100 * hits.mean():.1f}" if hits.size else "none stated",
    ]


def controlled_ratio(found: Outcomes, told: NDArray[np.float64], expected: NDArray[np.float64]) -> NDArray[np.float64]:
    """Root-mean-square errors over the bound (2 M,) without the luck shared with the fit that is told the noise.

    ``told`` (seeds, 2 M) are that fit's errors in the same campaigns, ``expected`` (2 M,) its standard deviations.
    """
    truth = np.array([*EXAMPLE.frequency_hz, *EXAMPLE.damping_ratio])
    errors = np.hstack([found.frequency_hz, found.damping_ratio]) - truth
    square = (errors**2 - told[: len(errors)] ** 2).mean(axis=0) + expected**2
    return np.asarray(np.sqrt(square) / np.concatenate(cramer_rao_bound(EXAMPLE)))


def report(outcomes: dict[str, Outcomes]) -> str:
    """The table of the page."""
    bound_hz, bound_ratio = cramer_rao_bound(EXAMPLE)
    bounds = table(
        ["mode, Hz", "bound of std(f), mHz", "bound of std(ζ)/ζ, %"],
        [
            [f"{f:g}", f"{1000 * s:.3f}", f"{100 * r / z:.3f}"]
            for f, s, r, z in zip(EXAMPLE.frequency_hz, bound_hz, bound_ratio, EXAMPLE.damping_ratio, strict=True)
        ],
    )
    head = [
        "method",
        "seeds",
        "modes found, %",
        "false a campaign",
        "f: 6.3 / 26.9 Hz",
        "f: pair",
        "ζ: 6.3 / 26.9 Hz",
        "ζ: pair",
        "coverage of 95 % intervals, %",
    ]
    rows = [efficiency_row(method, found) for method, found in outcomes.items()]
    return (
        "Root-mean-square errors over the bound: 1 is the best that any unbiased method can do.\n\n"
        f"{bounds}\n\n{table(head, rows)}\n\n{_without_luck(outcomes)}"
    )


def _without_luck(outcomes: dict[str, Outcomes]) -> str:
    """The likelihood methods mode by mode, less the chance that they share with the fit that is told the noise."""
    likely = {m: outcomes[m] for m in LIKELIHOOD if m in outcomes}
    if not likely:
        return ""
    told, expected = told_the_noise(EXAMPLE, range(max(len(o.false) for o in likely.values())))
    own = [f"{e:.3f}" for e in expected / np.concatenate(cramer_rao_bound(EXAMPLE))]
    rows = [
        ["told the noise, by its information", "", *own],
        *(
            [f"`{m}`", f"{len(o.false)}", *(f"{r:.3f}" for r in controlled_ratio(o, told, expected))]
            for m, o in likely.items()
        ),
    ]
    names = [f"{kind}: {f:g} Hz" for kind in ("f", "ζ") for f in EXAMPLE.frequency_hz]
    return f"The likelihood methods with the luck of the draw taken out:\n\n{table(['method', 'seeds', *names], rows)}"


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line."""
    parser = parser_of_seeds(__doc__, whole_number(1), SEEDS, "a method")
    said = "an installed identifier (all of them if nothing is said)"
    parser.add_argument("methods", nargs="*", type=identifier_named, metavar="METHOD", help=said)
    parser.add_argument("--page", action="store_true", help="only fill the page from what is kept")
    return parser.parse_args(words)


def go_on(seeds: int, methods: Sequence[str], page_alone: bool) -> None:
    """Identify what is missing and write the table of all that is kept; InputError where nothing is."""
    if not page_alone:
        collected(list(methods) or sorted(available_identifiers()), range(seeds))
    found = sorted({row["method"] for row in _rows(KEPT)})
    if not found:
        raise InputError("--page", f"{KEPT} keeps nothing", "run the study first: the same without --page")
    write_results(PAGES / "cramer-rao.md", report(collected(found, range(0))))


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    given = arguments(words)
    kept = f"every seed that is done is kept in {KEPT}; the same command goes on from there"
    return worked_off(lambda: go_on(given.seeds, given.methods, given.page), kept)


if __name__ == "__main__":
    sys.exit(main())
