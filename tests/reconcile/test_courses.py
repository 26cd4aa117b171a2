"""A change between runs that is one with another one on fitted data has the course that held-out data speak for."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import roving_scenario, without_instrument_noise

from vgvt.effects import available_effects
from vgvt.effects.conformance import table_of
from vgvt.reconcile.evidence.rivals import distinct
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.fitting.misfit import data_misfit
from vgvt.reconcile.question.holdout import Split
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, Problem, make_problem
from vgvt.reconcile.search.candidates import candidates, places
from vgvt.reconcile.search.courses import _other_courses, best_course, in_other_courses
from vgvt.reconcile.work.progress import silent
from vgvt.simulation import simulated_campaign

REMOUNT = available_effects()["drive-remount"]
SHIFT = {"shift_x_m": 0.0, "shift_y_m": 0.01}


@pytest.fixture(scope="module")
def remounted() -> Problem:
    """A shaker that comes back to the third run a centimetre off; that run is held out."""
    scenario = without_instrument_noise(roving_scenario())
    effect = REMOUNT(from_run=3, **SHIFT)
    truth = scenario.model_copy(update={"effect": (table_of(effect),)})
    return holding_out(make_problem(simulated_campaign(truth, engine="linear"), scenario, lines=80), 3)


def holding_out(case: Problem, number: int) -> Problem:
    """The same problem with a whole run held out."""
    held = np.array([c.run for c in case.measured.channels]) == number - 1
    return replace(case, split=Split(~held, held, np.zeros_like(held)))


def claimed(case: Problem, effect: type, values: dict[str, float], **settings: Any) -> Fit:
    """An effect beside an aircraft as stated, whose chain is as coarse as the scenario says."""
    hypothesis, u = Hypothesis(effect, settings), np.zeros(case.size)
    u[case.unknowns.index(CELLS)] = -3 / CELLS.sd
    return fit(case, (hypothesis,), u, hypothesis.scores(values), ())


def test_a_course_that_fitted_data_cannot_tell_is_chosen_by_those_held_out(remounted: Problem) -> None:
    every = candidates(remounted, {"drive-remount": REMOUNT})
    later = claimed(remounted, REMOUNT, SHIFT, from_run=4)
    chosen = best_course(later, every)
    assert dict(chosen.hypotheses[-1].settings) == {"from_run": 3}
    held, sigma = remounted.split.held, remounted.measured.sigma

    def missed(found: Fit) -> float:
        return float(np.mean(np.abs((found.foretold - remounted.measured.values) / sigma)[held] ** 2))

    assert missed(chosen) < 0.05 * missed(later)
    # What was fitted is nearly what it was, and is judged by its own prediction.
    assert chosen.evidence_nats == pytest.approx(later.evidence_nats, abs=0.5)
    misfit = data_misfit(remounted, chosen.predicted)
    assert chosen.chi2 == pytest.approx(float(misfit @ misfit), rel=1e-12)
    assert chosen.chi2 != later.chi2
    np.testing.assert_array_equal(chosen.scores, later.scores)
    assert best_course(replace(later, converged=True), every).converged
    assert np.abs((chosen.predicted - later.predicted) / sigma)[~held].max() < 0.2


def test_a_course_that_fitted_data_tell_is_left_alone(remounted: Problem) -> None:
    """One that is wrong where it was fitted is no choice, however held-out data like it."""
    every = candidates(remounted, {"drive-remount": REMOUNT})
    told = holding_out(remounted, 1)
    for case, run in ((remounted, 2), (told, 4)):
        found = claimed(case, REMOUNT, SHIFT, from_run=run)
        assert best_course(found, every) is found


def test_a_course_that_only_a_channel_held_out_alone_could_tell_is_chosen_by_it() -> None:
    """The first accelerometer loses a tenth before the last run; where it sat in the run before, nothing is fitted."""
    scenario, drift = without_instrument_noise(roving_scenario()), available_effects()["gain-drift"]
    settings, size = {"channels": "sensor-1", "shape": "step"}, {"drift": -0.1}
    truth = scenario.model_copy(update={"effect": (table_of(drift(from_run=4, **settings, **size)),)})
    whole = make_problem(simulated_campaign(truth, engine="linear"), scenario, lines=80)
    alone = np.array([c.run == 2 and c.instrument == 0 for c in whole.measured.channels])
    unseen = replace(whole, split=Split(~alone, np.zeros_like(alone), alone))
    seen = replace(whole, split=Split(np.ones_like(alone), np.zeros_like(alone), np.zeros_like(alone)))
    every = candidates(unseen, {"gain-drift": drift})
    chosen = best_course(claimed(unseen, drift, size, from_run=3, **settings), every)
    assert chosen.hypotheses[-1].settings["from_run"] == 4
    assert chosen.held_out_chi2_per_dof is not None
    # A run earlier it acts on a channel that is fitted, and with nothing held out nothing may choose.
    for case, run in ((unseen, 2), (seen, 3)):
        found = claimed(case, drift, size, from_run=run, **settings)
        assert best_course(found, every) is found


def test_courses_that_fitted_data_cannot_tell_are_one_rival(remounted: Problem) -> None:
    """The third run is held out: before it or before the fourth is one, and it is not fitted a second time."""
    every = candidates(remounted, {"drive-remount": REMOUNT})
    null = replace(claimed(remounted, REMOUNT, {**SHIFT, "shift_y_m": 0.0}, from_run=2), hypotheses=())
    later = claimed(remounted, REMOUNT, SHIFT, from_run=4)
    assert [f.hypotheses[-1].settings["from_run"] for f in in_other_courses(null, [later], every, silent)] == [2]
    chosen = [best_course(claimed(remounted, REMOUNT, SHIFT, from_run=run), every) for run in (3, 4)]
    elsewhere = claimed(remounted, REMOUNT, {**SHIFT, "shift_x_m": 0.002}, from_run=3)
    worse = replace(chosen[0], evidence_nats=chosen[0].evidence_nats - 0.5)
    first, *others = distinct([worse, elsewhere, *chosen])
    assert any(first is f for f in chosen)
    assert others == [elsewhere]


def test_a_size_that_was_left_out_leaves_the_courses_as_they_are(remounted: Problem) -> None:
    """They are those of the variants that have it, without it; a fit that has it is another thing to begin with."""
    every = candidates(remounted, {"drive-remount": REMOUNT})
    later = claimed(remounted, REMOUNT, SHIFT, from_run=4)
    null = replace(claimed(remounted, REMOUNT, {**SHIFT, "shift_y_m": 0.0}, from_run=2), hypotheses=())
    lean = claimed(remounted, REMOUNT, {"shift_y_m": SHIFT["shift_y_m"]}, from_run=4, shift_x_m=0.0)
    chosen = best_course(lean, every)
    assert dict(chosen.hypotheses[-1].settings) == {"from_run": 3, "shift_x_m": 0.0}
    ahead = replace(lean, evidence_nats=later.evidence_nats + 1)
    found = in_other_courses(null, [later, ahead], every, silent)
    assert [dict(f.hypotheses[-1].settings) for f in found] == [{"from_run": 2, "shift_x_m": 0.0}]


def test_what_has_no_course_is_left_alone(remounted: Problem) -> None:
    gain = available_effects()["channel-gain"]
    found = claimed(remounted, gain, {"gain_error": 0.1}, channels="response")
    assert best_course(found, candidates(remounted, {"channel-gain": gain})) is found


def test_a_course_is_chosen_where_the_place_is_fitted_too() -> None:
    """What is put in before the third run: each variant has a place among its settings, and the fit has freed it."""
    scenario, payload = without_instrument_noise(roving_scenario()), available_effects()["payload-change"]
    there = {"mass_kg": 0.03, "x_m": 0.8, "y_m": 0.9}
    truth = scenario.model_copy(update={"effect": (table_of(payload(from_run=3, **there)),)})
    case = holding_out(make_problem(simulated_campaign(truth, engine="linear"), scenario, lines=80), 3)
    later = claimed(case, payload, there, from_run=4)
    chosen = best_course(later, candidates(case, {"payload-change": payload}))
    assert dict(chosen.hypotheses[-1].settings) == {"from_run": 3}
    here, there_only = chosen.held_out_chi2_per_dof, later.held_out_chi2_per_dof
    assert here is not None and there_only is not None and here < 0.1 * there_only


@pytest.mark.slow
def test_from_where_a_wrong_course_arrived_the_right_one_is_found(remounted: Problem) -> None:
    """A screen from where unknowns are bent took a root that gave way at once for one that crept."""
    case = holding_out(remounted, 1)
    every = candidates(case, {"drive-remount": REMOUNT})
    null = replace(claimed(case, REMOUNT, {**SHIFT, "shift_y_m": 0.0}, from_run=2), hypotheses=())
    wrong = claimed(case, REMOUNT, {**SHIFT, "shift_y_m": 0.006}, from_run=2)
    assert wrong.evidence_nats > null.evidence_nats, "it must be worth something in this test"
    # Another effect that was fitted in that course is none of its own courses.
    hung = replace(wrong, hypotheses=(Hypothesis(available_effects()["re-hang"], {"from_run": 3}),), evidence_nats=-1e9)
    found = in_other_courses(null, [wrong, hung], every, silent)
    best = max(found, key=lambda f: f.evidence_nats)
    assert dict(best.hypotheses[-1].settings) == {"from_run": 3}
    assert best.chi2 < 0.2 * wrong.chi2
    # What is far behind another effect has no other course worth a fit.
    ahead = replace(wrong, evidence_nats=null.evidence_nats + 10 * (wrong.evidence_nats - null.evidence_nats))
    other = replace(ahead, hypotheses=(Hypothesis(available_effects()["channel-gain"], {}),))
    assert in_other_courses(null, [wrong, other], every, silent) == []
    # Nor has what gains nothing, however little others gain.
    behind = replace(wrong, evidence_nats=null.evidence_nats - 5.0)
    assert in_other_courses(null, [behind, replace(behind, evidence_nats=-1e9)], every, silent) == []


@pytest.mark.slow
def test_a_course_between_those_that_were_tried_is_found(remounted: Problem) -> None:
    """A campaign of many runs: not every one of them is a variant, but a change may come before any."""
    case = holding_out(remounted, 1)
    every = [h for h in candidates(case, {"drive-remount": REMOUNT}) if h.settings["from_run"] != 3]
    null = replace(claimed(case, REMOUNT, {**SHIFT, "shift_y_m": 0.0}, from_run=2), hypotheses=())
    wrong = claimed(case, REMOUNT, {**SHIFT, "shift_y_m": 0.006}, from_run=2)
    found = in_other_courses(null, [wrong], every, silent)
    assert max(found, key=lambda f: f.evidence_nats).hypotheses[-1].settings == {"from_run": 3}


def test_a_change_is_tried_before_every_run_of_a_usual_campaign() -> None:
    """Ten runs were tried from the second, fifth, seventh and tenth: what changed at the third had a wrong course."""
    first, last = available_effects()["re-hang"], available_effects()["payload-change"]
    for count, tried in ((2, 1), (4, 3), (10, 9), (40, 11)):
        runs = tuple((k, 100 + k) for k in range(1, count + 1))
        problem: Any = SimpleNamespace(
            scenario=roving_scenario(), measured=SimpleNamespace(runs=runs, run_numbers=()), layouts=None
        )
        hung = [h.settings["from_run"] for h in candidates(problem, {"re-hang": first})]
        assert len(hung) == tried == len(set(hung))
        assert (hung[0], hung[-1]) == (2, count)
        # Nor is any left out for the sake of others' number.
        put_in = candidates(problem, {"payload-change": last})
        assert {h.settings["from_run"] for h in put_in} == set(hung)
        assert len(put_in) == tried * len(places(problem))


@pytest.mark.parametrize("runs", [6, 12, 24, 40])
def test_all_runs_that_a_change_may_begin_at_share_one_prior(remounted: Problem, runs: int) -> None:
    """Of many runs not all are candidates, and all may be fitted."""
    many = replace(remounted, measured=replace(remounted.measured, runs=((1,),) * runs))
    every = candidates(many, {"drive-remount": REMOUNT})
    there = [every[0], *_other_courses(many, every, every[0])]
    assert len({h.settings["from_run"] for h in there}) == runs - 1
    assert sum(h.share for h in there) == pytest.approx(1.0)
