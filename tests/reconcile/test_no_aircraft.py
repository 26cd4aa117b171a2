"""An effect may hold up an aircraft that falls without it: where it is taken away, the search goes on with what is."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vgvt.reconcile.decision import attribute as rounds
from vgvt.reconcile.decision import backward
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.search import shortlist


def falls(*given: Any, **more: Any) -> Any:
    raise NoStructureError("no such structure")


def test_the_model_without_it_stays_where_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    null: Any = SimpleNamespace(problem=None, evidence_nats=0.0)
    winner: Any = SimpleNamespace(fit=SimpleNamespace(u=np.ones(2)))
    better = SimpleNamespace(evidence_nats=3.0)
    monkeypatch.setattr(rounds, "fit", lambda *given: better)
    assert rounds._restart(null, winner) is better
    monkeypatch.setattr(rounds, "fit", falls)
    assert rounds._restart(null, winner) is null


def test_what_holds_it_up_is_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    hypotheses = tuple(SimpleNamespace(parameters=("size",)) for _ in range(2))
    current: Any = SimpleNamespace(
        problem=None, hypotheses=hypotheses, u=np.zeros(1), e=np.zeros(2), evidence_nats=50.0
    )
    needs: Any = SimpleNamespace(evidence_nats=9.0)
    named: Any = ["the first", "the second"]
    without = SimpleNamespace(evidence_nats=49.0)
    monkeypatch.setattr(backward, "fit", lambda *given: without)
    monkeypatch.setattr(backward, "lasting_nats", lambda fit: fit.evidence_nats)
    assert backward.needed(named, current, needs) == (["the second"], without)
    monkeypatch.setattr(backward, "fit", falls)
    assert backward.needed(named, current, needs) == (named, current)


def test_a_calibration_that_forgives_starts_where_there_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stated values beside an effect of its fitted size may describe none."""
    current: Any = SimpleNamespace(problem=None, hypotheses=(), u=np.ones(2), e=np.zeros(1))
    starts: list[Any] = []

    def fitted(problem: Any, hypotheses: Any, u: Any, e: Any, stages: Any, tell: Any, judged: float) -> Any:
        starts.append(u)
        return "fitted" if u.any() else falls()

    monkeypatch.setattr(shortlist, "bent", lambda found: False)
    monkeypatch.setattr(shortlist, "fit", fitted)
    assert shortlist._forgiving(current) == "fitted"
    assert [bool(u.any()) for u in starts] == [False, True]
