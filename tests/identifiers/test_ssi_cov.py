"""Covariance-driven subspace identification on systems whose modes are known in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from vgvt.data import Campaign, Channel, ChannelRole, Dof, Outcome, Quantity, modal_assurance
from vgvt.identification import run_identifier
from vgvt.identification.example import Example
from vgvt_identifiers.cfdd_output_only import CfddOutputOnly
from vgvt_identifiers.covariance_subspace import BlockCovariances, poles_at, realise
from vgvt_identifiers.ssi_cov import SsiCov

PLATE = Example(noise_m_s2=0.05)


def test_exact_covariances_give_exact_poles() -> None:
    """R_k = C A^(k-1) G of a two-mode system in state space, an oracle without any record."""
    omega, damping, step_s = np.array([40.0, 90.0]), np.array([0.01, 0.02]), 0.01
    blocks = [np.array([[0, 1], [-(w**2), -2 * z * w]]) for w, z in zip(omega, damping, strict=True)]
    state = np.zeros((4, 4))
    state[:2, :2], state[2:, 2:] = blocks
    step = expm(state * step_s)
    generator = np.random.default_rng(1)
    out, gain = generator.standard_normal((5, 4)), generator.standard_normal((4, 3))
    powers = [np.linalg.matrix_power(step, k) for k in range(39)]
    covariances = np.array([out @ p @ gain for p in powers])
    found = poles_at(realise(BlockCovariances(covariances, covariances[None]), step_s, 4), 4)
    order = np.argsort(found.poles_rad_s.imag)
    exact = omega * (-damping + 1j * np.sqrt(1 - damping**2))
    np.testing.assert_allclose(found.poles_rad_s[order], exact, rtol=1e-7)


def test_modes_under_steady_forces_are_found_with_their_shapes() -> None:
    model = run_identifier(SsiCov(), PLATE.ambient_campaign())
    np.testing.assert_allclose(model.natural_frequency_hz, PLATE.frequency_hz, rtol=1e-2)
    np.testing.assert_allclose(model.damping_ratio, PLATE.damping_ratio, rtol=0.5)
    assert np.diag(modal_assurance(model.shapes, PLATE.modes().shapes)).min() > 0.99
    assert any(c.kept for c in model.candidates)


@pytest.mark.slow
def test_stated_standard_deviations_match_the_scatter() -> None:
    """Over 16 seeds; runs in which a mode is doubted and left out are few."""
    ratios, complete = [], 0
    for seed in range(16):
        example = replace(PLATE, seed=seed)
        model = run_identifier(SsiCov(), example.ambient_campaign())
        if len(model) != 3:
            continue
        complete += 1
        assert model.natural_frequency_std_hz is not None
        assert model.damping_ratio_std is not None
        error = model.natural_frequency_hz - np.array(example.frequency_hz)
        damping = model.damping_ratio - np.array(example.damping_ratio)
        ratios.append([error / model.natural_frequency_std_hz, damping / model.damping_ratio_std])
    assert complete >= 13
    spread = np.sqrt((np.array(ratios) ** 2).mean(axis=(0, 2)))
    assert np.all((spread > 0.6) & (spread < 1.5)), spread


def test_roving_runs_without_overlap_are_declined_with_advice() -> None:
    model = run_identifier(SsiCov(), PLATE.campaign())
    assert model.outcome is Outcome.DECLINED
    assert any("measure all sensors at once" in text for text in model.advice)


def test_a_short_record_is_declined_with_a_reason() -> None:
    model = run_identifier(SsiCov(), PLATE.ambient_campaign(4.0))
    assert model.outcome is Outcome.NOTHING_FOUND
    assert any("too short" in text for text in model.advice)


def with_force(campaign: Campaign) -> Campaign:
    """The same records with a force channel beside them."""
    (record,) = campaign.runs
    force = Channel("force", Quantity.EXCITATION_FORCE, ChannelRole.REFERENCE, Dof.from_label("1+Z"))
    noise = np.random.default_rng(5).standard_normal((1, record.samples.shape[1]))
    samples = np.concatenate([record.samples, noise])
    return replace(campaign, runs=(replace(record, channels=(*record.channels, force), samples=samples),))


@pytest.mark.parametrize("identifier", [SsiCov(), CfddOutputOnly()], ids=lambda i: i.name)
def test_a_force_that_is_not_used_is_advised(identifier: SsiCov | CfddOutputOnly) -> None:
    """And the claim says that it was made without, as what its modes are depends on it."""
    alone, beside = (
        run_identifier(identifier, c) for c in (PLATE.ambient_campaign(), with_force(PLATE.ambient_campaign()))
    )
    assert not any("the force is not used" in text for text in alone.advice)
    assert sum("combined resonances of shaker and aircraft" in text for text in beside.advice) == 1
    assert alone.output_only
    assert beside.output_only
    np.testing.assert_allclose(beside.natural_frequency_hz, alone.natural_frequency_hz, rtol=1e-12)
