"""Changes of procedure: what each does to the scenario, and the campaign that it then foretells."""

from __future__ import annotations

import copy
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, claimed, roving_problem, roving_scenario, small_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.undecided import next_best, undecided
from vgvt.reconcile.fitting.fit import NEAR, fit
from vgvt.reconcile.next_test import procedures as procedures_module
from vgvt.reconcile.next_test import suggest as suggesting
from vgvt.reconcile.next_test.procedures import Procedure, changed, procedures
from vgvt.reconcile.next_test.suggest import Suggestion, expected_nats, known_in, suggest, words_of_none
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.question.thresholds import noise_share
from vgvt.reconcile.question.uncertain import prepared
from vgvt.scenario import load_scenario

# The package's lazy name of the same spelling is the function.
GAIN = 0.05
GAIN_CLASS = available_effects()["channel-gain"]


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return roving_problem(tmp_path_factory.mktemp("cache"), lines=100)


def procedure(case: Problem, words: str) -> Procedure:
    (found,) = (p for p in procedures(case) if words in p.words)
    return found


def campaigns_alone(monkeypatch: pytest.MonkeyPatch, tests: tuple[Procedure, ...]) -> None:
    """No readings, and these changes of procedure; a changed problem is its procedure's words."""
    monkeypatch.setattr(suggesting, "checks", lambda problem: ())
    monkeypatch.setattr(suggesting, "procedures", lambda problem: tests)
    monkeypatch.setattr(suggesting, "changed", lambda problem, p: p.words)


@pytest.mark.parametrize(
    ("words", "unknown"),
    [("spring half as stiff", "spring"), ("spring twice as stiff", "spring"), ("excite", "transducer end mass")],
)
def test_another_rig_has_slopes_of_its_own(case: Problem, words: str, unknown: str) -> None:
    """Half a spring has half of a spring's slope, and another drive point the row of another point."""
    tests = [p for p in procedures(case) if words in p.words]
    after, step = changed(case, tests[0]), 0.01
    u, k = np.zeros(case.size), [n.name for n in case.unknowns].index(unknown)
    known = anchor(after, u).slopes()[k]
    aside = [u + s * step * np.eye(u.size)[k] for s in (1, -1)]
    ends = [anchor(after, a, slopes=False).mechanical(a, np.zeros(0)) for a in aside]
    wanted = (ends[0] - ends[1]) / (2 * step)
    assert np.linalg.norm(known - wanted) < 0.02 * np.linalg.norm(wanted)


def test_the_same_rig_keeps_its_slopes() -> None:
    """A shaker on a wing is on one of two once these are written out: no other shaker for that."""
    stated = load_scenario("teaching-beam")
    assert prepared(stated).shakers != stated.shakers
    slopes: Any = object()
    start: Any = SimpleNamespace(scenario=prepared(stated))
    problem: Any = SimpleNamespace(scenario=stated, start=start, slopes=slopes)
    assert procedures_module._slopes_of_another_rig(problem, prepared(stated), start) is slopes


@pytest.mark.parametrize("again", [0, 2])
def test_a_run_comes_once_more_and_is_there_to_be_fitted(case: Problem, again: int) -> None:
    after = changed(case, procedure(case, f"run {again + 1} once more"))
    runs, first = after.measured.runs, case.measured.runs
    assert runs == after.scenario.acquisition.runs == (*first, first[again])
    last = np.array([c.run for c in after.measured.channels]) == len(first)
    same = np.array([c.run for c in case.measured.channels]) == again
    assert [c.dof for c in after.measured.channels[-last.sum() :]] == [
        c.dof for c, here in zip(case.measured.channels, same, strict=True) if here
    ]
    assert after.split.train[last].all() and not after.split.held[last].any()
    assert np.array_equal(after.split.train[~last], case.split.train)
    assert np.array_equal(after.measured.values[last], case.measured.values[same])
    assert np.array_equal(after.measured.force[-1], case.measured.force[again])
    assert len(after.nuisances) == len(case.nuisances) + last.sum()


def test_exchanged_sensors_sit_in_reverse_order(case: Problem) -> None:
    exchanged = procedure(case, "exchange the sensors")
    after = changed(case, exchanged)
    assert after.measured.runs == tuple(run[::-1] for run in case.measured.runs)
    assert exchanged.minutes == len(case.measured.runs) * (3.0 + case.scenario.excitation.whole_s / 60)
    before = {(c.run, c.dof): (c.instrument, i) for i, c in enumerate(case.measured.channels)}
    for i, c in enumerate(after.measured.channels):
        place, row = before[c.run, c.dof]
        assert c.instrument == len(case.measured.runs[c.run]) - 1 - place
        assert np.array_equal(after.measured.values[i], case.measured.values[row])
        assert after.split.train[i] == case.split.train[row]


def test_averaged_sweeps_have_less_noise_and_the_same_error_of_the_model(case: Problem) -> None:
    averaged = procedure(case, "average 16 sweeps")
    after, before = changed(case, averaged).measured, case.measured
    assert np.allclose(after.noise, before.noise / 16)
    assert np.allclose(after.sigma**2 - after.noise, before.sigma**2 - before.noise)
    few = procedure(case, "average 4 sweeps")
    assert 3 * few.minutes > averaged.minutes > few.minutes > 3.0 * len(before.runs)


def test_noise_alone_keeps_them_together_and_averages_tell(case: Problem) -> None:
    """Half of what lies between two explanations, measured by what is left of noise and by the model's error."""
    fitted = str(case.measured.channels[int(np.flatnonzero(case.split.train)[0])].dof)
    noisy = replace(case.measured, noise=np.full_like(case.measured.noise, 1e-2) * np.abs(case.measured.values) ** 2)
    noisy = replace(noisy, sigma=np.sqrt(noisy.noise * (1 + 1e-6)))
    loud = replace(case, measured=noisy)
    right = claimed(loud, "channel-gain", {"gain_error": GAIN}, channels=fitted)
    wrong = claimed(loud, "channel-delay", {"delay_s": 1e-4}, channels=fitted)
    once = expected_nats(right, wrong, loud)
    often = expected_nats(right, wrong, changed(loud, procedure(loud, "average 16 sweeps")))
    assert once is not None and often is not None
    assert 2 * once < often < 17 * once


def test_one_run_with_all_sensors_is_not_repeated_for_the_sake_of_time(tmp_path: Path) -> None:
    """Nothing happened in between; sensors can still be exchanged."""
    whole = small_scenario()
    words = [p.words for p in procedures(make_problem(campaign_of(whole, 1), whole, lines=60, cache=tmp_path))]
    assert not any("once more" in w for w in words)
    assert any("exchange" in w for w in words)


def test_what_is_known_of_unknowns_goes_along_by_name(case: Problem) -> None:
    found = claimed(case, "channel-gain", {"gain_error": GAIN}, channels="3+Z")
    found = replace(found, u=np.arange(1.0, case.size + 1))
    after = changed(case, procedure(case, "run 2 once more"))
    u = dict(zip(after.names, known_in(after, found), strict=True))
    assert len(u) == after.size > case.size
    assert all(u[name] == found.u[k] for k, name in enumerate(case.names))
    assert {u[name] for name in after.names if name not in case.names} == {0.0}


@pytest.mark.slow
def test_runs_keep_the_numbers_that_their_gains_are_known_by(case: Problem) -> None:
    """Of runs 3 to 6 the gain of "run 3" was that of the first, and after a change that of the third."""
    campaign = campaign_of(roving_scenario(), 1)
    later = replace(campaign, runs=tuple(replace(run, run=run.run + 2) for run in campaign.runs))
    there = make_problem(later, roving_scenario(), lines=60)
    for words, count in (("run 3 once more", 5), ("exchange the sensors", 4)):
        after = changed(there, procedure(there, words))
        assert list(dict.fromkeys(c.run_number for c in after.measured.channels)) == [3, 4, 5, 6, 7][:count]
        assert set(there.names) <= set(after.names)


@pytest.mark.slow
def test_a_gain_that_changed_is_told_from_one_that_was_always_wrong(case: Problem) -> None:
    """In the last run alone the two are one; the sensor goes on to other points, and the point gets another sensor."""
    runs = case.measured.runs
    place, last = 0, len(runs) - 1
    node = runs[last][place]
    wrong = claimed(case, "channel-gain", {"gain_error": GAIN}, channels=f"{node}+Z")
    settings = {"channels": f"sensor-{place + 1}", "shape": "step", "from_run": last + 1}
    moved = claimed(case, "gain-drift", {"drift": GAIN}, **settings)
    assert np.allclose(wrong.predicted, moved.predicted, rtol=1e-9)
    first = suggest([wrong, moved], count=1)[0]
    # The last run again says nothing; what its sensor meets at other points does.
    assert first.test.startswith("make run") and f"run {last + 1} " not in first.test
    assert first.nats > suggesting._TELLS
    # Whatever is moved besides: another campaign finds the gain changed in all of its runs.
    moved_rig = changed(case, procedure(case, "half as stiff"))
    assert (expected_nats(wrong, moved, moved_rig) or 0.0) > suggesting._TELLS


def test_expected_nats_are_what_a_fit_of_the_changed_campaign_finds(case: Problem) -> None:
    """Half of what the wrong explanation leaves of the other's prediction beyond its tolerances, found by iteration."""
    fitted = str(case.measured.channels[int(np.flatnonzero(case.split.train)[0])].dof)
    right = claimed(case, "channel-gain", {"gain_error": GAIN}, channels=fitted)
    wrong = claimed(case, "channel-delay", {"delay_s": 1e-4}, channels=fitted)
    after = changed(case, procedure(case, "half as stiff"))
    expected = expected_nats(right, wrong, after)
    assert expected is not None
    true = fit(after, right.hypotheses, right.u, right.e, ())
    # Judged as data of that size would be: a rule of the records, not of this test.
    data = replace(after.measured, values=true.predicted, of_force=None)
    told = replace(after, measured=data.with_floor(case.scenario.tolerances.model_form))
    ends = [fit(told, f.hypotheses, f.u, f.e, NEAR) for f in (right, wrong)]
    # As a verdict counts it: by what a value is worth that the model's form is judged by.
    worth = noise_share(told.measured, told.split.train).worth
    left = 0.5 * (ends[1].cost - ends[0].cost - (1 - worth) * (ends[1].chi2 - ends[0].chi2))
    assert left > 1
    assert expected == pytest.approx(left, rel=0.1)


def test_where_no_test_tells_that_is_said() -> None:
    weak, strong = (Suggestion("a test", ("one", "other"), nats, 5.0) for nats in (1.0, 20.0))
    (said,) = words_of_none([weak], 5.0)
    assert "one from other" in said
    assert words_of_none([strong, weak], 5.0) == words_of_none([], 5.0) == ()


def test_two_places_of_one_effect_are_told_as_two(case: Problem) -> None:
    """Chosen or fitted, or a side; of two effects the names will do."""
    known = (
        claimed(case, "added-mass", {"mass_kg": 0.05}, x_m=0.9, y_m=1.2),
        claimed(case, "added-mass", {"mass_kg": 0.05, "x_m": 0.9, "y_m": -1.2}),
        claimed(case, "root-compliance", {}, side="left"),
        claimed(case, "root-compliance", {}, side="right"),
        claimed(case, "added-mass", {"mass_kg": 0.05, "x_m": 0.9, "y_m": -2e-4}),
    )
    test = suggesting._Test("a test", 5.0, lambda true, wrong: 1.0)

    def rivals(*which: int) -> tuple[str, str]:
        found = test.worth([known[k] for k in which], test.promised)
        assert found is not None
        return found.rivals

    right, left = "added-mass (x_m = 0.9, y_m = 1.2)", "added-mass (x_m = 0.9, y_m = -1.2)"
    assert rivals(0, 1) == (right, left)
    assert rivals(2, 3) == ("root-compliance (side = left)", "root-compliance (side = right)")
    assert rivals(0, 4) == (right, "added-mass (x_m = 0.9, y_m = 0)")
    assert rivals(1, 2) == ("added-mass", "root-compliance")
    (said,) = words_of_none([Suggestion("a test", rivals(0, 1), 1.0, 5.0)], 5.0)
    assert f"tell {right} from {left}" in said


def test_what_holds_the_same_others_is_known_from_another_process_too() -> None:
    """A helper, or a file, hands on copies: the fits that hold the same others are asked for by what they hold."""
    delay = Hypothesis(available_effects()["channel-delay"], {"channels": "response"})
    copied = copy.copy(delay)
    own, like, twin = (
        SimpleNamespace(name=name, fit=SimpleNamespace(of=name, hypotheses=(beside, name)))
        for name, beside in (("mass", delay), ("inertia", copied), ("payload", copied))
    )
    about: Any = SimpleNamespace(rounds=[Addition(own, (own, like), (), None, (own, twin))])  # type: ignore[arg-type]
    assert [fit.of for fit in undecided(about)] == ["mass", "payload", "inertia"]


def test_a_joint_that_is_alone_at_one_level_is_asked_what_another_level_tells(
    case: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From the best of another name, however far behind; and nothing but levels is compared."""
    rows = (("play", 90.0, False), ("play", 89.0, False), ("soft", 20.0, True), ("cubic", 30.0, False))
    rivals: Any = tuple(
        SimpleNamespace(name=n, gain_nats=g, fit=f"{n} {g:.0f}", hypothesis=SimpleNamespace(linear=linear))
        for n, g, linear in rows
    )
    round_of: Any = SimpleNamespace(rounds=[Addition(rivals[0], rivals[:2], rivals, None)])
    assert next_best(round_of) == ("play 90", "cubic 30")
    linear: Any = SimpleNamespace(rounds=[Addition(rivals[2], rivals[2:3], rivals, None)])
    assert next_best(linear) == ()
    campaigns_alone(monkeypatch, (Procedure("move the shaker", lambda s: s, 5.0),))
    monkeypatch.setattr(suggesting, "levels_to_try", lambda fits: (Procedure("half the force", lambda s: s, 5.0, 0.5),))
    for way in ("expected_nats", "found_nats"):
        monkeypatch.setattr(suggesting, way, lambda one, other, problem: 30.0)
    one = claimed(case, "channel-gain", {"gain_error": GAIN}, channels="3+Z")
    assert [t.test for t in suggest([one, one], levels_alone=True)] == ["half the force"]
    assert {t.test for t in suggest([one, one])} == {"half the force", "move the shaker"}


@pytest.mark.parametrize(("forth", "back"), [(20.0, 3.0), (3.0, 20.0)])
def test_a_test_promises_what_it_tells_whichever_is_true(
    case: Problem, monkeypatch: pytest.MonkeyPatch, forth: float, back: float
) -> None:
    one = claimed(case, "channel-gain", {"gain_error": GAIN}, channels="3+Z")
    other = replace(one)
    campaigns_alone(monkeypatch, (Procedure("a test", lambda s: s, 5.0),))
    for way in ("expected_nats", "found_nats"):
        monkeypatch.setattr(suggesting, way, lambda true, wrong, problem: forth if true is one else back)
    assert [t.nats for t in suggest([one, other])] == [3.0]


def test_what_a_campaign_promises_is_followed_to_the_end(case: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    """The linear distance is only where to begin; one that does not hold it falls behind, and so does no check."""
    tests = tuple(Procedure(words, lambda s: s, 5.0) for words in ("hollow", "good", "fair"))
    campaigns_alone(monkeypatch, tests)
    first = {"hollow": 45.0, "good": 40.0, "fair": 20.0}
    end = {"hollow": 1.0, "good": 30.0, "fair": 21.0}
    monkeypatch.setattr(suggesting, "expected_nats", lambda one, other, problem: first[problem])
    monkeypatch.setattr(suggesting, "found_nats", lambda one, other, problem: end[problem])
    one = claimed(case, "channel-gain", {"gain_error": GAIN}, channels="3+Z")
    assert [(t.test, t.nats) for t in suggest([one, one], count=2)] == [("good", 30.0), ("fair", 21.0)]


def test_more_than_certain_is_not_worth_more_minutes(case: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    campaigns_alone(monkeypatch, (Procedure("long", lambda s: s, 30.0), Procedure("short", lambda s: s, 5.0)))
    nats = {"long": 100 * suggesting._CERTAIN, "short": 2 * suggesting._CERTAIN}
    for way in ("expected_nats", "found_nats"):
        monkeypatch.setattr(suggesting, way, lambda one, other, problem: nats[problem])
    one = claimed(case, "channel-gain", {"gain_error": GAIN}, channels="3+Z")
    assert [t.test for t in suggest([one, one])] == ["short", "long"]


def test_what_tells_comes_before_what_is_quick(case: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    quick, slow = Procedure("quick", lambda s: s, 1.0), Procedure("slow", lambda s: s, 60.0)
    nats = {"quick": suggesting._TELLS - 1, "slow": suggesting._TELLS + 1}
    campaigns_alone(monkeypatch, (quick, slow))
    for way in ("expected_nats", "found_nats"):
        monkeypatch.setattr(suggesting, way, lambda one, other, problem: nats[problem])
    one = claimed(case, "channel-gain", {"gain_error": GAIN}, channels="3+Z")
    assert [t.test for t in suggest([one, one])] == ["slow", "quick"]
