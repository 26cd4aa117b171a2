"""Beside a lead stands what comes nearly as near: which of two is ahead by a hair is no finding."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from vgvt.effects import available_effects
from vgvt.reconcile.decision import near_leads
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.near_leads import beside_a_lead, nearly_as_near, with_nearly_as_near
from vgvt.reconcile.decision.verdict import NamedEffect
from vgvt.reconcile.outcome import account


@pytest.fixture(autouse=True)
def plausible_things(monkeypatch: pytest.MonkeyPatch) -> None:
    """All but what says otherwise."""
    monkeypatch.setattr(near_leads, "implausible", lambda fit: fit)


def rival(name: str, held_out: float | None, strange: tuple[str, ...] = ()) -> Any:
    return SimpleNamespace(name=name, held_out=held_out, fit=strange)


def lead(*rivals: Any, before: float | None = 38.6, held_out: float | None = 25.8, alike: tuple[Any, ...] = ()) -> Any:
    """A soft root that takes 12.8 of the held-out error, beside others that were tried."""
    winner = rival("root-compliance", held_out)
    return Addition(winner, (winner, *alike), (winner, *rivals), before)


def test_what_takes_nine_tenths_as_much_is_told() -> None:
    near, far = rival("suspension-surge", 26.3), rival("control-surface", 27.1)
    found = with_nearly_as_near(lead(far, near))
    assert found.equivalent == (found.winner, near)
    (said,) = beside_a_lead(found)
    assert said.startswith("suspension-surge (26.30) in place of root-compliance comes nearly as near")


def test_the_best_variants_of_two_others_are_told_best_first() -> None:
    third, worse = rival("c", 26.2), rival("a", 26.4)
    found = nearly_as_near(lead(worse, third, rival("b", 26.1), rival("a", 26.0), rival("d", 26.9)))
    assert [(r.name, r.held_out) for r in found] == [("a", 26.0), ("b", 26.1)]


@pytest.mark.parametrize(
    "other",
    [
        pytest.param(rival("root-compliance", 25.9), id="another variant of the lead"),
        pytest.param(rival("local-absorber", 25.0, ("3000 Hz",)), id="no plausible thing"),
        pytest.param(rival("re-hang", None), id="nothing held out"),
    ],
)
def test_some_are_not(other: Any) -> None:
    case = lead(other)
    assert with_nearly_as_near(case) is case


def test_what_stands_beside_it_already_is_not_told_twice() -> None:
    twin = rival("suspension-surge", 26.0)
    case = lead(twin, rival("suspension-surge", 26.3), alike=(twin,))
    assert with_nearly_as_near(case) is case
    assert len(beside_a_lead(case)) == 1


def test_what_only_held_out_data_put_first_is_told_so() -> None:
    found = with_nearly_as_near(lead(rival("re-hang", 14.0), rival("suspension-surge", 26.3)))
    near, nearer = beside_a_lead(found)
    assert near.startswith("suspension-surge (26.30)")
    assert nearer.startswith("re-hang (14.00) in place of root-compliance meets held-out data better")


@pytest.mark.parametrize(("before", "held_out"), [(None, None), (38.6, None), (25.0, 25.8)])
def test_a_lead_that_takes_nothing_of_held_out_data_stands_alone(before: float | None, held_out: float | None) -> None:
    case = lead(rival("suspension-surge", 25.8), before=before, held_out=held_out)
    assert with_nearly_as_near(case) is case


def test_each_has_its_own_test_beside_it() -> None:
    known = available_effects()
    winner, near, alike = (
        SimpleNamespace(name=name, hypothesis=SimpleNamespace(cls=known[name]), held_out=25.0)
        for name in ("root-compliance", "suspension-surge", "added-mass")
    )
    addition: Any = Addition(winner, (winner, near, alike), (winner, near, alike), 38.6)
    told = NamedEffect("root-compliance", "", {}, {}, 4105.0, ("suspension-surge",), 38.6, 25.0)
    (row,) = account._effects([told], [addition])
    assert row.separating_test == known["root-compliance"].separating_test
    assert row.tests_of_equivalent == {"suspension-surge": known["suspension-surge"].separating_test}
