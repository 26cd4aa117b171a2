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
    (more,) = said(("a", "b", "c", "d", "e"))
    assert "d, e explain" in more
    # A name may be in two sets.
    for earlier in (("e", "f"), ("a", "f")):
        (other,) = said(earlier, ("a", "b"))
        assert other.startswith(f"Which of {earlier[0]} or f is there")


def test_what_only_stands_beside_an_earlier_name_is_not_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tests are compared for what is in its place beside all others; what explained its round is to be told, too."""

    def rival(name: str, beside: tuple[str, ...] = ()) -> Any:
        hypotheses = tuple(SimpleNamespace(name=n, same=lambda other: True) for n in (*beside, name))
        return SimpleNamespace(name=name, fit=SimpleNamespace(hypotheses=hypotheses), hypothesis=hypotheses[-1])

    first, later = (rival("a"), rival("b")), (rival("a", ("z",)), rival("c", ("z",)))
    found: Any = SimpleNamespace(rounds=[Addition(first[0], first, (), None, later)])
    (said,) = words_of_the_rest(found)
    assert "compared for a, c; b explains" in said


def test_places_are_what_one_effect_at_several_is_called_by() -> None:
    mass = freed(Hypothesis(available_effects()["added-mass"], {"x_m": 0.1, "y_m": 0.2}))

    def rival(x_m: float) -> Any:
        values = {"mass_kg": (0.1, 0.01, "kg"), "x_m": (x_m, 0.001, "m"), "y_m": (0.2, 0.001, "m")}
        fit = SimpleNamespace(hypotheses=(mass,), values=lambda k: values)
        return SimpleNamespace(name="added-mass", fit=fit, hypothesis=Hypothesis(mass.cls, {"x_m": x_m}))

    rivals = tuple(map(rival, (0.1, 0.5, 0.9, 1.3)))
    (said,) = words_of_the_rest(SimpleNamespace(rounds=[Addition(rivals[0], rivals, (), None)]))  # type: ignore[arg-type]
    assert said.count("x_m = ") == 4 and "added-mass (x_m = 1.3, y_m = 0.2) explains" in said


def test_two_starts_that_met_are_one_explanation_and_two_places_are_two(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(undecided_module, "distinct_places", lambda fits: tuple(dict.fromkeys(f[0] for f in fits)))
    mass = available_effects()["added-mass"]
    variants = [Hypothesis(mass, {"x_m": 0.1 * k, "y_m": 0.2}) for k in range(3)]
    ends = (("a", 1), ("a", 2), ("b", 3))
    starts = [SimpleNamespace(name="mass", fit=at, hypothesis=freed(h)) for at, h in zip(ends, variants, strict=True)]
    about: Any = SimpleNamespace(rounds=[Addition(starts[0], tuple(starts), (), None)])  # type: ignore[arg-type]
    assert undecided(about) == (("a", 1), ("b", 3))
