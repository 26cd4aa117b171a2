"""Readings of a rig that changed between runs, of sensors whose gains are fitted, and of what a reading is expected."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, check, claimed, roving_problem, roving_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import TO_THE_END, Fit, fit
from vgvt.reconcile.next_test.checks import read_by, seen, slopes_of
from vgvt.reconcile.next_test.with_reading import counted_law, followed_nats, reading_nats
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.question.thresholds import SMOOTHED


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return roving_problem(tmp_path_factory.mktemp("cache"), lines=60)


@pytest.mark.parametrize(
    ("words", "name", "values", "wanted"),
    [
        ("tape where the shaker", "drive-remount", {"shift_y_m": 0.02, "from_run": 3}, [0.0, 0.02]),
        ("tape where the hook", "re-hang", {"shift_x_m": 0.03, "from_run": 2}, [0.03, 0.0, 0.0]),
    ],
)
def test_what_is_read_after_a_campaign_is_how_its_last_run_left_the_rig(
    case: Problem, words: str, name: str, values: dict[str, Any], wanted: list[float]
) -> None:
    effect, tape = available_effects()[name](**values), check(case, words)
    shown = tape.read(seen(case.scenario, [effect])) - tape.read(seen(case.scenario, []))
    assert shown == pytest.approx(wanted)


def test_a_tape_finds_sensors_that_were_exchanged_twice_where_they_sit(case: Problem) -> None:
    """The first with the second, then the first with the third: a cycle, of which no exchange alone knows."""
    one, two, three = case.scenario.acquisition.run_nodes[0][:3]
    swap, tape = available_effects()["swapped-sensors"], check(case, "tape where every sensor")
    effects = [swap(node=one, other_node=other) for other in (two, three)]
    before, after = (tape.read(seen(case.scenario, made)).reshape(-1, 2)[:3] for made in ([], effects))
    assert after == pytest.approx(before[[2, 0, 1]])


def test_a_tape_tells_not_when_a_drive_point_was_moved(case: Problem) -> None:
    """Two centimetres off from the first run on, or from the third on: afterwards they are one."""
    always = claimed(case, "drive-point-offset", {"dy_m": 0.02})
    later = claimed(case, "drive-remount", {"shift_y_m": 0.02}, from_run=3)
    tape = check(case, "tape where the shaker")
    for one, other in ((always, later), (later, always)):
        assert reading_nats(one, other, tape) == pytest.approx(0.0, abs=0.5)


@pytest.mark.parametrize("channels", ["sensor-1", "response"])
def test_a_reference_sensor_tells_not_when_a_gain_changed(case: Problem, channels: str) -> None:
    """It comes beside the sensors after the last run, and finds all of them as that left them."""
    always = claimed(case, "channel-gain", {"gain_error": 0.05}, channels=channels)
    later = claimed(case, "gain-drift", {"drift": 0.05}, channels=channels, shape="step", from_run=3)
    never = claimed(case, "channel-gain", {"gain_error": 0.0}, channels=channels)
    reference = check(case, "reference accelerometer")
    for one, other in ((always, later), (later, always)):
        assert reading_nats(one, other, reference) == pytest.approx(0.0, abs=1.0)
    assert (reading_nats(later, never, reference) or 0.0) > 5.0


@pytest.mark.parametrize(
    ("words", "name", "values", "settings"),
    [
        ("where every sensor sits", "sensor-position-error", {"dx_m": 0.01}, {"node": 5}),
        ("level to every sensor", "sensor-tilt", {"angle_rad": 0.05}, {"sensors": "5+Z"}),
        ("reference accelerometer", "channel-gain", {"gain_error": 0.05}, {"channels": "5+Z"}),
    ],
)
def test_a_sensor_that_stays_for_three_runs_is_read_once(
    case: Problem, words: str, name: str, values: dict[str, float], settings: dict[str, Any]
) -> None:
    """Whatever the campaign repeats: a second look at it says nothing new, and takes no minutes."""
    runs = tuple(run for run in case.measured.runs for _ in range(3))
    once = case.scenario
    thrice = once.model_copy(update={"acquisition": once.acquisition.model_copy(update={"runs": runs})})
    repeated = replace(case, measured=replace(case.measured, runs=runs))
    made = [available_effects()[name](**values, **settings)]
    few, many = check(case, words), check(repeated, words)
    assert many.minutes == few.minutes
    assert many.read(seen(thrice, made)) == pytest.approx(few.read(seen(once, made)))


def test_what_is_read_beside_runs_or_before_them_follows_them(case: Problem) -> None:
    later = claimed(case, "temperature-change", {"warming_k": 2.0}, shape="step", from_run=3)
    assert read_by(later, later.scores, check(case, "thermistor")) == pytest.approx([0.0, 0.0, 2.0, 2.0])
    # Nor is a scale that is read before and after one that is read after alone.
    heavier = claimed(case, "payload-change", {"mass_kg": 0.05}, x_m=0.5, y_m=0.0, from_run=3)
    first, last = read_by(heavier, heavier.scores, check(case, "weigh the aircraft"))
    assert last - first == pytest.approx(0.05)


def judged_by(found: Fit, noise: float) -> Fit:
    """The same fit, with a share of what its data are judged by that is noise; the rest is the model's form."""
    measured = found.problem.measured
    return replace(found, problem=replace(found.problem, measured=replace(measured, noise=noise * measured.sigma**2)))


def test_what_a_campaign_says_counts_beside_a_reading_as_a_verdict_counts_it(case: Problem) -> None:
    """A reading had been promised more: what it makes an explanation miss of the campaign counted whole."""
    scale, share = check(case, "weigh the force transducer"), 0.25
    heavier, light = (
        claimed(case, name, values)
        for name, values in (("transducer-mass", {"mass_kg": 0.01}), ("channel-gain", {"gain_error": 0.01}))
    )
    law = counted_law(judged_by(heavier, share), scale)
    slopes, exact = slopes_of(heavier, heavier.scores, law.mean, scale), scale.covariance(1)
    # The explanation bends by chi squared as it is.
    off = np.array([-0.01])
    step = heavier.covariance @ slopes.T @ np.linalg.solve(law.covariance, off)
    left, missed = off - slopes @ step, heavier.tangent @ step
    worth = share + (1 - share) / SMOOTHED
    # At a fit's bottom the data's slope is minus that of the priors, which count whole.
    pulled = 2 * (1 - worth) * (heavier.scores @ step)
    counted = left @ np.linalg.solve(exact, left) + step @ step + worth * (missed @ missed) + pulled
    assert 2 * (law.density(law.mean) - law.density(law.mean + off)) == pytest.approx(counted, rel=1e-6)
    # Of noise alone every value counts whole; where the model's form judges them, five nats were promised that no
    # verdict would count.
    told = {n: reading_nats(judged_by(light, n), judged_by(heavier, n), scale) for n in (1.0, 0.0)}
    assert told[1.0] > 7.0 > 5.0 > told[0.0]


@pytest.fixture(scope="module")
def plain(case: Problem) -> Fit:
    """What a campaign leaves of a gain that is not there, beside everything else."""
    null, hypothesis = calibrate(case), Hypothesis(available_effects()["channel-gain"])
    return fit(null.problem, (hypothesis,), null.u, hypothesis.scores({"gain_error": 0.0}), TO_THE_END)


def test_a_reading_that_is_followed_is_expected_and_not_only_foretold(case: Problem, plain: Fit) -> None:
    """Where all laws are straight the two ways are one: readings scatter about their mean in both."""
    hypothesis = Hypothesis(available_effects()["suspension-stiffness"])
    stiffer = fit(plain.problem, (hypothesis,), plain.u, hypothesis.scores({"stiffness_change": 0.02}), TO_THE_END)
    spring = check(case, "known mass on the spring")
    for true, other in ((stiffer, plain), (plain, stiffer)):
        straight = reading_nats(true, other, spring)
        # Twice what the two may differ by, that there is something to compare.
        assert straight is not None and straight > 0.2
        assert followed_nats(true, other, spring) == pytest.approx(straight, abs=0.1)


@pytest.mark.slow
def test_a_gain_that_another_explanation_has_taken_up_is_shown_by_a_reference_sensor_too() -> None:
    """A sensor 2 % off, as an effect, or 1.5 deviations of that sensor's own tolerance: the reading is foretold alike.

    It roves: what it reads in every run is one thing.
    """
    scenario = roving_scenario()
    made = available_effects()["channel-gain"](gain_error=0.02, channels="sensor-1")
    case = make_problem(campaign_of(scenario, 1, made), scenario, lines=100)
    gain = Hypothesis(available_effects()["channel-gain"], {"channels": "sensor-1"})
    soft = Hypothesis(available_effects()["root-compliance"], {"side": "left", "torsion": 0.0})
    pair = [
        fit(case, (h,), np.zeros(case.size), h.scores(values), TO_THE_END)
        for h, values in ((gain, {"gain_error": 0.02}), (soft, {"bending": 0.003}))
    ]
    leans = pair[1].u[case.names.index("gain sensor-1")]
    assert leans > 1.0
    reference = check(case, "reference accelerometer")
    for one, other in (pair, pair[::-1]):
        nats = reading_nats(one, other, reference)
        assert nats is not None and nats < 1.0


def test_a_reference_sensor_shows_a_fitted_gain_of_every_run_of_its_sensor(case: Problem) -> None:
    found = claimed(case, "channel-gain", {"gain_error": 0.0})
    reference, scores = check(case, "reference accelerometer"), np.zeros(case.size + 1)
    before = read_by(found, scores, reference)
    scores[case.names.index("gain sensor-2")] = 2.0
    after = read_by(found, scores, reference)
    assert before is not None and after is not None
    shown = (after - before).reshape(-1, 2, 10)
    second = [c.instrument == 1 for c in case.measured.channels]
    assert shown[second, 0] == pytest.approx(np.expm1(2 * case.scenario.tolerances.gain))
    assert not shown[np.logical_not(second)].any() and not shown[:, 1].any()
