"""Changes of procedure: what each does to the scenario, and the campaign that it then foretells."""

from __future__ import annotations

import importlib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_scenario, small_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.fit import Fit, fit
from vgvt.reconcile.hypothesis import Hypothesis
from vgvt.reconcile.problem import Problem, make_problem
from vgvt.reconcile.procedures import Procedure, changed, procedures
from vgvt.reconcile.suggest import Suggestion, known_in, suggest, words_of_none
from vgvt.reconcile.verdict import undecided

# The package's lazy name of the same spelling is the function.
suggesting = importlib.import_module("vgvt.reconcile.suggest")
GAIN = 0.05


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A campaign of four runs with five roving sensors."""
    scenario = roving_scenario()
    return make_problem(campaign_of(scenario, 1), scenario, lines=100, cache=tmp_path_factory.mktemp("cache"))


def procedure(case: Problem, words: str) -> Procedure:
    (found,) = (p for p in procedures(case) if words in p.words)
    return found


def claimed(case: Problem, name: str, values: dict[str, float], **settings: Any) -> Fit:
    """An effect of a given size, as if it had been fitted."""
    hypothesis = Hypothesis(available_effects()[name], settings)
    return fit(case, (hypothesis,), np.zeros(case.size), hypothesis.scores(values), ())


def test_the_first_run_comes_once_more_and_is_there_to_be_fitted(case: Problem) -> None:
    after = changed(case, procedure(case, "first run once more"))
    runs, first = after.measured.runs, case.measured.runs
    assert runs == (*first, first[0])
    split = after.split
    last = np.array([c.run for c in after.measured.channels]) == len(first)
    assert last.sum() == len(first[0])
    assert split.train[last].all()
    assert np.array_equal(split.train[~last], case.split.train)
    assert after.measured.frequency_hz.size == pytest.approx(case.measured.frequency_hz.size, rel=0.05)


def test_exchanged_sensors_sit_in_reverse_order(case: Problem) -> None:
    exchanged = procedure(case, "exchange the sensors")
    assert exchanged.edit(case.scenario).acquisition.runs == tuple(run[::-1] for run in case.measured.runs)
    assert exchanged.minutes == 5.0 * len(case.measured.runs)


def test_one_run_with_all_sensors_is_not_repeated_for_the_sake_of_time(tmp_path: Path) -> None:
    """Nothing happened in between; sensors can still be exchanged."""
    whole = small_scenario()
    words = [p.words for p in procedures(make_problem(campaign_of(whole, 1), whole, lines=60, cache=tmp_path))]
    assert not any("once more" in w for w in words)
    assert any("exchange" in w for w in words)


def test_what_is_known_of_unknowns_goes_along_by_name(case: Problem) -> None:
    found = claimed(case, "channel-gain", {"gain_error": GAIN}, channels="3+Z")
    after = changed(case, procedure(case, "first run once more"))
    u, covariance = known_in(after, found)
    assert u.size == after.size > case.size
    names = list(after.names)
    k, same = names.index("gain force"), list(case.names).index("gain force")
    assert covariance[k, -1] == found.covariance[same, -1] != 0
    new = [i for i, name in enumerate(names) if name not in case.names]
    assert np.array_equal(covariance[np.ix_(new, new)], np.eye(len(new)))
    assert not covariance[np.ix_(new, [k])].any()


def test_a_gain_that_changed_is_told_from_one_that_was_always_wrong(case: Problem) -> None:
    """In the last run alone the two are one; the sensor goes on to other points, and the point gets another sensor."""
    runs = case.measured.runs
    place, last = 0, len(runs) - 1
    node = runs[last][place]
    wrong = claimed(case, "channel-gain", {"gain_error": GAIN}, channels=f"{node}+Z")
    settings = {"channels": f"sensor-{place + 1}", "shape": "step", "from_run": last + 1}
    moved = claimed(case, "gain-drift", {"drift": GAIN}, **settings)
    assert np.allclose(wrong.predicted, moved.predicted, rtol=1e-9)
    tests = suggest([wrong, moved], count=30)
    assert tests[0].test in ("make the first run once more after the last", procedure(case, "exchange").words)
    assert tests[0].nats > suggesting._TELLS
    # Where the aircraft hangs, where it is pushed and what sticks to it tell nothing of a gain.
    rig = [t for t in tests if "run" not in t.test]
    assert len(rig) > 5
    assert all(t.nats < 1.0 for t in rig)


def test_where_no_test_tells_that_is_said() -> None:
    weak, strong = (Suggestion("a test", ("one", "other"), nats, 5.0) for nats in (1.0, 20.0))
    (said,) = words_of_none([weak], 5.0)
    assert "one from other" in said
    assert words_of_none([strong, weak], 5.0) == words_of_none([], 5.0) == ()


def test_a_test_has_to_tell_names_apart_before_places() -> None:
    """The best fit of each of the last round that names several, not five places of one of them."""

    def rival(name: str, fit: str) -> Any:
        return SimpleNamespace(name=name, fit=fit)

    def found(*rounds: tuple[Any, ...]) -> Any:
        return SimpleNamespace(rounds=[SimpleNamespace(winner=own[0], equivalent=own) for own in rounds])

    here, there, like = rival("mass", "here"), rival("mass", "there"), rival("inertia", "like")
    alone = rival("delay", "alone")
    assert undecided(found((here, there, like))) == ("here", "like")
    assert undecided(found((here, there, like), (alone,))) == ("here", "like")
    assert undecided(found((alone,), (here, there))) == ("here", "there")


def test_what_tells_comes_before_what_is_quick(case: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    quick, slow = Procedure("quick", lambda s: s, 1.0), Procedure("slow", lambda s: s, 60.0)
    nats = {"quick": suggesting._TELLS - 1, "slow": suggesting._TELLS + 1}
    monkeypatch.setattr(suggesting, "procedures", lambda problem: (quick, slow))
    monkeypatch.setattr(suggesting, "changed", lambda problem, p: p.words)
    monkeypatch.setattr(suggesting, "expected_nats", lambda one, other, words: nats[words])
    one = claimed(case, "channel-gain", {"gain_error": GAIN}, channels="3+Z")
    assert [t.test for t in suggest([one, one])] == ["slow", "quick"]
