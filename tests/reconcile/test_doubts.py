"""Fits that had not converged, or strain what the scenario states, do not give a whole explanation."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vgvt.effects import available_effects
from vgvt.reconcile.decision import one_level, place_control, reasons
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.doubts import doubts, far_scores, strained_too_much
from vgvt.reconcile.decision.kinds import Kind, kind_of
from vgvt.reconcile.evidence.still_explained import StillExplained
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS

NAMES = tuple(f"unknown {k}" for k in range(30))


@pytest.fixture(autouse=True)
def every_parameter_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fits here are made up, and have no tangent that could say otherwise, and no beams."""
    monkeypatch.setattr(reasons, "untold_parameters", lambda fit, index: ())
    monkeypatch.setattr(reasons, "_of_few_stretches", lambda problem: [])


def fitted(*far: float, converged: bool = True) -> Any:
    """A fit with some far scores."""
    scores = np.zeros(len(NAMES))
    scores[: len(far)] = far
    return SimpleNamespace(scores=scores, converged=converged, problem=SimpleNamespace(names=NAMES), hypotheses=())


def found(null: Any, final: Any, rounds: int = 1) -> Any:
    """What an attribution holds of it, adequate in the end."""
    effect = SimpleNamespace(hypotheses=(SimpleNamespace(settings={}, parameters=()),), values=lambda k: {})
    rival = SimpleNamespace(name="local-absorber", fit=effect, hypothesis=SimpleNamespace(linear=True, settings={}))
    addition = Addition(rival, (rival,), (rival,), None)  # type: ignore[arg-type]
    left = SimpleNamespace(adequate=True)
    return SimpleNamespace(
        null=null,
        final=final,
        rounds=(addition,) * rounds,
        final_residual=left,
        null_residual=left,
        still=None,
        nameless=None,
    )


def test_sound_fits_leave_no_doubt() -> None:
    sound = found(fitted(2.0), fitted(3.5, -4.5))
    assert doubts(sound) == ()
    assert kind_of(sound) is Kind.EXPLAINED


@pytest.mark.parametrize(
    ("null", "final", "word"),
    [
        (fitted(), fitted(converged=False), "not final"),
        (fitted(), fitted(4.2, -5.0), "unknown 1 at -5.0 sd, unknown 0 at +4.2 sd"),
        (fitted(), fitted(0.0, 6.5), "unknown 1 at +6.5 sd"),
    ],
)
def test_each_doubt_is_said_and_makes_the_explanation_partial(null: Any, final: Any, word: str) -> None:
    (said,) = doubts(found(null, final))
    assert word in said
    assert kind_of(found(null, final)) is Kind.PARTLY_EXPLAINED


def test_what_a_law_still_explains_is_a_doubt() -> None:
    more = found(fitted(), fitted())
    more.still = StillExplained("force at 5+Z", "structure", 13.6)
    (said,) = doubts(more)
    assert "A force at 5+Z that is smooth over frequency would still explain 14 nats more" in said
    assert kind_of(more) is Kind.PARTLY_EXPLAINED


def test_a_thing_without_a_name_is_a_doubt_beside_names_and_unknown_without_any() -> None:
    nameless = SimpleNamespace(in_words="a force at 5+Z that is smooth over frequency, explains the data better")
    beside, alone = found(fitted(), fitted()), found(fitted(), fitted(), rounds=0)
    assert kind_of(alone) is Kind.ADEQUATE
    beside.nameless = alone.nameless = nameless
    (said,) = doubts(beside)
    assert said == f"Not alone: one thing that has no name, {nameless.in_words}"
    assert kind_of(beside) is Kind.PARTLY_EXPLAINED
    assert kind_of(alone) is Kind.UNKNOWN


def test_a_calibration_on_its_way_is_a_doubt_where_something_is_left() -> None:
    moving = found(fitted(converged=False), fitted())
    assert doubts(moving) == ()
    moving.final_residual = SimpleNamespace(adequate=False)
    (said,) = doubts(moving)
    assert "had not converged" in said


@pytest.mark.parametrize(
    ("met", "linear", "kind"),
    [(True, False, Kind.AMBIGUOUS), (False, False, Kind.AMBIGUOUS), (True, True, Kind.PARTLY_EXPLAINED)],
)
def test_a_name_that_depends_on_level_awaits_a_second_one_before_anything_else(
    monkeypatch: pytest.MonkeyPatch, met: bool, linear: bool, kind: Kind
) -> None:
    monkeypatch.setattr(one_level, "several_levels", lambda problem: False)
    for scores in ((), (9.0, 9.0)):
        leaning = found(fitted(), fitted(*scores))
        leaning.final_residual = SimpleNamespace(adequate=False, met=met)
        leaning.rounds[0].winner.hypothesis.linear = linear
        assert kind_of(leaning) is kind
    # Only a name that depends on level itself may lean: a linear one beside such a likeness is as doubtful as ever.
    beside = found(fitted(), fitted(9.0, 9.0))
    beside.final_residual = SimpleNamespace(adequate=False, met=met)
    twin = SimpleNamespace(name="root-freeplay", hypothesis=SimpleNamespace(linear=False), fit=None)
    (addition,) = beside.rounds
    beside.rounds = (replace(addition, equivalent=(addition.winner, twin)),)
    assert kind_of(beside) is Kind.PARTLY_EXPLAINED
    going = found(fitted(), fitted(converged=False))
    more = found(fitted(), fitted())
    more.still = StillExplained("force at 5+Z", "structure", 13.6)
    for case in (going, more):
        case.final_residual = SimpleNamespace(adequate=False, met=met)
        case.rounds[0].winner.hypothesis.linear = linear
        assert kind_of(case) is Kind.PARTLY_EXPLAINED


@pytest.mark.parametrize(("linear", "kind"), [(False, Kind.AMBIGUOUS), (True, Kind.PARTLY_EXPLAINED)])
def test_a_joint_whose_fit_had_not_ended_and_meets_the_data_awaits_a_second_level(
    monkeypatch: pytest.MonkeyPatch, linear: bool, kind: Kind
) -> None:
    """Play of the second laboratory, 0.10 held out where 0.98 may be left, was named in part at one level."""
    monkeypatch.setattr(one_level, "several_levels", lambda problem: False)
    going = found(fitted(), fitted(converged=False))
    going.final_residual = SimpleNamespace(adequate=True, met=True)
    going.rounds[0].winner.hypothesis.linear = linear
    assert kind_of(going) is kind
    assert any("not final" in doubt for doubt in doubts(going))


@pytest.mark.parametrize(("also", "kind"), [("left", Kind.AMBIGUOUS), ("right", Kind.EXPLAINED)])
def test_a_side_that_does_as_well_is_no_explanation(monkeypatch: pytest.MonkeyPatch, also: str, kind: Kind) -> None:
    """The same effect on the other side is another repair; another start of the same side is not."""
    monkeypatch.setattr(place_control, "_touched", lambda fit: None)
    case = found(fitted(), fitted())
    (addition,) = case.rounds
    here, there = (
        SimpleNamespace(
            name="root-compliance", fit=addition.winner.fit, hypothesis=SimpleNamespace(linear=True, settings=s)
        )
        for s in ({"side": "right"}, {"side": also})
    )
    case.rounds = (replace(addition, winner=here, equivalent=(here, there)),)
    assert kind_of(case) is kind


def test_without_a_name_there_is_nothing_to_doubt() -> None:
    assert doubts(found(fitted(converged=False), fitted(9.0, 9.0), rounds=0)) == ()


def test_a_calibration_may_strain_as_far_as_a_missing_effect_pulls() -> None:
    assert strained_too_much(fitted(8.0, 5.0))
    assert kind_of(found(fitted(8.0, 5.0), fitted())) is Kind.EXPLAINED


def test_many_far_scores_are_counted_rather_than_listed() -> None:
    assert far_scores(fitted(*(4.0 + np.arange(1, 8)))).endswith("and 3 more beyond 4 sd")
    assert far_scores(fitted(1.0)) == ""


@pytest.mark.parametrize(("score", "kind"), [(3.0, Kind.ADEQUATE), (16.0, Kind.UNKNOWN)])
def test_data_met_far_outside_the_tolerances_are_not_explained(score: float, kind: Kind) -> None:
    """A body's inertia sixteen standard deviations off may stand for something that the catalogue lacks."""
    found: Any = SimpleNamespace(
        rounds=(), null_residual=SimpleNamespace(adequate=True), null=fitted(0.5, score), nameless=None
    )
    assert kind_of(found) is kind


def test_how_coarse_a_chain_the_data_come_from_is_no_tolerance() -> None:
    """Records of the scenario's own chain push it to the end of its range."""
    coarse = fitted(0.5, -9.0)
    coarse.problem.names = ("mass body", CELLS.name, *NAMES[2:])
    assert not strained_too_much(coarse)
    assert far_scores(coarse) == ""
    assert strained_too_much(fitted(0.5, -9.0))


LIMITS: Any = SimpleNamespace(set_nats=5.0, evidence_nats=9.0)


def test_what_an_error_of_the_model_would_do_as_well_is_told_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The best variant of what gains enough line by line alone, and is a thing that could be."""
    monkeypatch.setattr(reasons, "implausible", lambda fit: fit)
    rows = (("loose", 18.0, 3.0, ()), ("loose", 12.0, 2.0, ()), ("mass", 30.0, 20.0, ()), ("drift", 5.0, 1.0, ()),
            ("absorber", 40.0, 2.0, ("120 Hz",)))  # fmt: skip
    tried = tuple(
        SimpleNamespace(name=n, gain_nats=g, lasting_nats=last, fit=strange, hypothesis=SimpleNamespace(label=n))
        for n, g, last, strange in rows
    )
    limits: Any = SimpleNamespace(evidence_nats=9.0)
    (said,) = reasons._lasting_alone(SimpleNamespace(last_rivals=tried), limits)  # type: ignore[arg-type]
    assert said.startswith("loose would gain 18 nats, but 3 where an error of the model lasts")


@pytest.mark.parametrize(
    ("kind", "told"), [(Kind.AMBIGUOUS, True), (Kind.PARTLY_EXPLAINED, True), (Kind.EXPLAINED, False)]
)
def test_what_a_name_leaves_is_said_whatever_else_it_awaits(
    monkeypatch: pytest.MonkeyPatch, kind: Kind, told: bool
) -> None:
    monkeypatch.setattr(reasons, "open_places", lambda addition: ())
    monkeypatch.setattr(reasons, "several_levels", lambda problem: True)
    about = found(fitted(), fitted())
    winner: Any = SimpleNamespace(
        name="root-freeplay", hypothesis=SimpleNamespace(label="root-freeplay", linear=False, settings={}),
        gain_nats=90.0, lasting_nats=80.0, held_out=1.4, fit=SimpleNamespace(chi2_per_dof=1.3, hypotheses=(None,)),
    )  # fmt: skip
    about.rounds = (Addition(winner, (winner,), (winner,), 3.6),)
    about.null.problem = SimpleNamespace(names=NAMES, measured=SimpleNamespace(harmonics=()))
    monkeypatch.setattr(reasons, "rests_on_one_level", lambda found: ("root-freeplay",))
    about.vetoed = ()
    about.null_residual, about.final_residual = (
        SimpleNamespace(reasons=("a",)),
        SimpleNamespace(reasons=("2.3 is left",), adequate=False),
    )
    said = reasons.reasons_of(kind, about, SimpleNamespace(set_nats=5.0, evidence_nats=9.0), None)  # type: ignore[arg-type]
    assert ("With it 2.3 is left" in said) == told
    assert any("needs a second level" in words for words in said)


@pytest.mark.parametrize(
    ("kind", "named", "words"),
    [
        (Kind.EXPLAINED, True, "Without what was named, a free force at 6+Z would explain 40 % of the residual"),
        (Kind.PARTLY_EXPLAINED, True, "With what was named, a free force at 6+Z would explain 40 % of the residual"),
        (Kind.UNKNOWN, False, "A free force at 6+Z would explain 40 % of the residual"),
    ],
)
def test_a_place_is_told_with_the_model_that_leaves_what_it_explains(
    monkeypatch: pytest.MonkeyPatch, kind: Kind, named: bool, words: str
) -> None:
    for name in ("_of_what_is_left", "_of_a_name", "doubts", "_of_the_unknown", "_of_the_implausible"):
        monkeypatch.setattr(reasons, name, lambda *_: [])
    for name in ("rests_on_one_level", "_lasting_alone", "_of_one_at_rest"):
        monkeypatch.setattr(reasons, name, lambda *_: [])
    monkeypatch.setattr(reasons, "strained_too_much", lambda fit: False)
    monkeypatch.setattr(reasons, "several_levels", lambda problem: True)
    place = SimpleNamespace(label="force at 6+Z", kind="structure", explained=0.4, type="unclear")
    problem = SimpleNamespace(measured=SimpleNamespace(harmonics=()))
    found: Any = SimpleNamespace(
        null=SimpleNamespace(problem=problem), rounds=("a name",) if named else (),
        final_residual=SimpleNamespace(reasons=()),
    )  # fmt: skip
    said = reasons.reasons_of(kind, found, SimpleNamespace(), SimpleNamespace(places=(place,)))  # type: ignore[arg-type]
    assert said == (words,)


def test_a_refused_variant_of_a_lead_is_not_told_against_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reasons, "implausible", lambda fit: ())
    monkeypatch.setattr(reasons, "why_no_name", lambda found: "too little")

    def rival(name: str, nats: float = 40.0) -> Any:
        return SimpleNamespace(
            name=name, hypothesis=SimpleNamespace(label=name, settings={}), gain_nats=nats, fit=None, held_out=2.0
        )

    led: Any = SimpleNamespace(
        null=SimpleNamespace(converged=True), vetoed=(rival("soft root"), rival("cable"), rival("cable", 60.0)),
        leads=(SimpleNamespace(winner=rival("soft root"), alike=(), held_out_before=3.0),), nameless=None,
    )  # fmt: skip
    refused = [words for words in reasons._of_the_unknown(led) if "speak against it" in words]
    # Of several variants of one effect the best is told.
    assert [words.split(" nats")[0] for words in refused] == ["cable would gain 60"]


def told(name: str, nats: float, held_out: float | None = 0.9, left: float = 0.9) -> Any:
    """A rival of the catalogue that gains so much."""
    hypothesis = Hypothesis(available_effects()[name])
    return SimpleNamespace(
        name=name, hypothesis=hypothesis, gain_nats=nats, lasting_nats=nats, held_out=held_out,
        fit=SimpleNamespace(chi2_per_dof=left, hypotheses=(hypothesis,)),
    )  # fmt: skip


def test_where_nothing_is_held_out_held_out_data_are_not_blamed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reasons, "implausible", lambda fit: ())
    about: Any = SimpleNamespace(
        null=SimpleNamespace(converged=True), leads=(), vetoed=(told("added-mass", 120.0, None),), nameless=None
    )
    (said,) = (words for words in reasons._of_the_unknown(about) if "added-mass" in words)
    assert said.startswith(
        "added-mass would gain 120 nats, but nothing is held out that could confirm it: a name needs"
    )


@pytest.mark.parametrize(
    ("winner", "other", "plain"),
    [("root-compliance", "cubic-root-stiffness", False), ("cubic-root-stiffness", "root-compliance", True)],
)
def test_only_a_linear_likeness_of_a_joint_is_not_told_by_level(
    monkeypatch: pytest.MonkeyPatch, winner: str, other: str, plain: bool
) -> None:
    """One that held-out data put beside the name, the other way round, is another matter."""
    monkeypatch.setattr(reasons, "open_places", lambda addition: ())
    first, behind = told(winner, 100.0), told(other, 90.0)
    said = reasons._of_a_name(Addition(first, (first, behind), (first, behind), 2.0), LIMITS)
    assert any("no level of force tells the two" in words for words in said) is plain
    assert (
        any("10 nats behind by the data that were fitted, is ahead with those held out" in w for w in said) is not plain
    )
    assert not any("explains the data as well" in words for words in said)


def test_a_name_is_not_ahead_of_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """A control elsewhere may gain more: that its place is open is said of its own."""
    monkeypatch.setattr(reasons, "open_places", lambda addition: ())
    first, elsewhere = told("added-mass", 100.0), told("added-mass", 120.0)
    said = reasons._of_a_name(Addition(first, (first, elsewhere), (first, elsewhere), 2.0), LIMITS)
    assert not any("more than held-out data speak against it" in words for words in said)


def test_what_is_no_plausible_thing_is_told_behind_whatever_was_refused_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """Once for each effect, by its best variant."""
    monkeypatch.setattr(reasons, "implausible", lambda fit: ("120 Hz",) if fit.chi2_per_dof == 0.5 else ())
    others = [told(name, 50.0) for name in ("added-mass", "added-inertia", "mount-compliance")]
    strange = [told("local-absorber", nats, left=0.5) for nats in (30.0, 40.0)]
    about: Any = SimpleNamespace(vetoed=(*others, *strange))
    assert reasons._of_the_implausible(about) == [
        "local-absorber would gain 40 nats, but it is no plausible thing (120 Hz)"
    ]
