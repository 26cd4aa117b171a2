"""Mode by mode: the modes of a fitted model are those of the beam, and errors are those of the responses."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from reconciled_case import claimed, roving_scenario

from vgvt.effects.beams import with_beams
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.next_test.before_test import expected_fit
from vgvt.reconcile.outcome.mode_errors import mode_rows, model_modes
from vgvt.reconcile.question.problem import make_problem
from vgvt.reconcile.question.uncertain import edited, unknowns
from vgvt.scenario import load_scenario
from vgvt.scenario.model import Scenario
from vgvt.simulation import simulate

# Blevins, Formulas for Natural Frequency and Mode Shape, 1979: free beam, (4.730, 7.853)^2 sqrt(EI / m) / (2 pi L^2).
BENDING_HZ = np.array([4.730041, 7.853205]) ** 2 * np.sqrt(40.0) / (2 * np.pi * 2.0**2)
TORSION_HZ = np.array([1, 2]) / (2 * 2.0) * np.sqrt(20.0 / 0.01)


def coarse_beam(sensor_kg: float = 0.0) -> Scenario:
    """The teaching beam with eight cells a side, in four runs of two sensors."""
    scenario = load_scenario("teaching-beam")
    parts = tuple(b.model_copy(update={"cells": 8}) for b in scenario.airframe.beam)
    changes = {
        "airframe": scenario.airframe.model_copy(update={"beam": parts}),
        "accelerometers": scenario.accelerometers.model_copy(update={"mass_kg": sensor_kg}),
        "acquisition": scenario.acquisition.model_copy(
            update={"sample_rate_hz": 100.0, "runs": ((9, 10), (3, 4), (5, 6), (1, 2))}
        ),
        "excitation": scenario.excitation.model_copy(update={"stop_hz": 25.0, "duration_s": 20.0}),
        "tolerances": scenario.tolerances.model_copy(update={"segments": 0}),
    }
    return scenario.model_copy(update=changes)


@pytest.fixture(scope="module")
def beam() -> Fit:
    return expected_fit(coarse_beam(), lines=120)


@pytest.mark.slow
def test_roving_accelerometers_sit_on_the_model_as_in_the_first_run() -> None:
    heavy = coarse_beam(0.05)
    found = model_modes(expected_fit(heavy, lines=60)).frequency_hz
    finer = with_beams(heavy, ["beam"], lambda b: b.model_copy(update={"cells": 24}))
    as_tested = simulate(finer, engine="linear").truth.as_tested[0].natural_frequency_hz
    bare = model_modes(expected_fit(coarse_beam(), lines=60)).frequency_hz
    for k, frequency in enumerate(found):
        # A hundred grams at the tip of two kilograms lower every mode by some per cent.
        assert frequency < 0.98 * bare[k]
        assert np.abs(as_tested / frequency - 1).min() < 0.01


def test_the_modes_of_the_model_are_those_of_the_beam(beam: Fit) -> None:
    found = model_modes(beam).frequency_hz
    for frequency in np.concatenate([BENDING_HZ, TORSION_HZ]):
        # The suspension lifts the first by about 1 %, eight cells a side do the rest.
        assert np.abs(found / frequency - 1).min() < 0.02


def test_a_model_against_itself_has_equal_errors_and_a_mac_of_one(beam: Fit) -> None:
    rows = mode_rows(beam, beam)
    assert len(rows) >= 3
    for row in rows:
        assert row.mac == pytest.approx(1.0)
        assert row.before_hz == row.after_hz
        assert row.train_percent[0] == row.train_percent[1]


def test_an_error_at_one_mode_shows_at_that_mode(beam: Fit) -> None:
    frequency = beam.problem.measured.frequency_hz
    exact = replace(beam, predicted=beam.problem.measured.values)
    wrong = replace(beam, predicted=exact.predicted * np.where(np.abs(frequency - BENDING_HZ[1]) < 1.0, 1.2, 1.0))
    rows = mode_rows(exact, wrong)
    for row in rows:
        assert row.after_hz is not None
        assert row.train_percent[0] == 0.0
        away = abs(row.after_hz - BENDING_HZ[1])
        if away < 0.3:
            assert row.train_percent[1] == pytest.approx(20.0)
        elif away > 2.0:
            assert row.train_percent[1] == 0.0
    assert any(abs((row.after_hz or 0) - BENDING_HZ[1]) < 0.3 for row in rows)


def test_a_model_that_changes_between_runs_is_held_against_one_that_does_not(beam: Fit) -> None:
    """Runs of one structure have some of the channels only; shapes are those of all points, in the first run."""
    drift = claimed(beam.problem, "run-drift", {"drift": -0.05}, shape="step", from_run=2)
    later = claimed(beam.problem, "run-drift", {"drift": -0.05}, shape="step", from_run=4)
    rows = mode_rows(beam, drift)
    assert len(rows) >= 3
    for row in rows:
        assert row.mac == pytest.approx(1.0)
        assert row.after_hz == pytest.approx(row.before_hz)
    assert model_modes(drift).shapes.shape == model_modes(later).shapes.shape


def test_both_models_are_held_against_the_modes_that_were_measured(beam: Fit) -> None:
    """Records of the model itself: it has no error, and a mass on it has what that does to its own modes."""
    problem = replace(beam.problem, measured=replace(beam.problem.measured, values=beam.predicted))
    heavy = claimed(problem, "added-mass", {"mass_kg": 0.1, "x_m": 0.0, "y_m": 0.45})
    rows = mode_rows(replace(beam, problem=problem), heavy)
    paired = [r for r in rows if r.before_hz and r.after_hz and r.seen]
    assert len(paired) >= 3
    for row in paired:
        seen, shift = row.seen, 100 * (row.after_hz / row.before_hz - 1)
        assert seen is not None and None not in (*seen.frequency_error_percent, *seen.mac)
        before, after = seen.frequency_error_percent
        assert before == pytest.approx(0.0, abs=0.02) and after == pytest.approx(shift, abs=0.05)
        assert seen.damping_error_percent[0] == pytest.approx(0.0, abs=0.5)
        assert seen.mac[0] > 0.9999 and 0.3 < seen.mac[1] < 1.0
        assert seen.frequency_hz == pytest.approx(row.before_hz, rel=2e-3)
    assert min(100 * (r.after_hz / r.before_hz - 1) for r in paired) < -1.0


def test_a_mode_that_the_records_do_not_show_has_nothing_measured(beam: Fit) -> None:
    """White noise in place of records."""
    g, values = np.random.default_rng(1), beam.problem.measured.values
    noise = g.standard_normal(values.shape) + 1j * g.standard_normal(values.shape)
    deaf = replace(beam.problem, measured=replace(beam.problem.measured, values=noise))
    rows = mode_rows(replace(beam, problem=deaf), replace(beam, problem=deaf))
    assert rows and sum(row.seen is None for row in rows) >= len(rows) - 1


def test_the_own_gain_of_a_held_out_channel_is_left_open_as_on_the_rest_of_the_page(beam: Fit) -> None:
    """No other record tells it: 0.6 % within its tolerance is no error of the model, and none of the table."""
    problem = beam.problem
    alone = np.array([n.rows.sum() == 1 for n in problem.nuisances])
    assert problem.split.held.any() and alone.any()
    gains = np.where(problem.split.held, 1.006, 1.0)[:, None]
    measured = replace(problem.measured, values=beam.predicted * gains)
    read = replace(beam, problem=replace(problem, measured=measured))
    assert 3 * min(n.sd for n, own in zip(problem.nuisances, alone, strict=True) if own) > 0.006
    told = mode_rows(read, replace(read))
    known = mode_rows(*[replace(read, predicted=read.foretold)] * 2)
    for row, other in zip(told, known, strict=True):
        assert row.held_out_percent is not None and other.held_out_percent is not None
        assert row.held_out_percent == pytest.approx(other.held_out_percent, abs=0.01)
        assert row.held_out_percent[1] < 0.1
        assert row.train_percent == pytest.approx((0.0, 0.0), abs=1e-9)


def test_what_was_measured_holds_the_truth_where_lines_are_few(tmp_path: Path) -> None:
    """Of sixty lines four are in a peak: damping ratios of the records were 12 of their stated deviations off."""
    scenario = roving_scenario()
    known = unknowns(scenario)
    truth = edited(scenario, known, np.random.default_rng(1).standard_normal(len(known)))
    made = simulate(truth.model_copy(update={"seed": 1}), engine="linear")
    every = [(t.natural_frequency_hz, t.damping_ratio) for t in made.truth.as_tested]
    hz, damping = np.array(every).mean(axis=0)
    calibrated = calibrate(make_problem(made.campaign, scenario, lines=60, cache=tmp_path))
    seen = [r.seen for r in mode_rows(calibrated, calibrated) if r.seen]
    assert len(seen) == 3
    for mode in seen:
        k = np.abs(hz - mode.frequency_hz).argmin()
        assert abs(mode.frequency_hz - hz[k]) < 3 * mode.frequency_std_hz < 1e-3 * hz[k]
        assert abs(mode.damping_ratio - damping[k]) < 3 * mode.damping_std < 0.2 * damping[k]
