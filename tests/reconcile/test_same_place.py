"""A name that leaves the residual to the place that explained it before is none."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from vgvt.reconcile.decision import attribute as rounds
from vgvt.reconcile.evidence.same_place import left_where_it_was


def explained(**shares: float) -> Any:
    """A localisation by what each place explains."""
    places = sorted(shares.items(), key=lambda p: -p[1])
    return SimpleNamespace(places=tuple(SimpleNamespace(label=k, explained=v) for k, v in places))


@pytest.mark.parametrize(
    ("before", "after", "missed_after", "refused"),
    [
        # The body explains nearly all, and nearly all of the rest: the name was beside the point.
        ({"body": 0.9, "tip": 0.7}, {"body": 0.95, "tip": 0.7}, 40.0, True),
        # It takes away what the body explained: something else is left.
        ({"body": 0.9, "tip": 0.7}, {"tip": 0.9, "body": 0.5}, 40.0, False),
        # Two effects: no place explains nearly all, and either may be named first.
        ({"body": 0.6, "tip": 0.5}, {"body": 0.9, "tip": 0.3}, 40.0, False),
        # Right but inexact: the little that is left sits where the effect does.
        ({"body": 0.9}, {"body": 0.9}, 10.0, False),
        ({}, {}, 40.0, False),
    ],
)
def test_what_one_place_explains_must_go(
    before: dict[str, float], after: dict[str, float], missed_after: float, refused: bool
) -> None:
    assert left_where_it_was(explained(**before), explained(**after), 80.0, missed_after) is refused


NEEDS: Any = SimpleNamespace(evidence_nats=9.0, set_nats=5.0)
MISSED: Any = SimpleNamespace(
    held_out_chi2_per_dof=80.0, held_out_noise_per_dof=0.7, limits=SimpleNamespace(held_out_per_dof=1.0)
)


def rival(place: str, gain_nats: float, held_out: float, left: float = 20.0) -> Any:
    """One that explains the data so well, and leaves them to a place."""
    return SimpleNamespace(fit=SimpleNamespace(place=place, chi2_per_dof=left), gain_nats=gain_nats, held_out=held_out)


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The fit without a name, all of whose residual the body explains, as nearly all of what is left beside a name."""
    known = {"null": explained(body=0.9), "body": explained(body=0.95), "tip": explained(tip=0.9, body=0.1)}
    monkeypatch.setattr(rounds, "localise", lambda fit, everywhere: known[fit.place])
    return SimpleNamespace(place="null")


def test_the_next_best_may_win_where_the_best_is_beside_the_point(shown: Any) -> None:
    beside, right, met = rival("body", 90.0, 30.0), rival("tip", 50.0, 40.0), rival("body", 95.0, 0.9)
    assert rounds._taking_it_away(shown, [right, beside], MISSED, NEEDS) == ([right], (right, (right,)))
    assert rounds._taking_it_away(shown, [beside], MISSED, NEEDS) == ([], None)
    # Held-out data that are met need no place to speak for the name.
    assert rounds._taking_it_away(shown, [beside, met], MISSED, NEEDS) == ([met, beside], (met, (met,)))


def test_it_is_asked_of_what_would_win_and_not_of_what_gains_most(monkeypatch: pytest.MonkeyPatch, shown: Any) -> None:
    """Where much is left held-out data choose among the confirmed; where little is, all data among equals."""
    most, chosen = rival("tip", 100.0, 40.0), rival("body", 60.0, 25.0)
    assert rounds._taking_it_away(shown, [most, chosen], MISSED, NEEDS) == ([most], (most, (most,)))
    most, chosen = rival("tip", 62.0, 40.0, left=1.2), rival("body", 60.0, 25.0, left=1.2)
    monkeypatch.setattr(rounds, "held_out_nats", lambda judge, found, without: 10.0 * (found is chosen.fit))
    assert rounds._taking_it_away(shown, [most, chosen], MISSED, NEEDS) == ([most], (most, (most,)))


def test_a_round_asks_it_of_its_winner(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is refused for it is kept among the refused, and the verdict has no name."""
    null: Any = SimpleNamespace(chi2_per_dof=1.0, problem=None)
    joint = SimpleNamespace(linear=False)
    fit = SimpleNamespace(converged=True, chi2_per_dof=20.0)
    beside: Any = SimpleNamespace(
        fit=fit, name="beside", gain_nats=90.0, held_out=40.0, hypothesis=joint, convinces=lambda limits: True
    )
    limits = SimpleNamespace(held_out_per_dof=1.0)
    left = SimpleNamespace(
        held_out_chi2_per_dof=80.0,
        held_out_noise_per_dof=0.7,
        limits=limits,
        train_chi2_per_dof=1.0,
        adequate=False,
        fitted_adequate=True,
    )
    monkeypatch.setattr(rounds, "localise", lambda fit, everywhere: explained(body=0.9 if fit is null else 0.95))
    monkeypatch.setattr(rounds, "residual", lambda fit, thresholds: left)
    monkeypatch.setattr(rounds, "linear_first", lambda problem, hypotheses: (list(hypotheses), []))
    monkeypatch.setattr(rounds, "tried", lambda *given: (beside,))
    monkeypatch.setattr(rounds, "_restart", lambda null, winner: null)
    monkeypatch.setattr(rounds, "against", lambda current, fits: (beside,))
    monkeypatch.setattr(rounds, "_passed", lambda *given: True)
    monkeypatch.setattr(rounds, "takes_enough", lambda *given: True)
    monkeypatch.setattr(rounds, "ended", lambda current, rivals, *given: rivals)
    monkeypatch.setattr(rounds, "likelier", lambda confirmed, equal: list(confirmed))
    found = rounds.attribute(null, (), NEEDS)
    assert found.rounds == () and found.vetoed == (beside,)
