"""Thresholds from placebos: they hold for the next one as often as they say, and survive their file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.reconcile.placebo import Placebo, best_nats, calibrated_thresholds, own_thresholds, write_thresholds
from vgvt.reconcile.question.thresholds import LIMITS, PLACEBO_FLOOR, stored_thresholds, thresholds_of


def drawn(count: int, seed: int) -> list[Placebo]:
    """Placebos whose figures are normal."""
    g = np.random.default_rng(seed)
    rows = np.array([0.6, 0.6, 0.7, 0.0]) + np.array([0.03, 0.05, 0.08, 2.0]) * g.standard_normal((count, 4))
    return [Placebo(*(float(v) for v in row)) for row in rows]


@pytest.mark.parametrize("count", [5, 12, 60])
def test_the_next_placebo_stays_below_as_often_as_stated(count: int) -> None:
    trials = 400
    beyond = sum(
        drawn(1, 10_000 + k)[0].chi2_per_dof > calibrated_thresholds(drawn(count, k), "a test", level=0.9).chi2_per_dof
        for k in range(trials)
    )
    # Never below the largest seen: the limit may be safer than stated, four binomial deviations less safe.
    assert beyond / trials < 0.1 + 4 * np.sqrt(0.1 * 0.9 / trials)


def test_few_placebos_give_wider_limits_than_many_and_too_few_none() -> None:
    few = np.mean([calibrated_thresholds(drawn(5, k), "a test").evidence_nats for k in range(100)])
    many = np.mean([calibrated_thresholds(drawn(80, k), "a test").evidence_nats for k in range(100)])
    assert few > many
    with pytest.raises(InputError, match="too few"):
        calibrated_thresholds(drawn(4, 0), "a test")


def test_thresholds_survive_their_file_with_their_provenance(tmp_path: Path) -> None:
    made = calibrated_thresholds(drawn(20, 3), 'quick, 1 % noise, "version 1"')
    write_thresholds(tmp_path / "thresholds.toml", made)
    again = thresholds_of(tmp_path / "thresholds.toml")
    assert again.chi2_per_dof == pytest.approx(made.chi2_per_dof, rel=1e-3)
    assert again.evidence_form_nats == pytest.approx(made.evidence_form_nats, rel=1e-3) != 0
    assert again.provenance.startswith("20 campaigns without any missing effect")


def test_fits_that_end_far_below_nothing_do_not_raise_what_a_name_needs() -> None:
    seen = drawn(40, 5)
    lost = [replace(p, best_nats=p.best_nats - 100.0 * (p.best_nats < -1.0)) for p in seen]
    assert sum(p.best_nats < -50 for p in lost) > 5
    usual, odd = (calibrated_thresholds(p, "a test").evidence_nats for p in (seen, lost))
    assert odd == pytest.approx(usual, rel=1e-9)


def test_what_held_out_data_refused_would_not_have_become_a_name() -> None:
    strong, weak, drifting = (
        SimpleNamespace(gain_nats=g, lasting_nats=n) for g, n in ((18.0, 17.0), (5.0, 8.0), (30.0, 3.0))
    )
    rivals: Any = (strong, weak, drifting)
    refused: Any = (strong,)
    assert best_nats(rivals, ()) == 17.0
    assert best_nats(rivals, refused) == 5.0
    assert best_nats((), ()) == 0.0


def test_gains_of_nothing_have_a_limit_for_noise_and_one_for_the_models_form() -> None:
    """Where the form is most of it placebos gain more: campaigns of noise are not judged by these."""
    g = np.random.default_rng(8)
    noisy = [replace(p, noise_per_dof=0.55, best_nats=float(2 * g.standard_normal())) for p in drawn(60, 1)]
    formed = [replace(p, noise_per_dof=0.19, best_nats=float(5 * g.standard_normal())) for p in drawn(60, 2)]
    both = calibrated_thresholds([*noisy, *formed], "a test")
    assert both.evidence_nats == pytest.approx(calibrated_thresholds(noisy, "a test").evidence_nats)
    assert both.evidence_form_nats * 0.9 == pytest.approx(calibrated_thresholds(formed, "a test").evidence_nats)
    assert both.evidence_form_nats > 2 * both.evidence_nats
    assert calibrated_thresholds(noisy, "a test").evidence_form_nats == 0.0


def test_strains_have_a_limit_for_noise_and_one_for_the_models_form() -> None:
    """Where placebos noted them; the stated ones else."""
    g = np.random.default_rng(9)
    noisy = [replace(p, noise_per_dof=0.55, strain_sd=float(g.standard_normal())) for p in drawn(60, 1)]
    formed = [replace(p, noise_per_dof=0.19, strain_sd=float(3 * g.standard_normal())) for p in drawn(60, 2)]
    both = calibrated_thresholds([*noisy, *formed], "a test")
    assert both.strain_sd >= max(p.strain_sd or 0.0 for p in noisy)
    assert both.strain_form_sd * 0.9 >= max(p.strain_sd or 0.0 for p in formed) * (1 - 1e-12)
    unnoted = calibrated_thresholds(drawn(60, 1), "a test")
    assert (unnoted.strain_sd, unnoted.strain_form_sd) == (4.0, 0.0)


def like(stored: Any, count: int, share: float, noise: float = 0.3, nats: float = 0.0) -> list[Placebo]:
    """Placebos that all leave a share of what those that are shipped leave beyond their noise."""
    left = [
        noise + (1 - noise) * share * v for v in (stored.chi2_per_dof, stored.smooth_per_dof, stored.held_out_per_dof)
    ]
    return [Placebo(*left, nats, noise, noise, PLACEBO_FLOOR, 1.0)] * count


def test_few_placebos_of_ones_own_lower_no_limit_and_raise_it_at_once() -> None:
    """All of 20 leave half of what those that are shipped leave, or twice as much, and gain nothing, or 30 nats."""
    stored = stored_thresholds()
    half, twice = (own_thresholds(like(stored, 20, s, nats=n), "a test") for s, n in ((0.5, 0.0), (2.0, 30.0)))
    for name in LIMITS:
        assert getattr(half, name) == pytest.approx(getattr(stored, name))
    assert twice.chi2_per_dof == pytest.approx(2 * stored.chi2_per_dof)
    assert twice.smooth_per_dof == pytest.approx(2 * stored.smooth_per_dof)
    assert twice.held_out_per_dof == pytest.approx(2 * stored.held_out_per_dof)
    assert max(twice.evidence_nats, twice.evidence_form_nats) >= 30.0
    assert "none below" in half.provenance
    with pytest.raises(InputError, match="too few"):
        own_thresholds(like(stored, 4, 1.0), "a test")


def test_a_hundred_placebos_of_ones_own_lower_limits() -> None:
    stored = stored_thresholds()
    half = own_thresholds(like(stored, 100, 0.5), "a test")
    assert half.chi2_per_dof == pytest.approx(0.5 * stored.chi2_per_dof)
    assert half.evidence_nats == 1.0
    assert "none below" not in half.provenance


def test_where_noise_hides_what_is_left_its_limits_are_those_that_are_shipped() -> None:
    stored = stored_thresholds()
    hidden = own_thresholds(like(stored, 100, 0.5, noise=0.9, nats=3.0), "a test")
    assert hidden.chi2_per_dof == pytest.approx(stored.chi2_per_dof)
    assert hidden.held_out_per_dof == pytest.approx(stored.held_out_per_dof)
    assert hidden.evidence_nats == pytest.approx(3.0)
    twice = replace(stored, model_form=2 * stored.model_form)
    scaled = calibrated_thresholds(like(stored, 20, 0.5, noise=0.9), "a test", where_hidden=twice)
    assert scaled.chi2_per_dof == pytest.approx(4 * stored.chi2_per_dof)
