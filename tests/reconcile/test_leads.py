"""What is found and does not take what was too much, ends far off, or is no thing, is a lead."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from lead_case import fitted, found, left

from vgvt.reconcile.decision import exchanged, leads, near_leads
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.kinds import Kind, kind_of
from vgvt.reconcile.decision.leads import as_leads, does_without, shares, strange_names, telling, why_no_name
from vgvt.reconcile.decision.verdict import leads_of, named_effects

THRESHOLDS: Any = SimpleNamespace()


@pytest.fixture(autouse=True)
def plausible_things(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a test says nothing else."""
    monkeypatch.setattr(leads, "implausible", lambda fit, index=-1: ())


@pytest.mark.parametrize(
    ("after", "kept"),
    [
        ((3.9, 3.9), True),
        ((4.1, 3.9), False),  # of the fit, of which 1.0 may be left
        ((3.9, 4.1), False),  # of held-out data
        ((3.9, None), True),
        ((0.9, 0.9), True),
    ],
)
def test_a_model_far_from_the_data_names_nothing_however_much_it_takes(
    after: tuple[float, float | None], kept: bool
) -> None:
    """A line from tip to tip was a flap in part: 42 of held-out data had become 8, where 0.7 may be left."""
    case = found((100.0, 100.0), after, names=3)
    assert min(shares(case)) > 0.95
    judged = as_leads(case, THRESHOLDS)
    assert (judged is case) == kept
    if not kept:
        assert judged.leads == case.rounds
        assert kind_of(judged) is Kind.UNKNOWN


@pytest.mark.parametrize(
    ("after", "strange", "why"),
    [
        ((4.1, 3.9), (), "more than 4 times what may be left"),
        ((3.9, 4.1), (), "more than 4 times what may be left"),
        ((3.9, None), (), "does not halve"),
        ((3.9, 3.9), (), "does not halve"),
        ((4.1, 4.1), ("a mass of -3 kg",), "added-mass with a mass of -3 kg: that is no plausible thing"),
    ],
)
def test_it_is_said_why_a_lead_is_no_name(
    monkeypatch: pytest.MonkeyPatch, after: tuple[float, float | None], strange: tuple[str, ...], why: str
) -> None:
    """What could not be is said first, whatever else speaks against it."""
    case = found((100.0, 100.0), after)
    led = fitted(1000 * after[0], hypotheses=(SimpleNamespace(name="added-mass"),))
    led.held_out_chi2_per_dof = after[1]
    monkeypatch.setattr(leads, "strain_sd", lambda fit: 0.0)
    monkeypatch.setattr(leads, "implausible", lambda fit, index=-1: strange)
    assert why in why_no_name(replace(case, rounds=(), leads=case.rounds, led=led))


def test_it_is_said_that_a_lead_takes_less_than_nearly_all(monkeypatch: pytest.MonkeyPatch) -> None:
    """Warming was a cable's drag and a drift, with four fifths of it."""
    monkeypatch.setattr(leads, "strain_sd", lambda fit: 0.0)
    case = found((2.0, 5.0), (0.97, 0.9), names=2)
    judged = as_leads(replace(case, final_residual=left(0.9, met=False)), THRESHOLDS)
    assert judged.leads == case.rounds
    led = fitted(970.0)
    led.held_out_chi2_per_dof = 0.9
    assert "what takes 80 % of what is too much, and not 90, where something else is left" in why_no_name(
        replace(judged, led=led)
    )


def with_strange(monkeypatch: pytest.MonkeyPatch, strange: tuple[str, ...], names: tuple[str, ...]) -> Attribution:
    """Rounds that meet the data, each with a fit of all that has a name by then; those of ``strange`` are no things."""
    monkeypatch.setattr(
        leads, "implausible", lambda fit, index=-1: ("far off",) if fit.hypotheses[index].name in strange else ()
    )
    monkeypatch.setattr(leads, "residual", lambda fit, thresholds: left(0.9 if len(fit.hypotheses) > 1 else 1.6))
    things = tuple(SimpleNamespace(name=n) for n in names)
    fits = [fitted(800.0, hypotheses=things[: k + 1]) for k in range(len(names))]
    plain = SimpleNamespace(linear=True)
    winners = [SimpleNamespace(name=n, fit=f, hypothesis=plain) for n, f in zip(names, fits, strict=True)]
    tried = ("tried at first",), ("tried beside one",)
    rounds: Any = tuple(Addition(w, (), r, None) for w, r in zip(winners, tried, strict=True))  # type: ignore[arg-type]
    return Attribution(fitted(2000.0, bent=50.0), left(5.0), rounds, fits[-1], left(0.9, True), (), ())


@pytest.mark.parametrize(
    ("after", "kept"),
    [
        ((0.83, 2.0), True),  # 1220 of 1350 too much, 3 of 4.3
        ((0.84, 2.0), False),  # 1210 of 1350: something else is left, and more than a tenth
        ((2.0, 2.0), False),  # 50 of 1350 … of the fit, whatever held-out data say
        ((0.83, 3.5), False),  # 1.5 of 4.3 of held-out data
        ((1.0, 0.9), True),  # 1050 of 1350, and the data are met
        ((1.0, None), True),
    ],
)
def test_a_name_takes_nine_tenths_of_the_fit_and_half_of_what_is_held_out(
    after: tuple[float, float | None], kept: bool
) -> None:
    case = found((2.0, 5.0), after)
    judged = as_leads(case, THRESHOLDS)
    assert (judged is case) == kept
    if not kept:
        assert judged.rounds == ()
        assert judged.leads == case.rounds
        assert judged.led is case.final
        assert (judged.final, judged.final_residual) == (case.null, case.null_residual)
        assert kind_of(judged) is Kind.UNKNOWN


@pytest.mark.parametrize(
    ("names", "held_out", "kept"), [(1, 2.8, True), (2, 2.8, False), (2, 1.7, True), (3, 1.7, False), (3, 1.2, True)]
)
def test_every_name_halves_what_is_too_much(names: int, held_out: float, kept: bool) -> None:
    """Of 4.3 that held-out data are missed by too much."""
    case = found((2.0, 5.0), (0.71, held_out), names=names)
    assert (as_leads(case, THRESHOLDS) is case) == kept


def test_what_leaves_no_more_than_noise_keeps_its_name() -> None:
    """Where little was too much, half of it is chance."""
    small = found((0.9, 0.9), (0.88, 0.9), adequate=True)
    assert as_leads(small, THRESHOLDS) is small


def test_what_held_out_data_met_before_they_do_not_ask_for() -> None:
    """Of data that are met no half has to be taken, even if they were met better without."""
    assert shares(found((2.0, 0.8), (1.0, 0.9)))[1] == 1.0


def test_held_out_data_that_grow_worse_beyond_their_limit_are_no_share() -> None:
    assert shares(found((2.0, 1.5), (1.0, 1.6)))[1] < 0
    assert shares(found((2.0, 0.6), (1.0, 1.6)))[1] == 0.0


def test_where_nothing_was_missing_nothing_comes_nearest() -> None:
    """A name that makes held-out data worse than they may be, where they were met without it."""
    case = replace(found((0.9, 0.9), (0.88, 1.6)), null=fitted(900.0), null_residual=left(0.9, adequate=True))
    judged = as_leads(case, THRESHOLDS)
    assert judged.rounds == judged.leads == ()
    assert judged.led is None
    assert judged.final is case.null
    # What stood between these data and a name is what the first round asked, and it was not refused.
    assert judged.last_rivals == ("tried at first",)
    assert judged.vetoed == ()


def test_what_could_not_be_is_refused_where_nothing_was_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    case = replace(found((0.9, 0.9), (0.7, 0.8)), null=fitted(900.0), null_residual=left(0.9, adequate=True))
    monkeypatch.setattr(leads, "implausible", lambda fit, index=-1: ("far off",))
    monkeypatch.setattr(leads, "without_last", lambda rounds, start: (rounds, start, []))
    assert leads.demoted(case).vetoed == (case.rounds[0].winner,)


def test_what_comes_nearly_as_near_stands_beside_a_lead(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(near_leads, "implausible", lambda fit: ())
    case = found((100.0, 100.0), (60.0, 60.0))
    plain = SimpleNamespace(linear=True)
    surge: Any = SimpleNamespace(name="suspension-surge", fit=fitted(61_000), held_out=62.0)
    winner: Any = SimpleNamespace(name="root-compliance", fit=fitted(60_000), held_out=60.0, hypothesis=plain)
    judged = as_leads(replace(case, rounds=(Addition(winner, (winner,), (winner, surge), 100.0),)), THRESHOLDS)
    assert judged.leads[0].equivalent == (winner, surge)


def test_nothing_found_leads_nowhere() -> None:
    nothing = Attribution(fitted(1e3), left(2.0), (), fitted(1e3), left(2.0), (), ())
    assert as_leads(nothing, THRESHOLDS) is nothing
    assert leads_of(nothing) == named_effects(nothing) == ()


@pytest.mark.parametrize(
    ("strange", "kept"),
    [
        ((), ("one", "two")),
        # What was named before what cannot be does without it.
        (("two",), ("one",)),
        # What was named beside what cannot be rests on it.
        (("one",), ()),
        (("one", "two"), ()),
    ],
)
def test_what_is_no_plausible_thing_keeps_no_name(
    monkeypatch: pytest.MonkeyPatch, strange: tuple[str, ...], kept: tuple[str, ...]
) -> None:
    """Even where data are met with it."""
    case = with_strange(monkeypatch, strange, ("one", "two"))
    judged = as_leads(case, THRESHOLDS)
    assert tuple(r.winner.name for r in judged.rounds) == kept
    if kept == ("one",):
        assert judged.final is case.rounds[0].winner.fit
        assert [str(r) for r in judged.last_rivals] == ["tried beside one"]
        assert judged.final_residual.held_out_chi2_per_dof == 1.6
        assert [r.name for r in judged.vetoed] == ["two"]
    if not kept:
        assert (judged.leads, judged.led) == (case.rounds, case.final)
        assert kind_of(judged) is Kind.UNKNOWN


def test_nothing_is_left_where_no_fit_is_there_of_what_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """An effect that the later two had made needless is in the fit of the one before the last."""
    case = with_strange(monkeypatch, ("three",), ("two", "three"))
    before_the_last: Any = case.rounds[0].winner.fit
    before_the_last.hypotheses = (SimpleNamespace(name="one"), SimpleNamespace(name="two"))
    judged = as_leads(case, THRESHOLDS)
    assert judged.rounds == ()
    assert [r.winner.name for r in judged.leads] == ["two", "three"]


def test_what_tolerances_imitate_far_out_has_its_lead(monkeypatch: pytest.MonkeyPatch) -> None:
    """Data that are met by tolerances far exceeded are not explained: what comes nearest is told."""
    case = with_strange(monkeypatch, ("one",), ("one", "two"))
    strained = replace(case, null=fitted(900.0, bent=90.0), null_residual=left(0.9, adequate=True))
    assert as_leads(strained, THRESHOLDS).leads == case.rounds
    met = replace(case, null=fitted(900.0), null_residual=left(0.9, adequate=True))
    assert as_leads(met, THRESHOLDS).leads == ()


def test_what_is_left_of_two_names_must_take_half_on_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    case = with_strange(monkeypatch, ("two",), ("one", "two"))
    monkeypatch.setattr(leads, "residual", lambda fit, thresholds: left(4.0))
    judged = as_leads(case, THRESHOLDS)
    assert judged.rounds == ()
    assert [r.winner.name for r in judged.leads] == ["one"]


@pytest.mark.parametrize(
    ("nats", "names", "strange", "met", "bent", "does"),
    [
        (-3.0, 1, (), False, 0.0, True),
        (30.0, 2, (), False, 0.0, True),
        (-9.0, 1, (), False, 0.0, True),
        (-11.0, 1, (), False, 0.0, False),
        (30.0, 0, (), False, 0.0, False),
        (30.0, 2, ("one",), False, 0.0, False),
        (-60.0, 1, (), True, 0.0, True),
        (-60.0, 1, (), True, 900.0, False),
        (-60.0, 0, (), True, 0.0, False),
        (-60.0, 2, ("one",), True, 0.0, False),
    ],
)
def test_what_does_as_well_without_what_cannot_be_counts(
    monkeypatch: pytest.MonkeyPatch,
    nats: float,
    names: int,
    strange: tuple[str, ...],
    met: bool,
    bent: float,
    does: bool,
) -> None:
    """By the evidence of the whole models or as data and tolerances are met, and if it is all plausible itself.

    Nats count as they do wherever two explanations are as good: here half of what they are line by line.
    """
    monkeypatch.setattr(exchanged, "against", halved)
    case = with_strange(monkeypatch, ("far off", *strange), ("far off", "two"))
    other = with_strange(monkeypatch, ("far off", *strange), ("one", "two"))
    first, second = (
        replace(c, final=fitted(800.0, bent, c.final.hypotheses), final_residual=left(0.9, adequate=met))
        for c in (case, other)
    )
    first_fit: Any = first.final
    second_fit: Any = second.final
    first_fit.evidence_nats, second_fit.evidence_nats = 100.0, 100.0 + nats
    second_fit.hypotheses = second_fit.hypotheses[:names]
    assert strange_names(first) == {"far off"}
    assert does_without(first, replace(second, rounds=second.rounds[:names]), 5.0) is does


def halved(current: Any, fits: Any) -> tuple[Any, ...]:
    """Fits as rivals whose nats count half, best first."""
    judged = [SimpleNamespace(fit=f, gain_nats=0.5 * f.evidence_nats) for f in fits]
    return tuple(sorted(judged, key=lambda r: -r.gain_nats))


def test_what_the_second_search_went_without_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before what that one refused itself, of which a verdict tells the first."""
    case, other = (with_strange(monkeypatch, ("far off",), names) for names in (("one", "far off"), ("one", "two")))
    refused: Any = SimpleNamespace(name="refused")
    told = telling(case, replace(other, vetoed=(refused,)))
    assert [r.name for r in told.vetoed] == ["far off", "refused"]
    assert (told.rounds, told.final) == (other.rounds, other.final)
