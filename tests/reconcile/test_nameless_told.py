"""Where nothing has a name, one thing without one is told: its place and its law, if it gains what a name needs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.decision import nameless_sought
from vgvt.reconcile.decision import nameless_told as told
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.kinds import Kind, kind_of
from vgvt.reconcile.decision.leads import why_no_name
from vgvt.reconcile.decision.nameless_told import nameless_told
from vgvt.reconcile.decision.reasons import reasons_of
from vgvt.reconcile.evidence.confirmation import share_taken
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.evidence.rivals import against
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import FAR, Fit, fit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.question.thresholds import Thresholds, noise_share, stored_thresholds

KNOWN = available_effects()


# Where sensor 8 is: what is between two is told as what it does at the nearer one, and that leaves something.
PLACE = {"x_m": 0.88646, "y_m": 1.112774}


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


def case_with(cache: Path, *effects: Any) -> Problem:
    return make_problem(campaign_of(roving_scenario(), 3, *effects), roving_scenario(), lines=160, cache=cache)


def limits(case: Problem) -> Thresholds:
    return stored_thresholds().at(noise_share(case.measured, case.split.train))


@pytest.fixture(scope="module")
def damped(cache: Path) -> Fit:
    """The calibration of a campaign with a damper to the ground."""
    return calibrate(case_with(cache, KNOWN["nonproportional-damper"](damping_n_s_per_m=1.0, **PLACE)))


def unexplained(null: Fit, *leads: tuple[str, dict[str, float], dict[str, Any]]) -> Attribution:
    """What a search holds that found no name, but leads."""
    rounds, current = list[Addition](), null
    for name, values, settings in leads:
        hypothesis = Hypothesis(KNOWN[name], settings)
        start = np.concatenate([current.e, hypothesis.scores(values)])
        there = fit(null.problem, (*current.hypotheses, hypothesis), current.u, start, FAR)
        (rival,) = against(current, [there])
        rounds.append(Addition(rival, (rival,), (rival,), 2.0))
        current = there
    before = residual(null, limits(null.problem))
    return Attribution(null, before, (), null, before, (), (), leads=tuple(rounds), led=current if rounds else None)


@pytest.mark.slow
def test_a_delay_of_the_force_is_told_as_one_however_far_the_tolerances_were_bent(cache: Path) -> None:
    """The calibration has made up for it with masses and stiffnesses far out: from there alone it is not found."""
    case = case_with(cache, KNOWN["channel-delay"](delay_s=0.004, channels="force"))
    null = calibrate(case)
    assert np.abs(null.u).max() > 50
    found = nameless_told(unexplained(null), limits(case))
    thing = found.nameless
    assert thing is not None and thing.where.label == "force channel"
    assert thing.chi2_per_dof < found.null_residual.limits.chi2_per_dof < null.chi2_per_dof
    assert np.abs(thing.u).max() < 5
    reading = {p.name: p.value for p in thing.law.reading.parts}
    # As the catalogue says it of the force; A/F comes early.
    assert reading["delay"] == pytest.approx(0.004, rel=0.1)
    assert thing.law.values[-1].imag > 0
    assert abs(reading["gain error"]) < 0.05
    assert kind_of(found) is Kind.UNKNOWN and not found.rounds
    said = reasons_of(Kind.UNKNOWN, found, limits(case), None)
    assert f"One thing that has no name, {thing.in_words}" in said
    assert "a delay of 0.0040" in thing.in_words
    assert f"takes {found.nameless.ahead_nats:.0f} nats more than the model without it" in thing.in_words
    assert thing.document()["instead_of"] == [] and thing.document()["beside"] == []


@pytest.mark.slow
@pytest.mark.parametrize(("run", "when"), [(3, "from run 3 on"), (4, "in run 4 alone")])
def test_what_begins_with_a_held_out_run_is_told_of_that(cache: Path, run: int, when: str) -> None:
    """Begun one run later it explains as much of the others, and the held-out third run refused it at χ² 38."""
    case = case_with(cache, KNOWN["payload-change"](from_run=run, mass_kg=0.05, **PLACE))
    thing = nameless_told(unexplained(calibrate(case)), limits(case)).nameless
    assert thing is not None
    assert (thing.where.label, thing.where.when) == ("force at 8+Z", when)
    assert thing.held_out_chi2_per_dof is not None and thing.held_out_chi2_per_dof < 1.2
    assert f"a force at 8+Z {when} that is smooth" in thing.in_words


@pytest.mark.slow
def test_beside_a_lead_that_stands_beside_it(cache: Path) -> None:
    """Half of two is in the catalogue and was a lead, as it took too little: both together meet the data."""
    gain, damper = KNOWN["channel-gain"](gain_error=0.25, channels="18+Z"), KNOWN["nonproportional-damper"]
    case = case_with(cache, gain, damper(damping_n_s_per_m=2.0, **PLACE))
    lead = ("channel-gain", {"gain_error": 0.2}, {"channels": "18+Z"})
    start = unexplained(calibrate(case), lead)
    found = nameless_told(start, limits(case))
    thing = found.nameless
    assert thing is not None and thing.where.kind == "structure"
    assert [h.name for h in thing.hypotheses] == ["channel-gain"]
    (damping,) = (p for p in thing.law.reading.parts if p.name == "damping")
    assert damping.value == pytest.approx(2.0, abs=2 * damping.std) and damping.std < 0.2
    assert thing.chi2_per_dof < start.null_residual.limits.chi2_per_dof
    # Alone the thing would be the gain, which leaves the damper.
    assert nameless_told(unexplained(start.null), limits(case)).nameless is None
    said = " ".join(reasons_of(Kind.UNKNOWN, found, limits(case), None))
    assert thing.in_words in said and ", beside channel-gain" in thing.in_words
    # It is no name, and what speaks against the lead is what spoke against it before.
    assert kind_of(found) is Kind.UNKNOWN and not found.rounds
    assert why_no_name(found) == why_no_name(start)


@pytest.mark.parametrize(("together", "is_told"), [(108.0, False), (110.0, True)])
def test_a_lead_has_to_gain_beside_the_thing_too(
    damped: Fit, monkeypatch: pytest.MonkeyPatch, together: float, is_told: bool
) -> None:
    """Alone the thing gains 100, and does not convince; with a lead it does, and may owe that to itself."""
    case = damped.problem
    start = unexplained(damped, ("channel-gain", {"gain_error": 0.01}, {"channels": "18+Z"}))
    alone, both = (SimpleNamespace(gains=np.full(2, g), problem=case, predicted=None) for g in (100.0, together))
    monkeypatch.setattr(told, "sought", lambda asked, models, *_: ((m, both if m.kept else alone) for m in models))
    monkeypatch.setattr(told, "_convincing", lambda there, *_: both if there is both else None)
    monkeypatch.setattr(told, "gained", lambda null, beside, there, worth: there.gains)
    monkeypatch.setattr(told, "worth_of", lambda *_: 1.0)
    found = nameless_told(start, replace(limits(case), evidence_nats=9.0))
    assert found.nameless is (both if is_told else None)


@pytest.mark.slow
def test_beside_a_right_name_that_leaves_something(cache: Path) -> None:
    """The name stays, and what is left has a place and a law."""
    gain, damper = KNOWN["channel-gain"](gain_error=0.25, channels="18+Z"), KNOWN["nonproportional-damper"]
    case = case_with(cache, gain, damper(damping_n_s_per_m=2.0, **PLACE))
    lead = unexplained(calibrate(case), ("channel-gain", {"gain_error": 0.2}, {"channels": "18+Z"}))
    assert lead.led is not None
    start = replace(
        lead, rounds=lead.leads, leads=(), led=None, final=lead.led, final_residual=residual(lead.led, limits(case))
    )
    assert kind_of(start) is Kind.PARTLY_EXPLAINED
    found = nameless_told(start, limits(case))
    assert found.nameless is not None and found.nameless.where.kind == "structure"
    assert kind_of(found) is Kind.PARTLY_EXPLAINED and found.rounds == start.rounds and found.final is start.final
    assert [h.name for h in found.nameless.hypotheses] == ["channel-gain"]
    assert found.nameless.where.label == "force at 8+Z"
    reading = {p.name: p for p in found.nameless.law.reading.parts}
    assert reading["damping"].value == pytest.approx(2.0, abs=2 * reading["damping"].std)
    assert reading["damping"].std < 0.3
    assert found.nameless.chi2_per_dof < start.final.chi2_per_dof
    said = " ".join(reasons_of(Kind.PARTLY_EXPLAINED, found, limits(case), None))
    assert f"Not alone: one thing that has no name, {found.nameless.in_words}" in said
    # Of what the name leaves: its own share of the whole is no matter.
    assert share_taken(found.nameless, start.final, start.final_residual) > 0.9
    # Where a name depends on level nothing is asked.
    bent = replace(found.final.hypotheses[0], cls=KNOWN["root-friction"], settings={})
    nonlinear = replace(start, final=replace(start.final, hypotheses=(bent,)))
    assert nameless_told(nonlinear, limits(case)) is nonlinear


def test_nothing_is_told_where_there_is_a_name_or_nothing_is_missing(cache: Path) -> None:
    case = case_with(cache)
    found = unexplained(calibrate(case))
    assert kind_of(found) is Kind.ADEQUATE
    assert nameless_told(found, limits(case)) is found
    (addition,) = unexplained(found.null, ("channel-gain", {"gain_error": 0.01}, {"channels": "18+Z"})).leads
    named = replace(found, rounds=(addition,), final=addition.winner.fit)
    assert nameless_told(named, limits(case)) is named


def test_what_gains_too_little_or_held_out_data_speak_against_is_not_told(
    damped: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    case, start = damped.problem, unexplained(damped)
    found = nameless_told(start, limits(case))
    assert found.nameless is not None
    most = replace(limits(case), evidence_nats=found.nameless.ahead_nats + 1)
    assert nameless_told(start, most) is start
    # What neither meets the data nor takes nearly all of what is too much is not all there is, whatever it gains.
    with monkeypatch.context() as patched:
        patched.setattr(told, "met", lambda *_: False)
        patched.setattr(told, "shares_taken", lambda *_: (1.0, 0.89))
        assert nameless_told(start, limits(case)) is start
        patched.setattr(told, "shares_taken", lambda *_: (0.91, 0.91))
        assert nameless_told(start, limits(case)).nameless is not None
    monkeypatch.setattr(told, "not_spoken_against", lambda *_: False)
    assert nameless_told(start, limits(case)) is start


@pytest.mark.parametrize("runs", [((5,),), pytest.param(((1, 2, 3),), marks=pytest.mark.slow)])
def test_nothing_is_told_where_nothing_is_held_out(tmp_path: Path, runs: tuple[tuple[int, ...], ...]) -> None:
    """One channel, or one short run: whatever is at one place could be at another."""
    whole = roving_scenario()
    scenario = whole.model_copy(update={"acquisition": whole.acquisition.model_copy(update={"runs": runs})})
    damper = KNOWN["nonproportional-damper"](damping_n_s_per_m=20.0, **PLACE)
    case = make_problem(campaign_of(scenario, 3, damper), scenario, lines=80, cache=tmp_path)
    found = unexplained(calibrate(case))
    assert kind_of(found) is Kind.UNKNOWN and not case.split.held.any()
    assert nameless_told(found, limits(case)) is found


@pytest.mark.slow
def test_what_another_start_finds_is_none_of_the_things_own(cache: Path) -> None:
    """A calibration that was broken off: a thing from a better start would gain all that this left undone."""
    case = case_with(cache)
    broken_off = fit(case, (), np.zeros(case.size), np.zeros(0), ((0.0, 2),))
    found = unexplained(broken_off)
    assert kind_of(found) is Kind.UNKNOWN
    assert nameless_told(found, limits(case)) is found


@pytest.mark.slow
def test_where_the_stated_aircraft_does_not_hang_the_other_starts_do(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(*_: Any) -> None:
        raise NoStructureError("no such structure")

    case = case_with(cache, KNOWN["channel-delay"](delay_s=0.004, channels="force"))
    start = unexplained(calibrate(case))
    monkeypatch.setattr(nameless_sought, "rough_start", none)
    found = nameless_told(start, limits(case))
    assert found.nameless is None or found.nameless.where.label == "force channel"


@pytest.mark.slow
def test_what_rings_within_the_band_is_no_thing_whose_law_is_smooth(cache: Path) -> None:
    """Its law gains a thousand nats, and leaves most of what is there to be told by the residual line by line."""
    case = case_with(cache, KNOWN["local-absorber"](mass_kg=0.1, frequency_hz=9.0, damping_ratio=0.05, **PLACE))
    start = unexplained(calibrate(case))
    assert start.null_residual.train_chi2_per_dof > 10
    assert nameless_told(start, limits(case)) is start
