"""The Cramér-Rao bound of an example obeys its laws and meets the formula for one mode alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.identification.bound import cramer_rao_bound
from vgvt.identification.example import Example

ONE = Example(frequency_hz=(15.0,), damping_ratio=(0.01,), stations=2, noise_m_s2=0.1)


def test_one_mode_alone_meets_the_textbook_formula() -> None:
    """std(f) = sqrt(2 s / (E sum |H|^2 / G)) / 2 pi for a chirp of energy density E, s = zeta omega."""
    swept = (ONE.band_hz[1] + 1) - (ONE.band_hz[0] - 1)
    energy = ONE.force_n**2 * ONE.sweep_s / (4 * swept)
    peak = np.abs(ONE.accelerance(np.array([15.0])))
    density = 2 * ONE.noise_m_s2**2 / ONE.sample_rate_hz
    # Whole-record energy density counts one side; so does the noise density.
    decay = 0.01 * 2 * np.pi * 15.0
    formula = np.sqrt(2 * decay / (energy * (peak**2).sum() / density)) / (2 * np.pi)
    std_hz, std_ratio = cramer_rao_bound(ONE)
    # A chirp's force density ripples by a few per cent around its mean.
    np.testing.assert_allclose(std_hz[0], formula, rtol=0.1)
    np.testing.assert_allclose(std_ratio[0] / 0.01, 2 * np.pi * std_hz[0] / decay, rtol=0.1)


def test_the_bound_goes_with_the_noise_and_falls_with_sensors() -> None:
    quiet, loud = cramer_rao_bound(ONE), cramer_rao_bound(replace(ONE, noise_m_s2=0.3))
    np.testing.assert_allclose(np.array(loud), 3 * np.array(quiet), rtol=1e-6)
    assert cramer_rao_bound(replace(ONE, stations=4))[0][0] < quiet[0][0]


def test_a_neighbour_makes_both_modes_harder_to_know() -> None:
    pair = replace(ONE, frequency_hz=(15.0, 15.1), damping_ratio=(0.01, 0.01))
    assert (cramer_rao_bound(pair)[0] > 1.2 * cramer_rao_bound(ONE)[0][0]).all()


def test_an_example_without_noise_has_no_bound() -> None:
    with pytest.raises(ValueError, match="noise"):
        cramer_rao_bound(Example())
    with pytest.raises(ValueError, match="force"):
        cramer_rao_bound(Example(noise_m_s2=0.1, force_noise_n=0.1))
