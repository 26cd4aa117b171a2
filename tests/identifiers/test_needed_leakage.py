"""Leakage is fitted where a record is cut while a mode rings, and nowhere else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import modal_assurance
from vgvt.identification import run_identifier
from vgvt.identification.example import Example
from vgvt_identifiers.needed_leakage import blocks_that_leak
from vgvt_identifiers.plscf import Plscf
from vgvt_identifiers.quadrature import Quadrature
from vgvt_identifiers.rational_fit import Block, fit_rational

CUT = Example(
    frequency_hz=(6.3, 13.7, 37.0),
    damping_ratio=(0.012, 0.009, 0.002),
    noise_m_s2=0.2,
    duration_s=19.5,
    sweep_s=19.0,
)


@pytest.mark.parametrize(
    "method", [Quadrature(), Plscf(), Plscf(poles="common")], ids=["quadrature", "plscf", "common"]
)
@pytest.mark.parametrize("seed", range(4))
def test_a_mode_swept_early_in_the_record_keeps_its_shape(method: Quadrature | Plscf, seed: int) -> None:
    """The sweep is at 4 Hz within its first second, so that 1/F hardly turns across the mode."""
    example = Example(frequency_hz=(4.0, 13.7, 26.9), noise_m_s2=0.5, seed=seed)
    model, truth = run_identifier(method, example.campaign()), example.modes()
    assert len(model) == 3
    np.testing.assert_allclose(model.natural_frequency_hz, truth.natural_frequency_hz, rtol=1e-3)
    assert np.diag(modal_assurance(model.shapes, truth.shapes)).min() > 0.99


@pytest.mark.parametrize("method", [Quadrature(), Plscf()], ids=lambda m: m.name)
@pytest.mark.parametrize("seed", range(4))
def test_a_record_cut_while_a_mode_rings(method: Quadrature | Plscf, seed: int) -> None:
    example = replace(CUT, seed=seed)
    model, truth = run_identifier(method, example.campaign()), example.modes()
    np.testing.assert_allclose(model.natural_frequency_hz, truth.natural_frequency_hz, rtol=3e-4)
    np.testing.assert_allclose(model.damping_ratio[-1], truth.damping_ratio[-1], rtol=0.01)
    assert np.diag(modal_assurance(model.shapes, truth.shapes)).min() > 0.998


def test_a_block_leaks_where_its_record_was_cut() -> None:
    """Two rows of one mode in noise: one with what a record cut while it rings leaves over, one without."""
    frequency = np.linspace(9.0, 11.0, 120)
    pole = 2 * np.pi * 10.0 * (-0.01 + 1j)
    generator = np.random.default_rng(1)
    force = np.exp(-0.5j * frequency**2)
    response = np.array([[1.0 + 0.2j], [-0.6 + 0.1j]]) / (2j * np.pi * frequency - pole)
    noise = 0.01 * (generator.standard_normal((2, 2, 120)) + 1j * generator.standard_normal((2, 2, 120)))
    ring = np.array([[0.5], [0.8j]]) / (2j * np.pi * frequency - pole) / force
    ones = np.ones(120)
    blocks = tuple(Block(v, ones, np.ones(2), 1 / force) for v in (response + noise[0], response + ring + noise[1]))
    fit = fit_rational(frequency, blocks, np.array([pole]))
    assert blocks_that_leak(frequency, blocks, fit, 4).tolist() == [False, True]
    assert not blocks_that_leak(frequency, (Block(response, ones, np.ones(2)),), fit, 4).any()
