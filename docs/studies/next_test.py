"""Does the suggested test tell them apart? ``python docs/studies/next_test.py FOLDER`` runs the study or goes on.

Pairs of effects that one campaign of the study's lab can hardly tell apart, each in turn the truth; where both explain
the campaign, the first suggested test is made, in the simulator, and both are asked again. Every case is one small
file in FOLDER; ``--report`` fills docs/studies/next-test.md from them.
"""

from __future__ import annotations

import argparse
import dataclasses
import hashlib
import json
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import loop_truth as lab
import numpy as np
from closing_the_loop import run
from command_line import (
    add_how_long,
    cases_asked_for,
    cases_stay,
    made,
    parser_of_cases,
    whole_number,
    worked_off,
)
from loop_cases import LINES, expected
from loop_results import rate
from loop_rows import kept
from loop_work import core
from virtual_lab import PAGES, table, write_results

from vgvt.data import Campaign, InputError
from vgvt.effects import available_effects
from vgvt.effects.registry import effects_of
from vgvt.reconcile.evidence.rivals import Rival, against
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.next_test.checks import Check, checks, seen
from vgvt.reconcile.next_test.power import power
from vgvt.reconcile.next_test.procedures import Procedure, procedures
from vgvt.reconcile.next_test.suggest import known_in, suggest
from vgvt.reconcile.next_test.with_reading import reading_density
from vgvt.reconcile.question.data import measured_frfs
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, problem_of
from vgvt.reconcile.question.thresholds import stored_thresholds
from vgvt.reconcile.search.candidate_fits import fitted_from
from vgvt.reconcile.search.candidates import candidates
from vgvt.reconcile.search.scan import start_values
from vgvt.reconcile.search.screen import screen
from vgvt.reconcile.work.progress import silent
from vgvt.scenario import Scenario
from vgvt.scenario.effect import EffectTable
from vgvt.scenario.streams import named_stream
from vgvt.simulation import simulated_campaign

Row = dict[str, Any]
NOISE = 0.01
ALIKE = 0.8
# Half of what makes two explanations one answer is what the larger size of a pair should put between them.
APART_NATS, SMALLEST, LARGEST = 2.5, 1.2, 4.0
VARIANTS, READ = 2, 6


@dataclass(frozen=True, slots=True)
class Pair:
    """A truth, the effect that it is taken for, how alike the two are at most, and which of the draws."""

    truth: str
    other: str
    label: str
    parameter: str
    size: float
    cosine: float
    draw: int

    @property
    def key(self) -> str:
        """A hash of all that the result depends on, the code aside."""
        text = json.dumps([self.truth, self.other, self.draw, NOISE, LINES, lab.RUNS, lab.SWEEP_S, lab.TRUE_CELLS])
        return hashlib.sha256(text.encode()).hexdigest()[:24]

    @property
    def title(self) -> str:
        """The pair in words, for progress."""
        return f"{self.truth} taken for {self.other}, draw {self.draw}"

    def stream(self, *name: str) -> np.random.Generator:
        """A random stream of this case's own."""
        return named_stream(1, "next test", self.key, *name)


@lru_cache(maxsize=1)
def _variants() -> tuple[Hypothesis, ...]:
    linear = {n: c for n, c in available_effects().items() if c.linear}  # type: ignore[attr-defined]
    return candidates(expected(NOISE).problem, linear)


def pairs(draws: int) -> list[Pair]:
    """Every pair of effects that the nominal campaign finds alike, at the variant where it does most; both ways."""
    best: dict[tuple[str, str], Pair] = {}
    for p in power(expected(NOISE), _variants()):
        for other, cosine in p.alike if p.visible else ():
            if cosine >= ALIKE and cosine > getattr(best.get((p.effect, other)), "cosine", 0.0):
                # So large that it is seen, no larger than what still leaves the two alike, and plausible.
                ratio = np.sqrt(APART_NATS / (12.5 * max(1 - cosine**2, 1e-6)))
                wanted = float(np.clip(ratio, SMALLEST, LARGEST)) * p.smallest
                size = min(max(wanted, p.low), max(abs(p.low), abs(p.high)))
                best[p.effect, other] = Pair(p.effect, other, p.label, p.parameter, size, round(cosine, 4), 0)
    return [dataclasses.replace(best[k], draw=draw) for draw in range(draws) for k in sorted(best)]


def work(pair: Pair) -> list[Row]:
    """The row of a case; the reason in it where nothing came of it."""
    started = time.process_time()
    row: Row = {"truth": pair.truth, "other": pair.other, "cosine": pair.cosine, "draw": pair.draw, "core": core()}
    try:
        row |= asked(pair)
    except Exception as error:  # noqa: BLE001  one impossible case must not stop a night's work
        row |= {"verdict": "failed", "reason": f"{type(error).__name__}: {error}"[:200]}
    return [row | {"cpu_s": round(time.process_time() - started, 1)}]


def asked(pair: Pair) -> Row:
    """One campaign, both explanations; where it leaves both, the test that is suggested first, and both again."""
    limits, nominal = stored_thresholds(), lab.nominal()
    true = _true(pair)
    null = calibrate(problem_of(_measured(pair, true, nominal, "first"), nominal))
    rivals = {name: _best(null, name) for name in (pair.truth, pair.other)}
    found = [r for r in rivals.values() if r is not None and r.gain_nats >= limits.evidence_nats]
    if len(found) < 2 or abs(found[0].gain_nats - found[1].gain_nats) >= limits.set_nats:
        gains = {name: None if r is None else round(r.gain_nats, 1) for name, r in rivals.items()}
        return {"verdict": "not ambiguous", "reason": str(gains)}
    right, wrong = found
    first_nats = right.gain_nats - wrong.gain_nats
    tests = suggest([right.fit, wrong.fit])
    row = {"verdict": "ambiguous", "first_nats": first_nats, "tests": [dataclasses.asdict(t) for t in tests]}
    if not tests or tests[0].nats < limits.set_nats:
        return row | {"resolved": False, "reason": "no test that tells them is known"}
    second_nats, again = _made(pair, tests[0].test, true, null, (right.fit, wrong.fit))
    # One run more comes with all of the first campaign again: that counts once.
    nats = second_nats + (0.0 if again else first_nats)
    return row | {
        "test": tests[0].test, "expected_nats": tests[0].nats, "second_nats": second_nats, "nats": nats,
        "resolved": nats > limits.set_nats, "wrong": nats < -limits.set_nats,
    }  # fmt: skip


def _made(pair: Pair, words: str, true: Scenario, null: Fit, fits: tuple[Fit, Fit]) -> tuple[float, bool]:
    """Nats that a test, once made, puts between the right and the wrong, and whether it holds the first campaign."""
    problem = fits[0].problem
    check = next((c for c in checks(problem) if c.words == words), None)
    if check is not None:
        return _read(pair, check, true, null, fits), False
    chosen, nominal = next(p for p in procedures(problem) if p.words == words), lab.nominal()
    second = problem_of(
        _measured(pair, _done(pair, chosen, true), chosen.edit(nominal), "second", chosen.sweeps), chosen.edit(nominal)
    )
    calibrated = calibrate(second)
    told = {r.name: r for r in against(calibrated, [_again(second, f) for f in fits])}
    nats = told[pair.truth].gain_nats - told[pair.other].gain_nats
    return nats, len(second.measured.runs) > len(problem.measured.runs)


def _read(pair: Pair, check: Check, true: Scenario, null: Fit, fits: tuple[Fit, Fit]) -> float:
    """A reading off the true rig, with the instrument's error, under what either explanation foretells.

    Each has its say in that of its variants that does best by campaign and reading: the first campaign may have left
    open which it is, the order of a filter far below its corner.
    """
    exact = check.read(seen(true, effects_of(true)))
    error = np.linalg.cholesky(check.covariance(exact.size)) @ pair.stream("reading").standard_normal(exact.size)
    best = []
    for name, first in zip((pair.truth, pair.other), fits, strict=True):
        variants = [first, *(r.fit for r in _fitted(null, name, READ))]
        densities = ((f, reading_density(f, check, exact + error)) for f in variants)
        best.append(max(d + f.evidence_nats - first.evidence_nats for f, d in densities if d is not None))
    return best[0] - best[1]


def _true(pair: Pair) -> Scenario:
    """An aircraft and rig that the tolerances allow, with the effect at its size."""
    true = lab.drawn(lab.quiet(lab.nominal()), pair.stream("truth"))
    variant = next(h for h in _variants() if h.label == pair.label)
    values = {**variant.settings, **start_values(variant), pair.parameter: pair.size}
    return true.model_copy(update={"effect": (EffectTable(name=pair.truth, **values),)})


def _done(pair: Pair, procedure: Procedure, true: Scenario) -> Scenario:
    """The true rig after a change of procedure: what is mounted anew is mounted as well as the first time."""
    after = procedure.edit(true)
    if after.shaker.position_m == true.shaker.position_m:
        return after
    shift = lab.nominal().tolerances.drive_point_m * pair.stream("mounted").standard_normal(2)
    at = tuple(np.array(after.shaker.position_m) + np.array([*shift, 0.0]))
    return after.model_copy(update={"shaker": after.shaker.model_copy(update={"position_m": at})})


def _measured(pair: Pair, true: Scenario, stated: Scenario, which: str, sweeps: int = 1) -> Any:
    """Accelerances of the true aircraft's campaign, read by instruments of the stated tolerances.

    Of averaged ``sweeps`` the mean stands for all.
    """
    campaign: Campaign = simulated_campaign(true, engine="linear")
    noisy = lab.read_by_instruments(campaign, stated, pair.stream("instruments", which), NOISE / sweeps**0.5)
    return measured_frfs(noisy, lines=LINES, floor=stated.tolerances.model_form)


def _best(null: Fit, name: str) -> Rival | None:
    """The best fit of an effect, whichever of its variants it is."""
    return next(iter(_fitted(null, name, VARIANTS)), None)


def _fitted(null: Fit, name: str, count: int) -> tuple[Rival, ...]:
    """The first variants of an effect on its screen, fitted; the best first."""
    variants = candidates(null.problem, {name: available_effects()[name]})
    fits = [fitted_from(null, s, NEAR, silent) for s in screen(null, variants)[:count] if s.visible]
    return against(null, [f for f in fits if f is not None])


def _again(problem: Problem, first: Fit) -> Fit:
    """An explanation fitted to the second campaign from where the first one left it."""
    return fit(problem, first.hypotheses, known_in(problem, first), first.e, NEAR)


def results(rows: Sequence[Row]) -> str:
    """The tables of the page."""
    two = [r for r in rows if r["verdict"] == "ambiguous"]
    none = [r for r in two if "test" not in r]
    made = [r for r in two if "test" in r]
    lines = [
        ("the first suggestion resolves the pair", "≥ 85 %", rate(two, lambda r: r["resolved"])),
        ("… where a test is promised to tell them", "", rate(made, lambda r: r["resolved"])),
        ("no test is promised", "", rate(two, lambda r: "test" not in r)),
        ("the test speaks for the wrong one", "", rate(made, lambda r: r["wrong"])),
    ]
    each = [
        (
            r["truth"], r["other"], f"{r['cosine']:.3f}", f"{r['first_nats']:.1f}", r.get("test", r.get("reason", "")),
            f"{r['expected_nats']:.0f}" if "test" in r else "", f"{r['nats']:.0f}" if "test" in r else "",
            "yes" if r["resolved"] else "no",
        )
        for r in sorted(two, key=lambda r: (r["truth"], r["other"], r["draw"]))
    ]  # fmt: skip
    clear, failed = (sum(r["verdict"] == v for r in rows) for v in ("not ambiguous", "failed"))
    versions = ", ".join(sorted({r["core"] for r in rows}))
    head = ("truth", "other", "cosine", "nats at first", "first suggestion", "nats expected", "nats found", "resolved")
    return (
        f"{len(rows)} cases, {len(two)} of them ambiguous ({clear} were not, {failed} failed; without a promised test "
        f"{len(none)}). Source of the analysis: {versions}.\n\n"
        f"{table(('rate', 'promise', 'measured (95 % Wilson interval)'), lines)}\n\n"
        f"### Each case\n\n{table(head, each)}"
    )


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line."""
    parser = parser_of_cases(__doc__)
    parser.add_argument("--draws", type=whole_number(1), default=2, help="campaigns a pair and direction (2)")
    add_how_long(parser)
    return cases_asked_for(parser, words)


def go_on(given: argparse.Namespace) -> None:
    """Run what is not there yet, or fill the page."""
    if not given.report:
        made(given.folder)
        run(pairs(given.draws), given.folder, given.workers, given.minutes, work)
        return
    rows = kept(given.folder)
    if not rows:
        raise InputError(str(given.folder), "keeps no case", "run the study first: the same without --report")
    write_results(PAGES / "next-test.md", results(rows))


def main(words: Sequence[str] | None = None) -> int:
    """Run the script; returns its exit status."""
    given = arguments(words)
    return worked_off(lambda: go_on(given), cases_stay(given.folder))


if __name__ == "__main__":
    sys.exit(main())
