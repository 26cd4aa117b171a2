"""Searches go on from what was kept of them: of the rounds, and of whether a name gives way to another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.reconcile import searches as module
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.evidence.rivals import Rival
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import stored_thresholds
from vgvt.reconcile.searches import Searches

GAIN = Hypothesis(available_effects()["channel-gain"], {"channels": "7+Z"})
DELAY = Hypothesis(available_effects()["channel-delay"], {"channels": "response"})
LIMITS = stored_thresholds()


@pytest.fixture
def null(tmp_path: Path) -> Fit:
    case = problem(tmp_path, 3)
    return fit(case, (), np.zeros(case.size), np.zeros(0), ())


def round_of(null: Fit, *named: Hypothesis) -> Addition:
    found = fit(null.problem, named, null.u, np.full(len(named), 0.2), ())
    rival = Rival(found, 9.5, 11.0, 9.7, 0.7)
    return Addition(rival, (rival,), (rival,), None)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, ...]]:
    """What was asked: searches, with the names that they began with, and exchanges."""
    found: list[tuple[str, ...]] = []

    def searched(start: Fit, hypotheses: Sequence[Hypothesis], limits: Any, *, begun: Any, **rest: Any) -> Any:
        rounds = () if begun is None else begun.rounds
        found.append(("search", *(a.winner.name for a in rounds)))
        return SimpleNamespace(null=start, rounds=rounds, vetoed=(), kept=rest["keep"], hypotheses=hypotheses)

    monkeypatch.setattr(module, "attribute", searched)
    monkeypatch.setattr(module, "strange_names", lambda of: frozenset())
    monkeypatch.setattr(module, "leads_further", lambda *given: True)
    return found


def exchanging(monkeypatch: pytest.MonkeyPatch, asked: list[tuple[str, ...]], *rounds: Addition) -> None:
    def exchange(*given: Any) -> tuple[Addition, ...]:
        asked.append(("exchange",))
        return rounds

    monkeypatch.setattr(module, "exchanged", exchange)


@pytest.mark.parametrize("gives_way", [False, True])
def test_a_call_that_was_broken_off_asks_no_exchange_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, null: Fit, asked: list[tuple[str, ...]], gives_way: bool
) -> None:
    """Neither where a name gave way, nor where none did."""
    exchanging(monkeypatch, asked, *[round_of(null, GAIN)] * gives_way)
    search = Searches((GAIN, DELAY), LIMITS, folder=tmp_path, provenance={"campaign": "mine"})
    first = search.made(null, "rounds")
    after = [("search", "channel-gain")] if gives_way else []
    assert asked == [("search",), ("exchange",), *after]
    asked.clear()
    again = search.made(null, "rounds")
    assert asked == [("search",), *after]
    assert [a.winner.name for a in again.rounds] == [a.winner.name for a in first.rounds]
    # Another question is asked anew, and so is what is kept nowhere.
    for other in (replace(search, provenance={"campaign": "another"}), replace(search, folder=None)):
        asked.clear()
        other.made(null, "rounds")
        assert ("exchange",) in asked


def test_rounds_after_an_exchange_are_gone_on_from(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, null: Fit, asked: list[tuple[str, ...]]
) -> None:
    exchanging(monkeypatch, asked, round_of(null, GAIN))
    search = Searches((GAIN, DELAY), LIMITS, folder=tmp_path)
    further: Any = search.made(null, "rounds")
    further.kept(null, [*further.rounds, round_of(null, GAIN, DELAY)], [])
    asked.clear()
    search.made(null, "rounds")
    assert asked == [("search",), ("search", "channel-gain", "channel-delay")]


def test_what_is_no_plausible_thing_is_left_out(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, null: Fit, asked: list[tuple[str, ...]]
) -> None:
    exchanging(monkeypatch, asked)
    monkeypatch.setattr(module, "strange_names", lambda of: frozenset({"channel-gain"}))
    monkeypatch.setattr(module, "does_without", lambda found, without, nats: True)
    monkeypatch.setattr(module, "telling", lambda found, without: without)
    told: list[tuple[float, str]] = []
    found: Any = Searches((GAIN, DELAY), LIMITS, folder=tmp_path).made(
        null, "rounds", lambda fraction, message: told.append((fraction, message))
    )
    assert [h.name for h in found.hypotheses] == ["channel-delay"]
    assert told == [(0.97, "again without channel-gain")]
