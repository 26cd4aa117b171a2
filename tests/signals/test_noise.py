"""Coloured noise has the spectrum asked for, by an independent estimate."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import welch

from vgvt.signals import coloured_noise, interpolated_density, power_spectral_density

KNOWN_HZ, DENSITY = (5.0, 10.0, 40.0, 200.0), (700e-6, 350e-6, 100e-6, 40e-6)


def test_density_is_a_power_law_between_points_and_flat_outside() -> None:
    f = np.array([0.0, 1.0, 5.0, np.sqrt(50.0), 10.0, 200.0, 900.0])
    expected = np.array([700e-6, 700e-6, 700e-6, np.sqrt(700e-6 * 350e-6), 350e-6, 40e-6, 40e-6])
    np.testing.assert_allclose(interpolated_density(f, KNOWN_HZ, DENSITY), expected, rtol=1e-12)


def test_welch_finds_the_density_that_was_asked_for() -> None:
    noise = coloured_noise(np.random.default_rng(7), 400_000, 1000.0, KNOWN_HZ, DENSITY)
    f, power = welch(noise, 1000.0, nperseg=2000)
    inside = (f >= 2) & (f <= 490)
    relative = power[inside] / interpolated_density(f[inside], KNOWN_HZ, DENSITY) ** 2
    # About 380 effective averages: each line scatters by 5 %, their mean by far less.
    assert abs(relative.mean() - 1) < 0.01
    assert np.abs(relative - 1).max() < 5 / np.sqrt(380)


@pytest.mark.parametrize("samples", [4096, 4097, 12001])
def test_variance_is_the_integral_of_the_density(samples: int) -> None:
    generator = np.random.default_rng(11)
    rows = np.array([coloured_noise(generator, samples, 500.0, [1.0], [0.2]) for _ in range(60)])
    assert rows.shape == (60, samples)
    # White: 0.2^2 * 250 Hz; 60 * 4096 values scatter by sqrt(2 / 245760) = 0.3 %.
    assert rows.var() == pytest.approx(0.2**2 * 250.0, rel=0.015)


def test_the_end_does_not_know_the_start() -> None:
    generator = np.random.default_rng(3)
    rows = np.array([coloured_noise(generator, 200, 100.0, [2.0, 20.0], [10.0, 0.1]) for _ in range(10_000)])
    f = np.arange(1, 50_000) * 1e-3
    power = interpolated_density(f, [2.0, 20.0], [10.0, 0.1]) ** 2
    for other in (1, 20, 100, 199):
        expected = (power * np.cos(2 * np.pi * f * other / 100.0)).sum() / power.sum()
        # 10000 pairs: a correlation scatters by 1 %. Noise that wraps around would correlate at 199 as at 1.
        assert np.corrcoef(rows[:, 0], rows[:, other])[0, 1] == pytest.approx(expected, abs=0.06)


def test_same_stream_same_noise() -> None:
    first, second = (coloured_noise(np.random.default_rng(5), 1000, 100.0, [1.0], [1.0]) for _ in range(2))
    np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize(("f", "d"), [([1.0, 1.0], [1.0, 1.0]), ([1.0], [0.0]), ([1.0, 2.0], [1.0]), ([0.0], [1.0])])
def test_a_density_that_is_no_function_is_refused(f: list[float], d: list[float]) -> None:
    with pytest.raises(ValueError, match="frequencies"):
        interpolated_density([1.0], f, d)


def test_power_spectral_density_agrees_with_scipy_and_with_parseval() -> None:
    signal = np.random.default_rng(2).standard_normal(10_000) + 5.0
    f, density = power_spectral_density(signal, 100.0, 2.0)
    known_f, known = welch(signal - signal.mean(), 100.0, nperseg=200, detrend=False)
    np.testing.assert_allclose(f, known_f)
    np.testing.assert_allclose(density, known, rtol=1e-10)
    assert density.sum() * (f[1] - f[0]) == pytest.approx(signal.var(), rel=0.02)
