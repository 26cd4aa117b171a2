"""Where a fit says that it has arrived, no step would gain anything of the measure that it is judged by."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from added_noise import Noise
from reconciled_case import roving_scenario, without_instrument_noise

from vgvt.effects import available_effects
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.fitting.misfit import data_misfit
from vgvt.reconcile.question.data import measured_frfs
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import problem_of
from vgvt.reconcile.question.uncertain import edited, unknowns
from vgvt.simulation import simulated_campaign


def left_nats(found: Fit) -> float:
    """What a free step would take off half the cost, where slopes stay as they are."""
    gradient = found.tangent.T @ data_misfit(found.problem, found.predicted) + found.scores
    return 0.5 * float(gradient @ found.covariance @ gradient)


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """Four runs of five sensors, 3 % of noise and a gauge that shares a fifth of it with all of them."""
    scenario = roving_scenario()
    known = unknowns(scenario)
    truth = edited(scenario, known, np.random.default_rng(3).standard_normal(len(known)))
    quiet = simulated_campaign(without_instrument_noise(truth), engine="linear")
    measured = measured_frfs(Noise(0.03, False).on(quiet, np.random.default_rng(3)), lines=400)
    assert measured.of_force is not None
    assert np.mean(np.abs(measured.of_force) ** 2) > 0.1
    cache: Path = tmp_path_factory.mktemp("cache")
    return calibrate(problem_of(measured, scenario, cache=cache))


def test_a_calibration_ends_at_the_bottom_of_what_it_is_judged_by(calibrated: Fit) -> None:
    assert calibrated.converged
    assert left_nats(calibrated) < 0.3


@pytest.mark.parametrize("name", ["re-hang", "drive-remount", "temperature-change"])
def test_however_many_data_there_are(calibrated: Fit, name: str) -> None:
    """A thousandth of the square sum of ten thousand values is five nats, as much as tells a name from another."""
    hypothesis = Hypothesis(available_effects()[name], {"from_run": 3})
    start = np.full(len(hypothesis.parameters), 0.3)
    found = fit(calibrated.problem, (hypothesis,), calibrated.u, start, NEAR)
    assert found.converged
    assert left_nats(found) < 0.3


def test_limits_speak_of_channels_each_by_itself(calibrated: Fit) -> None:
    """As :func:`vgvt.reconcile.residual` has it: noise that is shared leaves less of a χ² that takes it out."""
    measured, train = calibrated.problem.measured, calibrated.problem.split.train
    missed = np.abs((calibrated.predicted - measured.values)[train] / measured.sigma[train]) ** 2
    assert calibrated.chi2_per_dof == pytest.approx(missed.mean(), rel=1e-12)
    assert calibrated.chi2 / calibrated.points != pytest.approx(missed.mean(), rel=1e-3)
