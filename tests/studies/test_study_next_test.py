"""The study of suggested tests: its pairs, what it counts as resolved, and one case from end to end."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import next_test as study
import numpy as np
import pytest

from vgvt.reconcile.next_test.suggest import Suggestion

PAIR = study.Pair("added-mass", "transducer-mass", "added-mass (x_m = 0.6, y_m = 0.1)", "mass_kg", 0.1, 0.99, 0)


@pytest.mark.parametrize(
    ("cosine", "low", "size"),
    [(0.99, 0.0, 5 * (2.5 / 12.5 / (1 - 0.99**2)) ** 0.5), (0.85, 0.0, 6.0), (1.0, 0.0, 20.0), (0.85, 8.0, 8.0)],
)
def test_sizes_are_seen_and_leave_the_two_alike(
    monkeypatch: pytest.MonkeyPatch, cosine: float, low: float, size: float
) -> None:
    """And both of a pair come up, at the variant where they are most alike."""

    def row(label: str, other: str, cosine: float) -> Any:
        name = label.split()[0]
        return SimpleNamespace(
            effect=name, label=label, parameter="size", smallest=5.0, low=low, high=100.0, visible=True,
            alike=((other, cosine), ("far", 0.5)),
        )  # fmt: skip

    rows = [row("one (a)", "two", 0.82), row("one (b)", "two", cosine), row("two (c)", "one", cosine)]
    monkeypatch.setattr(study, "expected", lambda noise: None)
    monkeypatch.setattr(study, "_variants", lambda: ())
    monkeypatch.setattr(study, "power", lambda fit, variants: rows)
    found = study.pairs(2)
    assert [(p.truth, p.label, p.draw) for p in found] == [
        ("one", "one (b)", 0), ("two", "two (c)", 0), ("one", "one (b)", 1), ("two", "two (c)", 1),
    ]  # fmt: skip
    assert found[0].size == pytest.approx(size)
    assert len({p.key for p in found}) == 4


@pytest.mark.parametrize(
    ("more_runs", "second", "nats", "resolved", "wrong"),
    [
        (0, 9.0, 7.0, True, False),
        (0, 6.0, 4.0, False, False),
        (1, 6.0, 6.0, True, False),
        (0, -9.0, -11.0, False, True),
    ],
)
def test_evidence_of_both_campaigns_counts_and_of_runs_that_come_twice_once(
    monkeypatch: pytest.MonkeyPatch, more_runs: int, second: float, nats: float, resolved: bool, wrong: bool
) -> None:
    """Two nats against the truth at first."""
    gains = {"added-mass": 20.0, "transducer-mass": 22.0}
    test = study.Procedure("a test", lambda s: s, 5.0)

    def problem(measured: int, scenario: Any) -> Any:
        return SimpleNamespace(measured=SimpleNamespace(runs=(0,) * measured))

    def best(null: Any, name: str) -> Any:
        fit = SimpleNamespace(hypotheses=(), e=None, problem=null.problem)
        return SimpleNamespace(name=name, gain_nats=gains[name], fit=fit)

    def measured(pair: Any, true: Any, stated: Any, which: str, sweeps: int = 1) -> int:
        return 5 + more_runs * (which == "second")

    monkeypatch.setattr(study, "_true", lambda pair: study.lab.nominal())
    monkeypatch.setattr(study, "checks", lambda problem: ())
    monkeypatch.setattr(study, "_measured", measured)
    monkeypatch.setattr(study, "problem_of", problem)
    monkeypatch.setattr(study, "calibrate", lambda problem: SimpleNamespace(problem=problem))
    monkeypatch.setattr(study, "_best", best)
    promised = Suggestion("a test", ("added-mass", "transducer-mass"), 30.0, 5.0)
    monkeypatch.setattr(study, "suggest", lambda fits: (promised,))
    monkeypatch.setattr(study, "procedures", lambda problem: (test,))
    monkeypatch.setattr(study, "_again", lambda problem, first: None)
    told = [SimpleNamespace(name=n, gain_nats=g) for n, g in (("added-mass", 30.0), ("transducer-mass", 30.0 - second))]
    monkeypatch.setattr(study, "against", lambda null, fits: told)
    row = study.asked(PAIR)
    assert (row["nats"], row["resolved"], row["wrong"]) == (nats, resolved, wrong)
    gains["transducer-mass"] = 14.0
    assert study.asked(PAIR)["verdict"] == "not ambiguous"
    gains["transducer-mass"] = 8.0
    assert study.asked(PAIR)["verdict"] == "not ambiguous"


def test_a_reading_is_explained_by_the_best_variant_of_either(monkeypatch: pytest.MonkeyPatch) -> None:
    """The campaign had preferred a variant that the reading refuses, by half a nat."""
    check: Any = SimpleNamespace(read=lambda runs: np.zeros(2), covariance=lambda count: np.eye(count))
    first: Any = tuple(SimpleNamespace(evidence_nats=10.0, density=d) for d in (-40.0, -60.0))
    others = {
        "added-mass": [SimpleNamespace(fit=SimpleNamespace(evidence_nats=9.5, density=-1.0))],
        "transducer-mass": [SimpleNamespace(fit=SimpleNamespace(evidence_nats=8.0, density=None))],
    }
    null: Any = None
    monkeypatch.setattr(study, "_fitted", lambda null, name, count: others[name])
    monkeypatch.setattr(study, "reading_density", lambda fit, check, reading: fit.density)
    assert study._read(PAIR, check, study.lab.nominal(), null, first) == pytest.approx(-1.5 + 60.0)


def test_where_no_test_is_promised_the_pair_stays_unresolved(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [
        {"truth": "a", "other": "b", "cosine": 1.0, "draw": 0, "core": "x", "verdict": "ambiguous", "first_nats": 0.1,
         "resolved": False, "reason": "no test that tells them is known"},
        {"truth": "b", "other": "a", "cosine": 1.0, "draw": 0, "core": "x", "verdict": "ambiguous", "first_nats": 0.1,
         "test": "t", "expected_nats": 20.0, "nats": 11.0, "resolved": True, "wrong": False},
        {"truth": "c", "other": "a", "cosine": 0.8, "draw": 0, "core": "x", "verdict": "not ambiguous", "reason": ""},
    ]  # fmt: skip
    said = study.results(rows)
    assert "3 cases, 2 of them ambiguous (1 were not, 0 failed; without a promised test 1)" in said
    assert "1 of 2, 50 %" in said and "1 of 1, 100 %" in said


@pytest.mark.slow
def test_a_mass_at_the_drive_point_and_one_in_the_transducer_are_told_by_another_drive_point() -> None:
    """One case from end to end."""
    pair = next(p for p in study.pairs(1) if (p.truth, p.other) == ("added-mass", "transducer-mass"))
    (row,) = study.work(pair)
    assert row["verdict"] == "ambiguous", row
    assert row["resolved"], row
    assert np.isfinite(row["expected_nats"])
