"""How far all that is uncertain was taken together: chance where the truth keeps its tolerances, far more where not."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, small_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.evidence.residual import Residual, residual
from vgvt.reconcile.evidence.strain import strain_sd
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.question.problem import CELLS, make_problem
from vgvt.reconcile.question.thresholds import NoiseShare, stored_thresholds


def fitted(u: np.ndarray, covariance: np.ndarray, *names: str) -> Any:
    """A fit of unknowns ``names``, by default of a tolerance each."""
    problem = SimpleNamespace(names=names or tuple(f"tolerance {k}" for k in range(u.size)))
    return SimpleNamespace(u=u, covariance=covariance, problem=problem)


def estimated(g: np.random.Generator, slopes: np.ndarray, lean: float = 0.0) -> Any:
    """What a linear fit makes of scores that were drawn, all of them displaced by ``lean``, and of unit noise."""
    count = slopes.shape[1]
    truth = g.standard_normal(count) + lean
    data = slopes @ truth + g.standard_normal(slopes.shape[0])
    covariance = np.linalg.inv(slopes.T @ slopes + np.eye(count))
    return fitted(covariance @ slopes.T @ data, covariance)


def test_of_truths_within_their_tolerances_it_is_a_standard_deviate() -> None:
    """Whatever the data tell of each: some much, some nothing."""
    g = np.random.default_rng(4)
    slopes = g.standard_normal((60, 25)) * np.logspace(-3, 1, 25)
    seen = np.array([strain_sd(estimated(g, slopes)) for _ in range(4000)])
    assert abs(seen.mean()) < 4 / np.sqrt(seen.size)
    assert seen.std() == pytest.approx(1.0, abs=0.07)


def test_all_that_lean_a_little_stand_out_together() -> None:
    g = np.random.default_rng(5)
    slopes = 10 * g.standard_normal((60, 25))
    leaning = [estimated(g, slopes, lean=1.5) for _ in range(50)]
    assert np.median([strain_sd(f) for f in leaning]) > 5
    # None of them by itself.
    assert np.median([np.abs(f.u).max() for f in leaning]) < 4


def test_an_effects_own_parameters_do_not_count_and_nothing_strains_nothing() -> None:
    free = fitted(np.array([1.0, -1.0]), np.diag([0.5, 0.5, 1e-6]))
    alone = fitted(np.array([1.0, -1.0]), np.diag([0.5, 0.5]))
    assert strain_sd(free) == strain_sd(alone) == pytest.approx(1.0)
    assert strain_sd(fitted(np.zeros(0), np.zeros((0, 0)))) == 0.0


def test_the_cells_of_the_chain_are_no_tolerance() -> None:
    """Records of the scenario's own chain have that at the end of its range: nothing leans."""
    own = fitted(np.array([1.0, -1.0, -4.6]), np.diag([0.5, 0.5, 0.5]), "EI wing", "GJ wing", CELLS.name)
    assert strain_sd(own) == pytest.approx(1.0)


def calibrated(folder: Path, seed: int, *effects: Any) -> Fit:
    """The small scenario calibrated to a campaign."""
    scenario = small_scenario()
    return calibrate(make_problem(campaign_of(scenario, seed, *effects), scenario, lines=150, cache=folder))


@pytest.mark.slow
def test_what_tolerances_imitate_is_no_longer_adequate(tmp_path: Path) -> None:
    """Data met by leaning on the tolerances are met at a price; without an effect there is none."""
    limits = stored_thresholds()
    sound = residual(calibrated(tmp_path, 11), limits)
    assert sound.adequate
    assert sound.strain_sd < sound.limits.strain_sd
    heavy = available_effects()["added-mass"](mass_kg=0.1, x_m=0.75, y_m=0.9)
    bent = residual(calibrated(tmp_path, 11, heavy), limits)
    assert bent.strain_sd > bent.limits.strain_sd
    assert not bent.adequate
    assert sound.met
    assert any("lean on it" in reason for reason in bent.reasons)


@pytest.mark.parametrize(
    ("chi2", "smooth", "strain", "held_out", "adequate"),
    [
        (0.9, 0.9, 1.0, 99.0, True),
        (1.2, 0.9, 1.0, 0.9, False),
        (0.9, 1.2, 1.0, 0.9, False),
        (0.9, 0.9, 7.0, 0.9, False),
    ],
)
def test_what_is_fitted_is_adequate_however_held_out_data_are_missed(
    chi2: float, smooth: float, strain: float, held_out: float, adequate: bool
) -> None:
    limits: Any = SimpleNamespace(chi2_per_dof=1.1, smooth_per_dof=1.1, held_out_per_dof=1.1, strain_sd=6.0)
    nothing, plane = np.zeros(0), np.zeros((0, 0))
    found = Residual(
        (), nothing, plane.astype(complex), nothing, plane, chi2, held_out, smooth, 0.0, 0.0, 0.0,
        met=False, adequate=False, reasons=(), limits=limits, noise_per_dof=1.0, held_out_noise_per_dof=1.0,
        strain_sd=strain,
    )  # fmt: skip
    assert found.fitted_adequate is adequate


def test_its_limit_grows_with_the_models_form() -> None:
    """As the evidence that a name needs does: what the form has wrong is imitated in proportion to its size."""
    limits = stored_thresholds()
    assert limits.strain_form_sd > limits.strain_sd > 2.5
    assert NoiseShare(1.0, 10, 0.004).form_size == 0.0
    assert NoiseShare(0.19, 10, 0.004).form_size == pytest.approx(0.9)
