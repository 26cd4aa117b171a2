"""Stated standard deviations hold the truth as often as they say, also where the model's own error is not random."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from added_noise import Noise
from reconciled_case import drawn_scores, problem, small_scenario, without_instrument_noise

from vgvt.effects import available_effects
from vgvt.effects.conformance import table_of
from vgvt.reconcile.evidence.posterior import honest, honest_covariance
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.outcome.account import _posterior
from vgvt.reconcile.outcome.augment import posterior_of
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, make_problem
from vgvt.reconcile.question.uncertain import edited, unknowns
from vgvt.simulation import simulated_campaign
from vgvt.view.reconcile_account import FIGURES

DRAWS = 30


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """A model where the truth is, of a campaign with its instruments' noise."""
    case = problem(tmp_path_factory.mktemp("cache"), 3)
    return fit(case, (), drawn_scores(case, 3), np.zeros(0), ())


def with_noise_share(calibrated: Fit, share: float) -> Fit:
    """The same fit with a part of the variance that it is judged by called noise."""
    measured = calibrated.problem.measured
    told = replace(measured, noise=share * measured.sigma**2)
    return replace(calibrated, problem=replace(calibrated.problem, measured=told))


def test_without_a_floor_it_is_the_posterior_of_laplace(calibrated: Fit) -> None:
    found = honest_covariance(with_noise_share(calibrated, 1.0))
    np.testing.assert_allclose(found, calibrated.covariance, rtol=1e-6, atol=1e-9)


def test_an_error_common_to_lines_and_channels_makes_it_wider(calibrated: Fit) -> None:
    before = np.sqrt(np.diag(calibrated.covariance))
    half, all_of_it = (np.sqrt(np.diag(honest(with_noise_share(calibrated, s)).covariance)) for s in (0.5, 0.0))
    assert (all_of_it >= before * (1 - 1e-9)).all()
    assert (half >= before * (1 - 1e-9)).all()
    # What is common to 22 channels and five lines of each: some scores feel it in full, none more.
    ratio = all_of_it / before
    assert 2.0 < ratio.max() <= np.sqrt(22 * 5 * 2)
    assert half.max() <= all_of_it.max()


def test_the_page_s_rows_hold_the_numbers_that_their_words_round(calibrated: Fit) -> None:
    for row, r in zip(_posterior(calibrated), posterior_of(calibrated), strict=True):
        assert row.figures == {name: r[name] for name in FIGURES if name in r}
        assert row.unit == r.get("unit", "") and row.figures
        if "stated" in r:
            kind = "factor" if "factor" in r else "shift"
            slope = row.figures["stated"] if kind == "factor" else 1.0
            assert row.figures["calibrated_std"] == pytest.approx(abs(slope) * row.figures[f"{kind}_std"])
    assert {"", "m", "kg"} <= {row.unit for row in _posterior(calibrated)}
    assert {name for row in _posterior(calibrated) for name in row.figures} == set(FIGURES)


def test_the_table_states_errors_of_amounts_and_not_of_scores(calibrated: Fit) -> None:
    """A hundredth of a standard deviation of each score further, what is told moves by a hundredth of its own."""
    deviations = np.sqrt(np.diag(honest(calibrated).covariance))
    further = replace(calibrated, u=calibrated.u + 0.01 * deviations)
    kinds = set()
    for here, there in zip(posterior_of(calibrated), posterior_of(further), strict=True):
        kind = "factor" if "factor" in here else "shift"
        kinds.add((here["name"] == CELLS.name, kind))
        moved = abs(float(there[kind]) - float(here[kind]))  # type: ignore[arg-type]
        assert moved == pytest.approx(0.01 * float(here[f"{kind}_std"]), rel=0.05)  # type: ignore[arg-type]
    assert {(True, "shift"), (False, "factor"), (False, "shift")} <= kinds


@pytest.mark.slow
def test_stated_intervals_hold_the_truth(tmp_path: Path) -> None:
    """Calibrated unknowns and the size of an effect over draws of all of them, of noise, and of nothing else."""
    scenario = small_scenario()
    known = unknowns(scenario)
    hypothesis = Hypothesis(available_effects()["added-mass"], {"x_m": 0.75, "y_m": 0.9})
    share, of_effect = [], []
    for draw in range(DRAWS):
        generator = np.random.default_rng(draw)
        true = generator.standard_normal(len(known))
        size = 0.5 * generator.standard_normal(1)
        made = hypothesis.effect(hypothesis.values(size))
        assert made is not None
        truth = without_instrument_noise(edited(scenario, known, true)).model_copy(update={"effect": (table_of(made),)})
        campaign = Noise(0.01, False).on(simulated_campaign(truth, engine="linear"), generator)
        case = make_problem(campaign, scenario, lines=120, cache=tmp_path)
        start = drawn_scores(case, draw)
        found = honest(fit(case, (hypothesis,), start, size, NEAR))
        sd = np.sqrt(np.diag(found.covariance))
        away = np.abs(found.scores[: len(known)] - true) / sd[: len(known)]
        share.append(float(np.mean(away < 1.96)))
        of_effect.append(float(abs(found.e[0] - size[0]) / sd[-1] < 1.96))
    figures = f"unknowns {np.mean(share):.3f}, effect {np.mean(of_effect):.3f}"
    # Intervals of a draw hang together: the error of their mean comes from the scatter between draws.
    assert np.mean(share) > 0.95 - 3 * np.std(share) / np.sqrt(DRAWS), figures
    assert np.mean(of_effect) > 0.95 - 3 * np.sqrt(0.95 * 0.05 / DRAWS), figures
