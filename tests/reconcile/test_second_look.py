"""A round looks again where a better start of the calibration has brought it near, and only there."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vgvt.reconcile.decision import attribute as rounds
from vgvt.reconcile.fitting.fit import FORGIVING
from vgvt.reconcile.search import shortlist

THRESHOLDS: Any = SimpleNamespace(evidence_nats=9.0, set_nats=5.0)


@pytest.mark.parametrize(("before", "after", "looks"), [(20.0, 0.7, 2), (20.0, 15.0, 1), (1.0, 0.7, 1)])
def test_looks_again_from_where_the_calibration_belongs(
    monkeypatch: pytest.MonkeyPatch, before: float, after: float, looks: int
) -> None:
    null, better = (SimpleNamespace(chi2_per_dof=c, problem=None) for c in (before, after))
    rival = SimpleNamespace(fit="a rival", name="rival")
    seen: list[Any] = []
    repeated: list[bool] = []

    def tried(current: Any, *others: Any, again: bool = False) -> tuple[Any, ...]:
        seen.append(current)
        repeated.append(again)
        return (rival,)

    def left(fit: Any, thresholds: Any) -> Any:
        return SimpleNamespace(train_chi2_per_dof=fit.chi2_per_dof, adequate=True, fitted_adequate=True)

    monkeypatch.setattr(rounds, "tried", tried)
    monkeypatch.setattr(rounds, "residual", left)
    monkeypatch.setattr(rounds, "linear_first", lambda problem, hypotheses: (list(hypotheses), []))
    monkeypatch.setattr(rounds, "_restart", lambda null, winner: better)
    monkeypatch.setattr(rounds, "against", lambda current, fits: ())
    found = rounds.attribute(null, (), THRESHOLDS)
    assert seen == [null, better][:looks]
    assert repeated == [False, True][:looks]
    assert found.null is better


@pytest.mark.parametrize(
    ("confirmed", "adequate", "named", "asked"),
    [
        ((), False, False, ["stiffens", "slips"]),
        ((), False, True, []),
        ((), True, False, []),
        (("soft",), False, True, ["stiffens"]),
        (("heavy",), False, False, []),
    ],
)
def test_at_one_level_nonlinear_joints_are_asked_for_where_they_could_be_told(
    confirmed: tuple[str, ...], adequate: bool, named: bool, asked: list[str]
) -> None:
    """All where nothing has a name at all, the likeness of a name always, nothing beside an earlier name."""
    like = {"stiffens": ("soft",), "slips": ()}
    bent: Any = [SimpleNamespace(name=n, cls=SimpleNamespace(confused_with=other)) for n, other in like.items()]
    rivals: Any = [SimpleNamespace(name=n) for n in confirmed]
    before: Any = SimpleNamespace(adequate=adequate)
    assert [h.name for h in rounds._twins(bent, rivals, before, named)] == asked


def held(name: str, gain_nats: float, held_out: float, left: float) -> Any:
    """A rival that gains so much, misses held-out data by so much, and leaves so much of its own."""
    return SimpleNamespace(name=name, gain_nats=gain_nats, held_out=held_out, fit=SimpleNamespace(chi2_per_dof=left))


@pytest.mark.parametrize(
    ("left", "first", "set_of"), [(0.8, "most", ["most", "near"]), (13.0, "as good", ["best held out", "as good"])]
)
def test_where_much_is_left_held_out_data_say_what_is_best_and_what_is_as_good(
    left: float, first: str, set_of: list[str]
) -> None:
    """Evidence then weighs wrong unknowns: it only chooses among those that held-out data put first."""
    rows = (("most", 400.0, 36.0), ("near", 396.0, 36.0), ("best held out", 290.0, 30.0), ("as good", 300.0, 31.0))
    confirmed = [held(*row, left) for row in rows]
    winner = rounds._first(confirmed)
    assert winner.name == first
    assert [r.name for r in rounds._equal(winner, confirmed, THRESHOLDS)] == set_of


def a_round(monkeypatch: pytest.MonkeyPatch, begun: Any, ended: Any) -> None:
    """Rounds that each find one rival, which passes everything, and in which data are met after the first name."""

    def rival(fit: Any) -> Any:
        return SimpleNamespace(fit=fit, name="it", gain_nats=90.0, held_out=0.8, convinces=lambda limits: True)

    left: Any = SimpleNamespace(held_out_chi2_per_dof=2.0, train_chi2_per_dof=1.0, adequate=True, fitted_adequate=True)
    monkeypatch.setattr(rounds, "residual", lambda fit, thresholds: left)
    monkeypatch.setattr(rounds, "linear_first", lambda problem, hypotheses: (list(hypotheses), []))
    monkeypatch.setattr(rounds, "tried", lambda *given: (rival(begun),))
    monkeypatch.setattr(rounds, "_restart", lambda null, winner: null)
    monkeypatch.setattr(rounds, "against", lambda current, fits: tuple(map(rival, fits)))
    monkeypatch.setattr(rounds, "_passed", lambda *given: True)
    monkeypatch.setattr(rounds, "ended", lambda *given: (rival(ended),))
    monkeypatch.setattr(rounds, "straightened", lambda confirmed, set_nats: list(confirmed))
    monkeypatch.setattr(rounds, "likelier", lambda confirmed, equal: list(confirmed))
    monkeypatch.setattr(rounds, "reconsidered", lambda found, *asked, met: found)
    monkeypatch.setattr(rounds, "nowhere", lambda addition: False)
    monkeypatch.setattr(rounds, "needed", lambda found, current, thresholds: (found, current))
    monkeypatch.setattr(
        rounds, "_taking_it_away", lambda current, confirmed, *given: (confirmed, (confirmed[0], ())) if confirmed
        else ([], None),
    )  # fmt: skip
    monkeypatch.setattr(rounds, "controlled", lambda addition, *given: addition)
    monkeypatch.setattr(rounds, "plain_likenesses", lambda *given: ())


def a_fit(chi2_per_dof: float) -> Any:
    return SimpleNamespace(chi2_per_dof=chi2_per_dof, problem=None, converged=True)


@pytest.mark.parametrize("enough", [True, False])
def test_what_a_name_takes_of_its_own_data_is_asked_at_the_end_of_its_fit(
    monkeypatch: pytest.MonkeyPatch, enough: bool
) -> None:
    """A fit that is on its way may take little yet; one that has ended and takes little is refused."""
    asked: list[Any] = []
    begun, ended = a_fit(0.9), a_fit(0.7)
    a_round(monkeypatch, begun, ended)
    monkeypatch.setattr(rounds, "takes_enough", lambda fit, *given: asked.append(fit) or enough)
    found = rounds.attribute(a_fit(1.0), (), THRESHOLDS, most=1)
    assert asked == [ended]
    assert [r.winner.fit for r in found.rounds] == ([ended] if enough else [])
    assert [r.fit for r in found.vetoed] == ([] if enough else [ended])


def test_rounds_go_on_beside_data_that_are_met(monkeypatch: pytest.MonkeyPatch) -> None:
    """A mass that 4.7 deviations of the body's imitated was left behind where a mount had its name: 89 nats."""
    a_round(monkeypatch, a_fit(0.9), a_fit(0.7))
    monkeypatch.setattr(rounds, "takes_enough", lambda *given: True)
    assert len(rounds.attribute(a_fit(1.0), (), THRESHOLDS, most=2).rounds) == 2


@pytest.mark.parametrize(
    ("left", "gain_nats", "held_out", "strange", "ahead"),
    [
        (0.8, 37.0, 0.85, (), True),
        (0.8, 37.0, 0.95, (), False),
        (0.8, 24.0, 0.85, (), False),
        (13.0, 37.0, 0.85, (), False),
        (0.8, 37.0, 0.85, ("off the aircraft",), False),
    ],
)
def test_what_is_ahead_by_all_data_is_named_beside_the_confirmed(
    monkeypatch: pytest.MonkeyPatch,
    left: float,
    gain_nats: float,
    held_out: float,
    strange: tuple[str, ...],
    ahead: bool,
) -> None:
    """Where little is left: 12 nats more on fitted data against 10 or 30 less on those held out."""
    monkeypatch.setattr(rounds, "held_out_nats", lambda judge, found, without: 200 * (without.missed - found.missed))
    monkeypatch.setattr(rounds, "implausible", lambda fit: strange)

    def fit(missed: float) -> Any:
        return SimpleNamespace(chi2_per_dof=left, missed=missed)

    winner: Any = SimpleNamespace(
        name="confirmed", gain_nats=25.0, held_out=0.8, fit=fit(0.8), convinces=lambda limits: True
    )
    other, same, drifting = (
        SimpleNamespace(
            name=name, gain_nats=gain, held_out=missed, fit=fit(missed), convinces=lambda limits, told=told: told
        )
        for name, gain, missed, told in (
            ("refused", gain_nats, held_out, True), ("confirmed", 60.0, 0.8, True), ("drifting", 60.0, 0.8, False),
        )
    )  # fmt: skip
    tried: list[Any] = [winner, other, same, drifting]
    found = rounds._ahead_in_all(winner, tried, [winner], THRESHOLDS)
    # What an error that lasts would do as well is not ahead of anything.
    assert found == ([other] if ahead else [])


def test_what_was_refused_for_another_reason_does_not_come_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """A joint whose law the data do not ask for is ahead by its law, and was left out for that: not beside the name."""
    plain, bent = a_fit(0.7), a_fit(0.7)
    a_round(monkeypatch, plain, plain)

    def rival(name: str, fit: Any, gain_nats: float) -> Any:
        return SimpleNamespace(name=name, fit=fit, gain_nats=gain_nats, held_out=0.8, convinces=lambda limits: True)

    both = rival("bent", bent, 92.0), rival("plain", plain, 90.0)
    monkeypatch.setattr(rounds, "ended", lambda *given: both)
    monkeypatch.setattr(rounds, "takes_enough", lambda *given: True)
    monkeypatch.setattr(rounds, "straightened", lambda confirmed, set_nats: [r for r in confirmed if r.name != "bent"])
    monkeypatch.setattr(rounds, "held_out_nats", lambda judge, found, without: 0.0)
    monkeypatch.setattr(rounds, "implausible", lambda fit: ())
    found = rounds.attribute(a_fit(1.0), (), THRESHOLDS, most=1)
    assert found.rounds[0].winner.name == "plain"
    assert found.rounds[0].equivalent == ()


def test_what_control_tried_elsewhere_is_among_what_was_asked_last(monkeypatch: pytest.MonkeyPatch) -> None:
    """As it is in a search that goes on from its file."""
    begun = a_fit(0.9)
    a_round(monkeypatch, begun, begun)
    elsewhere: Any = SimpleNamespace(name="it", fit="elsewhere")
    monkeypatch.setattr(rounds, "takes_enough", lambda *given: True)
    monkeypatch.setattr(rounds, "controlled", lambda addition, *given: replace(addition, rivals=(elsewhere,)))
    found = rounds.attribute(a_fit(1.0), (), THRESHOLDS, most=1)
    assert found.last_rivals == found.rounds[-1].rivals == (elsewhere,)


def test_within_reach_is_within_reach_of_the_least() -> None:
    """Held-out errors of 30 and 32.9 are one within a tenth; 36 is within one of the second, and not of the first."""
    rows = (("far", 400.0, 36.0), ("near", 300.0, 32.9), ("least", 290.0, 30.0))
    confirmed = [held(*row, 13.0) for row in rows]
    winner = rounds._first(confirmed)
    assert winner.name == "near"
    assert [r.name for r in rounds._equal(winner, confirmed, THRESHOLDS)] == ["near", "least"]


@pytest.mark.parametrize(("bent", "stages"), [(9.0, shortlist._COARSE), (-11.0, FORGIVING)])
def test_the_further_a_calibration_is_bent_the_more_is_forgiven(
    monkeypatch: pytest.MonkeyPatch, bent: float, stages: Any
) -> None:
    """And then it begins where peaks overlap, not at the stated values."""
    seen: list[Any] = []

    def fitted(problem: Any, hypotheses: Any, u: Any, e: Any, given: Any, tell: Any, judged: float) -> None:
        seen.append((float(u[0]), given, judged))

    monkeypatch.setattr(shortlist, "fit", fitted)
    monkeypatch.setattr(shortlist, "rough_start", lambda problem, hypotheses, e: (np.array([2.0]), e))
    current: Any = SimpleNamespace(problem=None, hypotheses=(), u=np.array([bent]), e=np.zeros(0))
    shortlist._forgiving(current)
    assert seen == [(2.0 if stages is FORGIVING else 0.0, stages, stages[-1][0])]


@pytest.mark.parametrize(
    ("chi2_per_dof", "held_out", "first"),
    [
        (0.25, 0.29, "root"),  # 8 nats of held-out data against 5 of fitted ones
        (0.25, 0.55, "inertia"),
        (0.25, None, "inertia"),
        (9.0, 0.29, "inertia"),  # under a model that misses much held-out data have chosen already
    ],
)
def test_of_what_fitted_data_cannot_tell_the_one_goes_first_that_foretells_the_others(
    monkeypatch: pytest.MonkeyPatch, chi2_per_dof: float, held_out: float | None, first: str
) -> None:
    """An inertia of 109 nats that leaves 0.56 of held-out data was gone on with; a root of 104 leaves 0.29."""
    monkeypatch.setattr(rounds, "held_out_nats", lambda judge, found, without: 30.0 * (without.missed - found.missed))
    ahead, other = (
        SimpleNamespace(name=n, gain_nats=g, held_out=h, fit=SimpleNamespace(**vars(a_fit(chi2_per_dof)), missed=h))
        for n, g, h in (("inertia", 108.8, 0.56), ("root", 103.9, held_out))
    )
    winner, equal = rounds._foretelling(ahead, (ahead, other))
    assert winner.name == first
    assert equal[0] is winner and set(map(id, equal)) == {id(ahead), id(other)}


@pytest.mark.parametrize("vain", [True, False])
def test_no_third_name_is_looked_for_where_two_took_too_little(monkeypatch: pytest.MonkeyPatch, vain: bool) -> None:
    a_round(monkeypatch, a_fit(0.9), a_fit(0.7))
    monkeypatch.setattr(rounds, "takes_enough", lambda *given: True)
    monkeypatch.setattr(rounds, "hopeless", lambda names, most, *given: vain and (names, most) == (2, 3))
    assert len(rounds.attribute(a_fit(1.0), (), THRESHOLDS, most=3).rounds) == (2 if vain else 3)
