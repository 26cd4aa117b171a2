"""Who reads a name is told of its relatives: how far behind each is, or that it was not there to be chosen."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from vgvt.effects import available_effects
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.relatives import words_of_relatives

KNOWN = {"drift", "warming", "roving", "creep"}


def rival(name: str, nats: float, *likenesses: str) -> Any:
    cls = SimpleNamespace(confused_with=likenesses)
    return SimpleNamespace(name=name, gain_nats=nats, hypothesis=SimpleNamespace(cls=cls))


DRIFT = rival("drift", 50.0, "warming", "roving")


def told(
    *rivals: Any,
    equivalent: tuple[Any, ...] = (),
    offered: set[str] = KNOWN,
    tried: set[str] = KNOWN,
    vetoed: tuple[Any, ...] = (),
    exchanged: bool = False,
) -> Any:
    addition = Addition(DRIFT, (DRIFT, *equivalent), (DRIFT, *rivals), None, exchanged=exchanged)
    return words_of_relatives(SimpleNamespace(rounds=(addition,), vetoed=vetoed), offered, tried)  # type: ignore[arg-type]


def test_how_far_behind_each_is_that_was_fitted_by_its_best_variant() -> None:
    others = (rival("warming", 20.0), rival("warming", 38.0), rival("warming", 12.0), rival("creep", 45.0))
    assert told(*others) == (
        "Of what drift could be taken for, warming is 12 nats behind; roving was not fitted in its round",
    )


def test_one_that_is_ahead_was_refused() -> None:
    (said,) = told(rival("warming", 61.0))
    assert "warming, 11 nats ahead, was refused" in said


def test_what_was_not_there_to_be_chosen_is_said() -> None:
    (said,) = told(rival("roving", 10.0), offered={"drift", "roving"}, tried={"drift", "roving"})
    assert said == (
        "Of what drift could be taken for, roving is 40 nats behind; warming was not among the effects to choose from"
    )
    (said,) = told(offered={"drift"}, tried={"drift"})
    assert said.endswith("for, warming, roving were not among the effects to choose from")


@pytest.mark.parametrize(
    ("equivalent", "tried"),
    [
        pytest.param((rival("warming", 49.0), rival("roving", 48.0)), KNOWN, id="told beside it"),
        pytest.param((), {"drift"}, id="no campaign like this can have it"),
    ],
)
def test_of_others_nothing_is_said(equivalent: tuple[Any, ...], tried: set[str]) -> None:
    assert told(equivalent=equivalent, tried=tried) == ()


def test_what_has_a_name_of_its_own_is_no_relative_of_another() -> None:
    creep = rival("creep", 20.0)
    rounds = (Addition(DRIFT, (DRIFT,), (DRIFT, creep), None), Addition(w := rival("warming", 9.0), (w,), (w,), None))
    (said,) = words_of_relatives(SimpleNamespace(rounds=rounds, vetoed=()), KNOWN, KNOWN)  # type: ignore[arg-type]
    assert said == "Of what drift could be taken for, roving was not fitted in its round"


def test_every_likeness_is_an_effect_that_is_installed() -> None:
    """Or it would be said of every name that something was not there to be chosen."""
    known = available_effects()
    assert {n for cls in known.values() for n in cls.confused_with} <= set(known)


def test_what_was_refused_is_told_as_such_and_what_an_exchange_had_compared_is_not_called_unfitted() -> None:
    creep, warming = rival("creep", 20.0), rival("warming", 90.0)
    (said,) = told(creep, vetoed=(warming,))
    assert said == "Of what drift could be taken for, roving was not fitted in its round"
    assert told(exchanged=True) == told(creep, exchanged=True) == ()
    # A round in which nothing but the name was fitted compared it with no relative.
    assert told() == ("Of what drift could be taken for, warming, roving were not fitted in its round",)


def test_what_gave_way_to_a_name_was_not_refused() -> None:
    """It had gained most while it was alone: that is when names are exchanged."""
    (said,) = told(rival("warming", 61.0), exchanged=True)
    assert said == "Of what drift could be taken for, warming, 11 nats ahead, gave way beside the others"
