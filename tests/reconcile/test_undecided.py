"""What a next test has to tell apart, and what is said of that for which none was compared."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from vgvt.effects import available_effects
from vgvt.reconcile.decision import undecided as undecided_module
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.undecided import undecided, words_of_the_rest
from vgvt.reconcile.next_test.suggest import suggest
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.candidates import freed

GAIN_CLASS = available_effects()["channel-gain"]


def test_a_test_has_to_tell_names_apart_before_places() -> None:
    """The best fit of each of the last round that names several, not five places of one of them."""

    def rival(name: str, fit: str) -> Any:
        return SimpleNamespace(name=name, fit=fit, hypothesis=Hypothesis(GAIN_CLASS, {"channels": fit}))

    def found(*rounds: tuple[Any, ...]) -> Any:
        return SimpleNamespace(rounds=[Addition(own[0], own, own, None) for own in rounds])

    here, there, like = rival("mass", "here"), rival("mass", "there"), rival("inertia", "like")
    alone = rival("delay", "alone")
    assert undecided(found((here, there, like))) == ("here", "like")
    assert undecided(found((here, there, like), (alone,))) == ("here", "like")
    assert undecided(found((alone,), (here, there))) == ("here", "there")
    assert undecided(found((here, there), (alone,))) == ("here", "there")
    assert undecided(found((here,), (alone,))) == ("alone",)
    assert undecided(found()) == suggest(undecided(found())) == ()


def test_what_no_test_was_compared_for_is_told() -> None:
    """The fourth explanation of a round, and the members of a set of another round."""

    def rival(name: str) -> Any:
        hypothesis = Hypothesis(GAIN_CLASS, {"channels": name})
        return SimpleNamespace(
            name=name, fit=SimpleNamespace(hypotheses=(SimpleNamespace(name=name),)), hypothesis=hypothesis
        )

    def said(*rounds: tuple[str, ...]) -> tuple[str, ...]:
        additions = [Addition(rival(own[0]), tuple(map(rival, own)), (), None) for own in rounds]
        return words_of_the_rest(SimpleNamespace(rounds=additions))  # type: ignore[arg-type]

    assert said(("a", "b", "c")) == said(("alone",), ("a", "b")) == ()
    (fourth,) = said(("a", "b", "c", "d"))
    assert "compared for a, b, c; d explains the data as well" in fourth
    (other,) = said(("e", "f"), ("a", "b"))
    assert other.startswith("Which of e or f is there")


def test_two_starts_that_met_are_one_explanation_and_two_places_are_two(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(undecided_module, "distinct_places", lambda fits: tuple(dict.fromkeys(f[0] for f in fits)))
    mass = available_effects()["added-mass"]
    variants = [Hypothesis(mass, {"x_m": 0.1 * k, "y_m": 0.2}) for k in range(3)]
    ends = (("a", 1), ("a", 2), ("b", 3))
    starts = [SimpleNamespace(name="mass", fit=at, hypothesis=freed(h)) for at, h in zip(ends, variants, strict=True)]
    about: Any = SimpleNamespace(rounds=[Addition(starts[0], tuple(starts), (), None)])  # type: ignore[arg-type]
    assert undecided(about) == (("a", 1), ("b", 3))
