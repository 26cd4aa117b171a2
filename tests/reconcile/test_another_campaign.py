"""What another campaign takes and finds: its lab time, the run that it repeats, and the state it is made in."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, claimed, roving_problem, small_scenario

from vgvt.reconcile.next_test.procedures import Procedure, changed, lab_minutes, levels_to_try, procedures
from vgvt.reconcile.next_test.suggest import known_in
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.problem import Problem, make_problem


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return roving_problem(tmp_path_factory.mktemp("cache"), lines=60)


# Of modes that are kept for other runs beside it a record's prediction knows that much.
ALIKE = 5e-4


def apart(one: np.ndarray, other: np.ndarray) -> float:
    """Distance of two predictions over the second's size."""
    return float(np.linalg.norm(one - other) / np.linalg.norm(other))


def procedure(case: Problem, words: str) -> Procedure:
    (found,) = (p for p in procedures(case) if words in p.words)
    return found


def test_no_campaign_that_is_made_anew_is_quicker_than_one_sweep_of_every_run(case: Problem) -> None:
    """What comes before it, a shaker to move or a spring to change, comes besides; one run is one run."""
    sweep_min = case.scenario.excitation.whole_s / 60
    once = len(case.measured.runs) * (3.0 + sweep_min)
    nonlinear = SimpleNamespace(problem=case, hypotheses=(SimpleNamespace(linear=False),))
    anew = [p for p in (*procedures(case), *levels_to_try([nonlinear])) if p.again is None]  # type: ignore[list-item]
    assert len(anew) > 8
    assert all(p.minutes >= once for p in anew)
    by_words = {p.words: p.minutes for p in anew}
    assert by_words["hang it on a spring half as stiff"] == pytest.approx(15.0 + once)
    assert by_words["excite on the centre line"] == pytest.approx(20.0 + once)
    assert by_words["sweep again with half the force"] == pytest.approx(5.0 + once)
    assert [p.minutes for p in procedures(case) if p.again is not None] == pytest.approx([3.0 + sweep_min] * 4)


def test_sensors_that_stay_for_the_next_run_are_moved_once(case: Problem) -> None:
    """Each of two places of the sensors is swept three times, as a plan with three repeats costs them, too."""
    runs = ((1, 2), (1, 2), (1, 2), (3, 4), (3, 4), (3, 4))
    repeated = replace(case, measured=replace(case.measured, runs=runs))
    sweep_min = case.scenario.excitation.whole_s / 60
    assert lab_minutes(repeated) == pytest.approx(2 * 3.0 + 6 * sweep_min)
    assert lab_minutes(repeated, 4) == pytest.approx(2 * 3.0 + 24 * sweep_min)
    assert lab_minutes(case) == pytest.approx(4 * (3.0 + sweep_min))


def test_of_runs_with_the_same_sensors_the_one_that_is_named_comes_once_more(tmp_path: Path) -> None:
    """Two levels of force, and the second is to be made again."""
    scenario = small_scenario()
    twice = scenario.model_copy(update={"acquisition": scenario.acquisition.model_copy(update={"repeats": 2})})
    found = campaign_of(twice, 1)
    second = replace(found.runs[1], samples=3 * np.asarray(found.runs[1].samples))
    levels = make_problem(replace(found, runs=(found.runs[0], second)), scenario, lines=60, cache=tmp_path)
    assert levels.measured.runs[0] == levels.measured.runs[1]
    for k in range(2):
        after = changed(levels, procedure(levels, f"run {k + 1} once more"))
        assert np.array_equal(after.measured.pushed[-1], levels.measured.pushed[k])


COURSES = [
    ("run-drift", {"drift": -0.02}, {"shape": "linear"}),
    ("gain-drift", {"drift": 0.05}, {"shape": "exponential"}),
    ("drive-remount", {"shift_y_m": 0.02}, {"from_run": 3}),
    ("channel-gain", {"gain_error": 0.05}, {"channels": "sensor-2"}),
]


@pytest.mark.parametrize(("name", "values", "settings"), COURSES)
def test_records_that_are_there_are_not_changed_by_one_that_comes_after_them(
    case: Problem, name: str, values: dict[str, float], settings: dict[str, Any]
) -> None:
    """A course over the campaign's runs has ended with the last of them; the run after that is like it."""
    found, rows = claimed(case, name, values, **settings), len(case.measured.channels)
    last = len(case.measured.runs) - 1
    for again in (0, last):
        after = changed(case, procedure(case, f"run {again + 1} once more"))
        u = known_in(after, found)
        foretold = anchor(after, u, found.hypotheses, found.e, slopes=False).predict(u, found.e)
        assert apart(foretold[:rows], found.predicted) < ALIKE
    in_last = [c.run == last for c in case.measured.channels]
    if not settings.get("channels"):
        assert apart(foretold[rows:], found.predicted[in_last]) < ALIKE


@pytest.mark.parametrize(("name", "values", "settings"), COURSES[:3])
def test_another_campaign_finds_the_aircraft_as_the_last_run_left_it(
    case: Problem, name: str, values: dict[str, float], settings: dict[str, Any]
) -> None:
    found = claimed(case, name, values, **settings)
    always = {**settings, **({"shape": "step"} if "shape" in settings else {}), "from_run": 2}
    whole = claimed(case, name, values, **always)
    after = changed(case, procedure(case, "average 4"))
    told = [anchor(after, f.u, f.hypotheses, f.e, slopes=False).predict(f.u, f.e) for f in (found, whole)]
    assert np.allclose(told[0], told[1], rtol=1e-9)
    last = [c.run == len(case.measured.runs) - 1 for c in case.measured.channels]
    assert apart(told[0][last], found.predicted[last]) < ALIKE
    first = [c.run == 0 for c in case.measured.channels]
    assert apart(told[0][first], found.predicted[first]) > 20 * ALIKE
