"""The recommended method on campaigns with known answers: close pairs, light damping, cut records, several runs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Outcome, modal_assurance
from vgvt.identification import run_identifier
from vgvt.identification.example import Example
from vgvt_identifiers import campaign_fit
from vgvt_identifiers.auto import Auto
from vgvt_identifiers.campaign_fit import searched_fit
from vgvt_identifiers.likelihood_claim import likelihood_claim
from vgvt_identifiers.maximum_likelihood import MaximumLikelihood
from vgvt_identifiers.pole_verdict import VerdictRules
from vgvt_identifiers.spectra import campaign_spectra
from vgvt_identifiers.vector_fitting import VectorFitting

METHODS = (Auto(), MaximumLikelihood())
QUIET = Example(stations=2, noise_m_s2=0.05)


@pytest.mark.parametrize("method", METHODS, ids=lambda m: m.name)
def test_a_pair_closer_than_its_width_is_two_modes(method: Auto | MaximumLikelihood) -> None:
    """0.6 % apart, each 2 % wide: one peak to the eye."""
    example = replace(QUIET, frequency_hz=(6.3, 15.0, 15.09, 26.9), damping_ratio=(0.01,) * 4)
    model = run_identifier(method, example.campaign())
    np.testing.assert_allclose(model.natural_frequency_hz, example.frequency_hz, rtol=1e-3)
    assert (np.diag(modal_assurance(model.shapes, example.modes().at(model.dofs).shapes)) > 0.98).all()


@pytest.mark.parametrize("method", METHODS, ids=lambda m: m.name)
def test_a_line_of_half_a_tenth_of_a_per_cent_rings_past_the_end_of_the_record(
    method: Auto | MaximumLikelihood,
) -> None:
    example = replace(QUIET, frequency_hz=(6.3, 13.7, 26.9), damping_ratio=(0.012, 0.0005, 0.007))
    model = run_identifier(method, example.campaign())
    np.testing.assert_allclose(model.natural_frequency_hz, example.frequency_hz, rtol=1e-4)
    np.testing.assert_allclose(model.damping_ratio, example.damping_ratio, rtol=0.05)


def test_a_record_that_ends_in_the_middle_of_the_sweep_is_no_worse_than_its_noise() -> None:
    example = replace(QUIET, frequency_hz=(6.3, 13.7, 26.9, 37.5), damping_ratio=(0.012, 0.009, 0.007, 0.01))
    campaign = example.campaign()
    last = round(19.0 * example.sample_rate_hz)  # the sweep passes 38.3 Hz: the last mode still rings
    cut = replace(campaign, runs=tuple(replace(r, samples=r.samples[:, :last]) for r in campaign.runs))
    model = run_identifier(Auto(), cut)
    np.testing.assert_allclose(model.natural_frequency_hz, example.frequency_hz, rtol=1e-3)
    np.testing.assert_allclose(model.damping_ratio, example.damping_ratio, rtol=0.03)


def test_common_poles_and_poles_of_runs_agree_when_nothing_moves() -> None:
    campaign = Example(stations=2, noise_m_s2=0.2).campaign()
    own, common = (run_identifier(MaximumLikelihood(poles=p), campaign) for p in ("per-run", "common"))
    assert own.natural_frequency_std_hz is not None
    gap = np.abs(own.natural_frequency_hz - common.natural_frequency_hz)
    assert (gap < own.natural_frequency_std_hz).all()
    assert all("seen_in=2/2" in flags for flags in own.flags)


@pytest.mark.parametrize("method", [Auto(poles="common"), MaximumLikelihood(poles="common")], ids=lambda m: m.name)
def test_common_poles_keep_the_terms_that_a_mode_below_the_band_asks_for(method: Auto | MaximumLikelihood) -> None:
    """A mode at 1.2 Hz under a band from 4 Hz and little noise: with fewer terms the last mode is 7 deviations off."""
    example = Example(
        (1.2, 6.3, 13.7, 20.9), (0.03, 0.012, 0.009, 0.007), stations=2, noise_m_s2=0.002, sample_rate_hz=128.0,
        band_hz=(1.0, 30.0),
    )  # fmt: skip
    model, true = run_identifier(method, example.campaign(), (4.0, 30.0)), example.modes().band(4.0, 30.0)
    assert len(model) == len(true)
    assert model.natural_frequency_std_hz is not None and model.damping_ratio_std is not None
    assert (np.abs(model.natural_frequency_hz - true.natural_frequency_hz) < 4 * model.natural_frequency_std_hz).all()
    assert (np.abs(model.damping_ratio - true.damping_ratio) < 4 * model.damping_ratio_std).all()


def test_every_pole_has_a_fate_and_a_reason() -> None:
    model = run_identifier(Auto(), Example(stations=2, noise_m_s2=0.2).campaign())
    assert sum(c.kept for c in model.candidates) >= len(model)
    assert all(c.reason for c in model.candidates)


def test_force_noise_makes_deviations_larger_and_leaves_the_answer() -> None:
    quiet = run_identifier(Auto(), Example(stations=2, noise_m_s2=0.05).campaign())
    example = Example(stations=2, noise_m_s2=0.05, force_noise_n=0.05)
    loud = run_identifier(Auto(), example.campaign())
    assert quiet.natural_frequency_std_hz is not None and loud.natural_frequency_std_hz is not None
    assert (loud.natural_frequency_std_hz > 2 * quiet.natural_frequency_std_hz).all()
    error = loud.natural_frequency_hz - np.array(example.frequency_hz)
    assert (np.abs(error) < 4 * loud.natural_frequency_std_hz).all()


def test_vector_fitting_finds_the_modes_with_deviations() -> None:
    example = Example(stations=2, noise_m_s2=0.2)
    model = run_identifier(VectorFitting(largest_order=8), example.campaign())
    np.testing.assert_allclose(model.natural_frequency_hz, example.frequency_hz, rtol=1e-3)
    np.testing.assert_allclose(model.damping_ratio, example.damping_ratio, rtol=0.05)
    assert model.natural_frequency_std_hz is not None and (model.natural_frequency_std_hz > 0).all()


@pytest.mark.parametrize("method", [*METHODS, VectorFitting()], ids=lambda m: m.name)
def test_pure_noise_has_no_modes(method: Auto | MaximumLikelihood | VectorFitting) -> None:
    campaign = Example(stations=2).campaign()
    generator = np.random.default_rng(3)
    noise = tuple(
        replace(r, samples=np.vstack([r.samples[:1], generator.standard_normal(r.samples[1:].shape)]))
        for r in campaign.runs
    )
    model = run_identifier(method, replace(campaign, runs=noise))
    assert len(model) == 0 and model.outcome is Outcome.NOTHING_FOUND


@pytest.mark.parametrize(
    ("cls", "setting"),
    [(Auto, {"false_alarm": 0.0}), (MaximumLikelihood, {"largest_poles": 0}), (VectorFitting, {"order_step": 0})],
)
def test_settings_out_of_range_are_refused(cls: type, setting: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(setting))):
        cls(**setting)


def test_what_the_runs_together_put_outside_the_band_is_not_claimed() -> None:
    """As a pole that no run knows by itself can be: `auto` had claimed a mode outside its band, which is refused."""
    campaign, band_hz = QUIET.campaign(), QUIET.campaign().band_hz
    spectra = campaign_spectra(campaign, band_hz)
    fit = searched_fit(spectra, np.empty(0, complex), band_hz, VerdictRules())
    whole = likelihood_claim(spectra, fit, "per-run", (), band_hz)
    assert len(whole) > 1
    lowest, *others = whole.natural_frequency_hz
    fewer = likelihood_claim(spectra, fit, "per-run", (), (lowest + 0.1, band_hz[1]))
    np.testing.assert_array_equal(fewer.natural_frequency_hz, others)
    assert fewer.candidates == whole.candidates
    none = likelihood_claim(spectra, fit, "per-run", (), (band_hz[1] - 0.1, band_hz[1]))
    assert len(none) == 0 and none.outcome is Outcome.NOTHING_FOUND and none.advice


def test_a_pole_that_a_neighbour_makes_up_for_is_told_with_its_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    told = (complex(-1.0, 80.0), "a neighbour makes up for it: one mode")
    monkeypatch.setattr(campaign_fit, "without_doubles", lambda problems, states, needed: (states, (told,)))
    claim = run_identifier(Auto(), QUIET.campaign())
    reasons = [c.reason for c in claim.candidates if not c.kept]
    assert told[1] in reasons
