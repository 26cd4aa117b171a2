"""Limits of what a right model leaves follow a campaign's noise and floor; a wrong one does not hide behind them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vgvt.data import Dof, InputError
from vgvt.reconcile import loop, searches
from vgvt.reconcile.evidence.residual import smooth_part
from vgvt.reconcile.placebo import Placebo, calibrated_thresholds
from vgvt.reconcile.question.data import Measured, MeasuredChannel
from vgvt.reconcile.question.holdout import Split
from vgvt.reconcile.question.thresholds import SMOOTHED, NoiseShare, Thresholds, limits_for, noise_share

CHANNELS, LINES, HELD = 12, 200, 3
SPLIT = Split(np.arange(CHANNELS) >= HELD, np.zeros(CHANNELS, dtype=bool), np.arange(CHANNELS) < HELD)


def case(noise: float, floor: float, form: float, seed: int) -> tuple[Measured, Placebo]:
    """Data with noise relative to each channel's median, and what a model with a smooth relative error leaves of them.

    ``form`` is the root mean square of that error.
    """
    g = np.random.default_rng(seed)
    exact = np.exp(_smooth(g).real + 1j * _smooth(g).real)
    variance = np.repeat((noise * np.median(np.abs(exact), axis=1, keepdims=True)) ** 2, LINES, axis=1)
    white = g.standard_normal((2, CHANNELS, LINES)) / np.sqrt(2)
    values = exact + np.sqrt(variance) * (white[0] + 1j * white[1])
    channels = tuple(MeasuredChannel(0, 1, Dof.from_label(f"{k + 1}+Z"), k) for k in range(CHANNELS))
    measured = Measured(
        np.arange(LINES) + 1.0, channels, values, variance, {}, np.sqrt(variance), np.ones((1, LINES), complex),
        np.arange(LINES), 1.0, (tuple(range(1, CHANNELS + 1)),), 100.0, np.ones(1), np.ones((1, 2)),
    ).with_floor(floor)  # fmt: skip
    rho = (exact * (1 + form * _smooth(g)) - values) / measured.sigma
    train, held = rho[SPLIT.train], rho[SPLIT.held]
    share, other = noise_share(measured, SPLIT.train), noise_share(measured, SPLIT.held)
    found = Placebo(
        float(np.mean(np.abs(train) ** 2)), smooth_part(train), float(np.mean(np.abs(held) ** 2)),
        0.0, share.noise, other.noise, share.floor,
    )  # fmt: skip
    return measured, found


def _smooth(g: np.random.Generator) -> np.ndarray:
    """Complex functions of frequency (C, L) of unit mean square that change over twenty lines."""
    rough = g.standard_normal((2, CHANNELS, LINES + 60))
    kernel = np.exp(-0.5 * (np.arange(-30, 31) / 10) ** 2)
    parts = np.array([[np.convolve(row, kernel, "valid") for row in part] for part in rough])
    out = parts[0] + 1j * parts[1]
    return np.asarray(out / np.sqrt(np.mean(np.abs(out) ** 2)))


def passes(thresholds: Thresholds, measured: Measured, found: Placebo) -> bool:
    """Whether what is left is within the limits."""
    limits = limits_for(thresholds, measured, SPLIT)
    assert found.held_out_per_dof is not None
    return (
        found.chi2_per_dof <= limits.chi2_per_dof
        and found.smooth_per_dof <= limits.smooth_per_dof
        and found.held_out_per_dof <= limits.held_out_per_dof
    )


@pytest.fixture(scope="module")
def thresholds() -> Thresholds:
    """From placebos of one noise, one floor and a model error of 0.15 %."""
    return calibrated_thresholds([case(0.003, 0.004, 0.0015, k)[1] for k in range(20)], "a test")


@pytest.mark.parametrize("noise", [0.0005, 0.003, 0.01, 0.03, 0.1])
def test_limits_hold_for_campaigns_of_other_noise(thresholds: Thresholds, noise: float) -> None:
    trials = [case(noise, 0.004, 0.0015, 1000 + k) for k in range(100)]
    # Two in a hundred for each of three limits, and four binomial deviations.
    assert sum(not passes(thresholds, *t) for t in trials) <= 6 + 4 * np.sqrt(6)


@pytest.mark.parametrize(("noise", "form"), [(0.003, 0.006), (0.01, 0.008), (0.03, 0.02)])
def test_an_error_well_below_a_floor_s_worth_of_noise_is_seen(
    thresholds: Thresholds, noise: float, form: float
) -> None:
    trials = [case(noise, 0.004, form, 2000 + k) for k in range(50)]
    assert sum(passes(thresholds, *t) for t in trials) <= 2


def test_a_declared_floor_is_taken_at_its_word_and_no_further(thresholds: Thresholds) -> None:
    def share(form: float) -> float:
        return float(np.mean([passes(thresholds, *case(0.003, 0.03, form, 3000 + k)) for k in range(50)]))

    # The floor is that share of |G| and of its median: together 1.4 times as much.
    assert share(0.025) > 0.9
    assert share(0.07) < 0.1


def test_without_a_floor_noise_is_all_that_may_be_left(thresholds: Thresholds) -> None:
    measured, found = case(0.01, 0.0, 0.0, 5)
    assert passes(thresholds, measured, found)
    limit = limits_for(thresholds, measured, SPLIT).chi2_per_dof
    # Noise is known within 3 %.
    assert 1.03 < limit < 1.1


def test_where_nothing_is_held_out_a_new_run_may_leave_what_the_fitted_ones_may(thresholds: Thresholds) -> None:
    """And not the four that a limit of no values at all comes to."""
    measured, _ = case(0.01, 0.004, 0.0, 5)
    nothing = np.zeros(CHANNELS, dtype=bool)
    everything = Split(~nothing, nothing, nothing)
    limits = limits_for(thresholds, measured, everything)
    assert limits.held_out_per_dof < 1.5
    assert limits.held_out_per_dof == pytest.approx(limits.chi2_per_dof, rel=0.2)


def test_placebos_that_drown_in_noise_tell_nothing_of_the_rest() -> None:
    with pytest.raises(InputError, match="noise hides the others"):
        calibrated_thresholds([case(0.1, 0.004, 0.0015, k)[1] for k in range(20)], "a test")


def test_an_error_of_the_model_counts_once_for_some_lines() -> None:
    """A smooth error of one floor, mended, is paid for as often as it changes; noise is paid for on every line."""
    assert NoiseShare(1.0, 100, 0.0).worth == 1.0
    assert NoiseShare(0.0, 100, 0.004).worth == pytest.approx(1 / SMOOTHED)
    quiet, loud = (noise_share(case(noise, 0.004, 0.0, 1)[0], SPLIT.train).worth for noise in (0.001, 0.1))
    assert quiet < 0.5 < 0.95 < loud


@pytest.mark.parametrize(("noise", "needed"), [(1.0, 9.0), (0.9, 9.0), (0.19, 12.6), (0.0, 14.0)])
def test_where_a_models_form_is_most_of_what_is_judged_by_a_name_needs_more(noise: float, needed: float) -> None:
    """Such an error is common to lines and channels: what is not there imitates it, by the root of its share."""
    limits = Thresholds(0.1, 0.1, 0.1, 9.0, 5.0, "a test", evidence_form_nats=14.0)
    assert limits.at(NoiseShare(noise, 1000, 0.004)).evidence_nats == pytest.approx(needed)
    # Those of before know one limit alone.
    assert Thresholds(0.1, 0.1, 0.1, 9.0, 5.0, "a test").at(NoiseShare(0.0, 1000, 0.004)).evidence_nats == 9.0


@pytest.mark.parametrize(("noise", "limit"), [(0.1, 3.0), (0.001, 7.0)])
def test_tolerances_may_be_leant_on_further_where_a_models_form_is_imitated(noise: float, limit: float) -> None:
    measured, _ = case(noise, 0.004, 0.0, 1)
    limits = Thresholds(0.1, 0.1, 0.1, 9.0, 5.0, "a test", strain_sd=3.0, strain_form_sd=7.5)
    found = limits_for(limits, measured, SPLIT).strain_sd
    assert found == pytest.approx(limit, abs=0.6)
    assert found == max(3.0, 7.5 * noise_share(measured, SPLIT.train).form_size)


def test_the_loop_judges_a_campaign_by_limits_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """The form's limit is that of the share that the campaign has, not the one in the file."""
    measured, _ = case(0.001, 0.004, 0.002, 1)
    problem = SimpleNamespace(measured=measured, split=SPLIT)
    asked: list[Thresholds] = []

    def attributed(start: Any, hypotheses: Any, limits: Thresholds, **rest: Any) -> None:
        asked.append(limits)
        raise InterruptedError

    for name, found in {
        "make_problem": problem,
        "calibrate": SimpleNamespace(problem=problem),
        "some_candidates": (),
    }.items():
        monkeypatch.setattr(loop, name, lambda *given, found=found, **more: found)
    monkeypatch.setattr(loop, "provenance_of", lambda *given: None)
    monkeypatch.setattr(searches, "attribute", attributed)
    nothing: Any = None
    with pytest.raises(InterruptedError):
        loop.reconcile(nothing, nothing, thresholds=Thresholds(0.1, 0.1, 0.1, 9.0, 5.0, "a test", 0.004, 14.0))
    share = noise_share(measured, SPLIT.train)
    assert share.noise < 0.3
    assert asked[0].evidence_nats == pytest.approx(14.0 * (1 - share.noise) ** 0.5)
