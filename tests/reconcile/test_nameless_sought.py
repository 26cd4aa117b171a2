"""Places, starts and models that a nameless thing is sought at: the best of each, whoever did the work."""

from __future__ import annotations

import os
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vgvt.reconcile.decision import beside_nameless, nameless_sought
from vgvt.reconcile.decision.beside_nameless import best_beside, each_beside
from vgvt.reconcile.decision.nameless_sought import Without, sought
from vgvt.reconcile.work.progress import silent
from vgvt.reconcile.work.team import ALONE, FORKS, Team

HERE = os.getpid()
MANY = pytest.param(2, marks=pytest.mark.skipif(not FORKS, reason="no process is forked here"))
# By the place and the first score of a start: evidence, cost and whether it meets the data. None: no such aircraft.
BOTTOMS: dict[tuple[str, float], tuple[float, float, bool] | None] = {
    ("wing", 0.0): (3.0, 50.0, False),
    ("wing", 1.0): (9.0, 40.0, True),
    ("wing", 2.0): (99.0, 10.0, True),
    ("body", 0.0): None,
    ("body", 1.0): (5.0, 45.0, False),
    # The bottom that was reached before: no other start is tried.
    ("body", 2.0): (6.0, 44.0, False),
    ("body", 3.0): (99.0, 10.0, True),
}


def where(label: str) -> Any:
    return SimpleNamespace(label=label, words=label)


def model(name: str, *starts: float) -> Any:
    return SimpleNamespace(
        name=name, problem=None, hypotheses=(), u=np.array([starts[-1]]), e=np.zeros(0), starts=starts
    )


def there(problem: Any, hypotheses: Any, u: Any, e: Any, at: Any, worthless: float, stages: Any = ()) -> Any:
    bottom = BOTTOMS[at.label, float(u[0])]
    if bottom is None:
        return None
    evidence, cost, met = bottom
    return SimpleNamespace(evidence_nats=evidence, cost=cost, met=met, by=os.getpid(), where=at)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> Any:
    for module in (nameless_sought, beside_nameless):
        monkeypatch.setattr(module, "places_beside", lambda last, alone: [where("body"), where("wing")])
        monkeypatch.setattr(
            module, "starts_beside", lambda last, kept, alone: [(np.array([s]), alone.e) for s in alone.starts]
        )
        monkeypatch.setattr(module, "with_nameless", there)
    monkeypatch.setattr(nameless_sought, "met", lambda n, most: n.met)
    monkeypatch.setattr(nameless_sought, "rough_start", lambda problem, hypotheses, e: (np.array([3.0]), e))
    return SimpleNamespace(final=None, null_residual=SimpleNamespace(limits=None))


@pytest.mark.parametrize("workers", [1, MANY])
def test_the_best_of_all_places_is_found_beside_each_model(asked: Any, workers: int) -> None:
    models = [
        Without((0,), model("one", 0.0, 1.0)),
        Without((1,), model("other", 0.0)),
        Without((), model("none", 0.0)),
    ]
    with Team(workers, (asked,)) as team:
        found = list(sought(asked, models, 0.0, team, silent))
    assert [without.alone.name for without, _ in found] == ["one", "other", "none"]
    # A start that meets the data is enough; beside no name two more are tried where none does.
    assert [(n.where.label, n.evidence_nats) for _, n in found if n is not None] == [
        ("wing", 9.0), ("wing", 3.0), ("body", 99.0)
    ]  # fmt: skip


def test_where_nobody_helps_what_is_enough_ends_it(asked: Any) -> None:
    begun = []

    def models() -> Iterator[Without]:
        for name in ("first", "second"):
            begun.append(name)
            yield Without((0,), model(name, 1.0))

    next(sought(asked, models(), 0.0, ALONE, silent))
    assert begun == ["first"]
    with Team(2 if FORKS else 1, ()) as team:
        next(sought(asked, models(), 0.0, team, silent))
    assert begun == (["first", "first", "second"] if FORKS else ["first", "first"])


def test_a_bottom_that_is_known_ends_the_search_at_a_place(asked: Any) -> None:
    ((_, found),) = sought(asked, [Without((0,), model("m", 1.0, 2.0, 3.0))], 0.0, ALONE, silent)
    assert found is not None
    # At the body the second start leads to the first one's bottom; the wing meets the data from the first on.
    assert (found.where.label, found.evidence_nats) == ("wing", 9.0)


@pytest.mark.parametrize("workers", [1, MANY])
def test_beside_names_the_best_of_each_choice_is_told(
    asked: Any, monkeypatch: pytest.MonkeyPatch, workers: int
) -> None:
    ours = SimpleNamespace(rounds=(1, 2), final=model("all", 0.0), null=SimpleNamespace(cost=100.0))
    monkeypatch.setattr(beside_nameless, "worth_to", lambda fit: 1.0)
    monkeypatch.setattr(
        beside_nameless,
        "each_alone",
        lambda found, count: iter([((0,), model("a", 0.0, 1.0)), ((1,), model("b", 0.0))]),
    )
    monkeypatch.setattr(beside_nameless, "gained", lambda null, alone, n, worth: np.full(2, n.evidence_nats))
    with Team(workers, (ours,)) as team:
        found, beside = each_beside(ours, 1, 0.0, team), best_beside(ours, team)
    assert [(b.kept, b.fit.name, float(b.nats[0])) for b in found] == [((0,), "a", 9.0), ((1,), "b", 3.0)]
    assert beside is not None and beside.kept == (0, 1) and beside.nats[0] == 3.0
