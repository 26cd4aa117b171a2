"""What is written back is what was fitted: its simulation meets the campaign as far as the fit does, gains and all."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, drawn_scores, roving_scenario, small_scenario

from vgvt.effects import available_effects
from vgvt.effects.beams import with_beams
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.mechanics.refinement import meshed
from vgvt.reconcile.outcome.augment import augment, posterior_of
from vgvt.reconcile.outcome.cells import at_whole_cells, with_cells
from vgvt.reconcile.outcome.instruments import gain_tables
from vgvt.reconcile.outcome.resimulate import accelerances, beyond_limits, quiet, resimulated
from vgvt.reconcile.prediction.chain import high_pass
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.figures_of_merit import compare
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, make_problem
from vgvt.reconcile.question.spectra import spectra_of
from vgvt.reconcile.question.thresholds import noise_share, stored_thresholds
from vgvt.reconcile.question.uncertain import edited, unknowns
from vgvt.reconcile.search.candidates import candidates
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.write import to_toml
from vgvt.signals.usable import usable_runs
from vgvt.simulation import simulated_campaign


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Derivatives are worked out once for all tests."""
    return tmp_path_factory.mktemp("resimulate")


def with_scores(case: Any, scores: dict[str, float]) -> Fit:
    """A fit at some scores by name, the chain as coarse as stated, the rest as stated."""
    u = np.zeros(case.size)
    for name, score in ({CELLS.name: -8 / CELLS.sd} | scores).items():
        u[case.names.index(name)] = score
    return fit(case, (), u, np.zeros(0), ())


def augmented(scenario: Scenario, found: Fit, folder: Path) -> Scenario:
    """The scenario of a fit as a file has it."""
    file = folder / "reconciled.toml"
    file.write_text(to_toml(augment(scenario, SimpleNamespace(final=found))), encoding="utf-8")  # type: ignore[arg-type]
    return load_scenario(file)


def test_a_force_gauge_that_reads_too_much_is_in_the_file(cache: Path, tmp_path: Path) -> None:
    """2 % within a tolerance of 1 %: no effect, and without its gain the file misses the campaign by far."""
    scenario = small_scenario()
    made = available_effects()["channel-gain"](gain_error=0.02, channels="force")
    found = calibrate(make_problem(campaign_of(scenario, 3, made), scenario, lines=150, cache=cache))
    written = augmented(scenario, found, tmp_path)
    (force,) = (t for t in written.effect if t.parameters["channels"] == "force")
    assert force.name == "channel-gain" and force.parameters["gain_error"] == pytest.approx(0.02, abs=0.008)
    # What the calibration tells is what the gauge does, not what that does to A/F; beside whole cells it is aside.
    (told,) = (r for r in posterior_of(found) if r["name"] == "gain force")
    assert told["factor"] == pytest.approx(1 + force.parameters["gain_error"], abs=told["factor_std"])
    assert told["factor_std"] < 0.005
    again = resimulated(written, found)
    bare = resimulated(written.model_copy(update={"effect": ()}), found)
    assert again.comparison is not None and bare.comparison is not None and again.apart is not None
    assert again.apart < 1.5 * again.model_form
    assert again.comparison.train.chi2_per_dof < found.chi2_per_dof + 1.0
    assert bare.comparison.train.chi2_per_dof > 3 * again.comparison.train.chi2_per_dof
    assert again.comparison.train.nu_gap < bare.comparison.train.nu_gap


def test_gains_and_corners_of_every_kind_do_in_the_file_what_they_do_in_the_fit(cache: Path, tmp_path: Path) -> None:
    """Sensors that rove, a point that two runs measure, each with its own gain, and AC coupling."""
    scenario = roving_scenario()
    runs = (*scenario.acquisition.runs, scenario.acquisition.runs[0])
    scenario = scenario.model_copy(
        update={
            "acquisition": scenario.acquisition.model_copy(update={"runs": runs}),
            "transducer": scenario.transducer.model_copy(update={"high_pass_hz": 0.3}),
            "accelerometers": scenario.accelerometers.model_copy(update={"high_pass_hz": 0.5}),
        }
    )
    case = make_problem(campaign_of(scenario, 1), scenario, lines=80, cache=cache)
    first, last = (next(c.label for c in case.measured.channels if c.run == r and c.dof.node == 5) for r in (0, 4))
    scores = {"gain force": 4.0, "gain sensor-2": -5.0, f"gain {first}": 6.0, f"gain {last}": -9.0}
    plain = with_scores(case, {})
    found = with_scores(case, scores | {"corner force": 3.0, "corner sensors": -2.0})
    written = augmented(scenario, found, tmp_path)
    assert written.transducer.high_pass_hz == pytest.approx(0.3 * np.exp(0.3))
    assert [t.name for t in written.effect] == [*["channel-gain"] * 3, "gain-drift"]
    assert gain_tables(scenario, plain) == ()
    # What the chain errs by is in both alike: the ratio of two simulations is that of two fits.
    changed, stated = resimulated_values(written, found), resimulated_values(scenario, plain)
    np.testing.assert_allclose(changed / stated, found.predicted / plain.predicted, rtol=1e-3)
    assert high_pass(0.3, case.measured.frequency_hz, 200.0)[0] != high_pass(0.4, case.measured.frequency_hz, 200.0)[0]


def resimulated_values(scenario: Scenario, found: Fit) -> np.ndarray:
    asked = quiet(scenario)
    return accelerances(simulated_campaign(asked, engine="linear"), asked, found.problem.measured)[0]


@pytest.mark.slow
def test_an_aircraft_has_no_cells_and_its_file_has_more(cache: Path, tmp_path: Path) -> None:
    """Data of three times as many cells: with those of the nominal scenario the file misses what was fitted by 4 %."""
    scenario = small_scenario()
    finer = with_beams(scenario, ["wing"], lambda b: b.model_copy(update={"cells": 36}))
    found = calibrate(make_problem(campaign_of(finer, 5), scenario, lines=150, cache=cache))
    written = augmented(scenario, found, tmp_path)
    names = [b.name for b in written.airframe.beam]
    coarse = with_beams(written, names, lambda b: b.model_copy(update={"cells": 12}))
    again, before = resimulated(written, found), resimulated(coarse, found)
    assert again.comparison is not None and before.comparison is not None
    assert again.comparison.train.chi2_per_dof < 0.2 * before.comparison.train.chi2_per_dof
    assert before.remark.startswith("The simulation of reconciled.toml is")


@pytest.mark.parametrize(("asked", "written"), [(1.0, 12), (1.08, 12), (1.2, 12), (1.3, 16), (3.0, 36), (9.0, 60)])
def test_nearly_as_many_cells_as_stated_are_as_many(asked: float, written: int) -> None:
    """Of twelve a fit to data of the same chain asks for thirteen now and then, which err by another per cent."""
    scenario = small_scenario()
    amount = -min(1 / asked**2, 1 - 1e-6)
    problem = SimpleNamespace(stated=meshed(scenario), unknowns=(CELLS,))
    found = SimpleNamespace(problem=problem, u=np.array([np.arctanh(amount) / CELLS.sd]))
    assert {b.cells for b in with_cells(meshed(scenario), found).airframe.beam} == {written}  # type: ignore[arg-type]


@pytest.mark.parametrize("ended", [True, False])
def test_a_file_keeps_what_its_fit_keeps_with_any_number_of_cells(cache: Path, tmp_path: Path, ended: bool) -> None:
    """Halfway from the stated chain to a continuum is no chain: one of as many cells left 1.87, the fit 0.64.

    Also where a fit ran out of steps near its bottom.
    """
    scenario = small_scenario()
    finer = with_beams(scenario, ["wing"], lambda b: b.model_copy(update={"cells": 24}))
    found = calibrate(make_problem(campaign_of(finer, 4), scenario, lines=150, cache=cache))
    found = replace(found, converged=ended)
    written = augmented(scenario, found, tmp_path)
    assert {b.cells for b in written.airframe.beam} != {12}
    again = resimulated(written, found).comparison
    assert again is not None and again.held_out is not None
    fitted = compare(found.foretold, found.problem.measured, found.problem.split)
    assert fitted.held_out is not None
    assert again.train.chi2_per_dof < 1.02 * found.chi2_per_dof
    assert again.held_out.chi2_per_dof < 1.02 * fitted.held_out.chi2_per_dof
    # Nothing is bent for it.
    others = [k for k, name in enumerate(found.problem.names) if name != CELLS.name]
    assert np.abs((at_whole_cells(found).u - found.u)[others]).max() < 0.5


def test_cells_that_a_fit_does_not_know_are_those_that_are_likeliest_as_they_are(cache: Path) -> None:
    """Data of the stated chain, and a score halfway: all three are looked at, not the score alone."""
    scenario = small_scenario()
    found = calibrate(make_problem(campaign_of(scenario, 1), scenario, lines=60, cache=cache))
    score = found.problem.names.index(CELLS.name)
    halfway = np.where(np.arange(found.u.size) == score, -1.0, found.u)
    unsure = replace(fit(found.problem, (), halfway, np.zeros(0), ()), converged=True)
    assert {b.cells for b in with_cells(scenario, unsure).airframe.beam} == {18}
    assert {b.cells for b in with_cells(scenario, at_whole_cells(unsure)).airframe.beam} == {12}
    # On its way, and as far as this, a fit is written as it is.
    on_its_way = at_whole_cells(replace(unsure, converged=False))
    assert {b.cells for b in with_cells(scenario, on_its_way).airframe.beam} == {18}
    np.testing.assert_array_equal(np.delete(on_its_way.u, score), np.delete(unsure.u, score))


@pytest.mark.slow
def test_what_goes_with_a_tenth_of_a_cell_is_not_written_beside_whole_ones(cache: Path, tmp_path: Path) -> None:
    """Data of the stated chain, whose end no score reaches: stiffness, masses and gains had taken up the rest of it."""
    scenario = small_scenario()
    found = calibrate(make_problem(campaign_of(scenario, 1), scenario, lines=150, cache=cache))
    score = found.u[found.problem.names.index(CELLS.name)]
    assert -5 < score < -3
    limits = stored_thresholds().at(noise_share(found.problem.measured, found.problem.split.train))
    own = residual(found, limits).limits
    again = resimulated(augmented(scenario, found, tmp_path), found, limits)
    assert again.comparison is not None and again.comparison.held_out is not None
    assert found.chi2_per_dof < own.chi2_per_dof
    fitted = compare(found.foretold, found.problem.measured, found.problem.split)
    assert fitted.held_out is not None and fitted.held_out.chi2_per_dof < 0.59
    assert again.comparison.train.chi2_per_dof < 1.02 * found.chi2_per_dof
    assert again.comparison.held_out.chi2_per_dof < 1.02 * fitted.held_out.chi2_per_dof
    assert "misses" not in again.remark
    further = replace(again.comparison, held_out=replace(again.comparison.held_out, chi2_per_dof=0.75))
    strict = replace(own, held_out_per_dof=0.6)
    (said,) = beyond_limits(further, fitted, strict)
    assert "misses the held-out data by 0.75" in said and said.endswith("and 0.60 is the limit")
    assert beyond_limits(again.comparison, again.comparison, strict) == []
    # By the fit's own model nothing is lost, and of what no data say nothing has moved.
    written = at_whole_cells(found)
    beside = anchor(found.problem, written.u, slopes=False).predict(written.u, written.e)
    assert written.u[found.problem.names.index(CELLS.name)] < -10
    assert replace(found, predicted=beside).chi2_per_dof < 1.01 * found.chi2_per_dof
    others = [k for k, name in enumerate(found.problem.names) if name != CELLS.name]
    assert 0.05 < np.abs((written.u - found.u)[others]).max() < 0.5
    far = replace(found, u=np.where(found.u == score, -100.0, found.u))
    assert at_whole_cells(far) is far


def test_a_simulation_without_noise_ends_as_the_data_did(cache: Path) -> None:
    """Its quiet end is no reason not to taper it, where those of the data were; and sensors weigh what they do."""
    scenario = small_scenario()
    case = make_problem(campaign_of(scenario, 1), scenario, lines=300, cache=cache)
    measured, scores = case.measured, drawn_scores(case, 1)
    scores[case.names.index(CELLS.name)] = -100.0
    foretold = anchor(case, scores, slopes=False).predict(scores, np.zeros(0))
    known = unknowns(scenario)
    truth = edited(scenario, known, scores[: len(known)])
    assert measured.endings[0].last.size > 0
    (run,) = usable_runs(simulated_campaign(quiet(truth), engine="linear"), every_run=True)[0]
    assert spectra_of((run,), scenario.acquisition.sample_rate_hz)[0].ends[0].tapered == 0
    again, excited = accelerances(simulated_campaign(quiet(truth), engine="linear"), quiet(truth), measured)
    assert excited > 0.99
    apart = np.abs(again - foretold)[measured.used] / measured.sigma[measured.used]
    assert np.sqrt(np.mean(apart**2)) < 0.02
    assert apart.max() < 0.2


def test_records_of_another_length_and_rate_are_read_at_the_same_lines(cache: Path) -> None:
    scenario = small_scenario()
    found = with_scores(make_problem(campaign_of(scenario, 1), scenario, lines=80, cache=cache), {})
    acquisition = scenario.acquisition.model_copy(update={"sample_rate_hz": 250.0})
    excitation = scenario.excitation.model_copy(update={"ring_down_s": 3.3})
    other = scenario.model_copy(update={"acquisition": acquisition, "excitation": excitation})
    here, there = resimulated_values(scenario, found), resimulated_values(other, found)
    assert (np.linalg.norm(there - here, axis=1) < 5e-3 * np.linalg.norm(here, axis=1)).all()


def test_what_cannot_be_simulated_is_said(cache: Path) -> None:
    scenario = small_scenario()
    found = with_scores(make_problem(campaign_of(scenario, 1), scenario, lines=80, cache=cache), {})
    rattles = Hypothesis(available_effects()["rattling-mass"], {})
    assert (
        "rattling-mass was foretold as it is at rest"
        in resimulated(scenario, replace(found, hypotheses=(rattles,))).remark
    )
    narrow = scenario.model_copy(update={"excitation": scenario.excitation.model_copy(update={"stop_hz": 8.0})})
    assert "has no force on" in resimulated(narrow, found).remark
    nowhere = Scenario.model_validate(scenario.model_dump() | {"effect": [{"name": "no-such-effect"}]})
    told = resimulated(nowhere, found)
    assert told.comparison is None and "cannot be simulated" in told.remark
    assert told.document() | {"remark": ""} == dict.fromkeys(
        ("train", "held_out", "held_runs", "held_channels", "apart")
    ) | {"remark": ""}


@pytest.mark.parametrize(("table", "key", "channel"), [("accelerometers", "range_g", 2), ("transducer", "range_n", 1)])
def test_what_is_cut_off_when_it_is_simulated_is_skipped_in_one_line(
    cache: Path, table: str, key: str, channel: int
) -> None:
    """The reason has two lines, and a comment in a file has one."""
    scenario = small_scenario()
    campaign = campaign_of(scenario, 3)
    found = with_scores(make_problem(campaign, scenario, lines=60, cache=cache), {})
    half = 0.5 * float(np.abs(campaign.runs[0].samples[channel]).max()) / (9.81 if key == "range_g" else 1.0)
    short = scenario.model_copy(update={table: getattr(scenario, table).model_copy(update={key: half})})
    again = resimulated(short, found)
    assert again.comparison is None
    assert "it cannot be simulated" in again.remark and "\n" not in again.remark


def test_a_file_with_calibrated_gains_leaves_gains_to_be_found(cache: Path, tmp_path: Path) -> None:
    scenario = small_scenario()
    case = make_problem(campaign_of(scenario, 3), scenario, lines=60, cache=cache)
    gains = {name: 0.5 for name in case.names if name.startswith("gain")}
    written = augmented(scenario, with_scores(case, gains), tmp_path)
    assert {t.name for t in written.effect} >= {"channel-gain"}
    again = make_problem(campaign_of(scenario, 3), written, lines=60, cache=cache)
    asked = {h.name for h in candidates(again, {n: available_effects()[n] for n in ("channel-gain", "added-mass")})}
    assert asked == {"channel-gain", "added-mass"}
