"""The rational fit finds the rational functions that made the data, and says how well it knows them."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt_identifiers.rational_fit import Block, fit_rational
from vgvt_identifiers.rational_problem import RationalProblem


def poles_of(frequency_hz: np.ndarray, damping: np.ndarray) -> np.ndarray:
    """Upper poles, rad/s."""
    omega = 2 * np.pi * frequency_hz
    return np.asarray(-damping * omega + 1j * omega * np.sqrt(1 - damping**2))


def accelerance(frequency_hz: np.ndarray, poles: np.ndarray, residues: np.ndarray) -> np.ndarray:
    """Two-sided modal sum (R, K) of accelerances; residues (R, N)."""
    s = 2j * np.pi * frequency_hz
    terms = residues[:, :, None] / (s - poles[:, None]) + residues.conj()[:, :, None] / (s - poles.conj()[:, None])
    return np.asarray(s**2 * terms.sum(axis=1))


def residues_of(generator: np.random.Generator, rows: int, poles: np.ndarray) -> np.ndarray:
    """Residues (rows, N) of real modes, none of them small."""
    size = generator.uniform(0.3, 1.0, (rows, poles.size)) * generator.choice([-1.0, 1.0], (rows, poles.size))
    return np.asarray(size / (2j * poles.imag))


def block(values: np.ndarray, leakage: np.ndarray | None = None) -> Block:
    return Block(values, np.ones(values.shape[1]), np.ones(values.shape[0]), leakage)


def test_a_window_around_one_of_many_modes_gives_its_pole_and_residues() -> None:
    poles = poles_of(np.array([6.0, 15.0, 31.0]), np.array([0.01, 0.004, 0.01]))
    residues = residues_of(np.random.default_rng(1), 6, poles)
    frequency = np.arange(14.0, 16.0, 1 / 60)
    start = poles_of(np.array([15.07]), np.array([0.01]))
    fit = fit_rational(frequency, (block(accelerance(frequency, poles, residues)),), start)
    assert fit.converged
    assert abs(fit.poles[0] - poles[1]) < 1e-5 * abs(poles[1].real)
    # s^2 R/(s - p) has the residue p^2 R at the pole.
    np.testing.assert_allclose(fit.residues[0][:, 0], residues[:, 1] * poles[1] ** 2, rtol=1e-4)


def test_a_function_of_order_24_over_the_whole_band() -> None:
    """Twelve modes, two of them 0.15 Hz apart, in one fit with conjugate poles and rough starting values."""
    truth = np.array([4.0, 6.5, 8.2, 11.0, 13.1, 15.6, 15.75, 19.0, 22.4, 25.0, 29.3, 33.8])
    poles = poles_of(truth, np.linspace(0.004, 0.02, 12))
    residues = residues_of(np.random.default_rng(2), 20, poles)
    frequency = np.arange(3.0, 36.0, 1 / 30)
    start = poles_of(truth * (1 + 0.002 * np.cos(np.arange(12))), np.full(12, 0.01))
    data = block(accelerance(frequency, poles, residues))
    fit = fit_rational(frequency, (data,), start, background=3, mirrored=True)
    np.testing.assert_allclose(fit.poles, poles, rtol=1e-9)
    np.testing.assert_allclose(fit.fitted[0], data.values, rtol=1e-7)


def test_the_fit_can_be_read_between_the_lines() -> None:
    poles = poles_of(np.array([15.0]), np.array([0.01]))
    residues = residues_of(np.random.default_rng(3), 4, poles)
    frequency = np.arange(14.0, 16.0, 1 / 20)
    for mirrored in (False, True):
        data = block(accelerance(frequency, poles, residues))
        fit = fit_rational(frequency, (data,), poles * 1.001, mirrored=mirrored)
        expected = accelerance(np.array([15.012]), poles, residues)[:, 0]
        np.testing.assert_allclose(fit.at(15.012, 0), expected, rtol=1e-6)


def test_leakage_with_the_poles_of_the_system_is_told_from_the_response() -> None:
    """A record cut while the structure rings adds T(s) / F(s); F of a sweep turns its phase from line to line."""
    poles = poles_of(np.array([15.0]), np.array([0.0005]))
    generator = np.random.default_rng(4)
    residues = residues_of(generator, 5, poles)
    frequency = np.arange(14.0, 16.0, 1 / 60)
    inverse_force = np.exp(1j * np.pi * 1.7 * 60 / 2 * (frequency - 1) ** 2) * (1 + 0.5 * np.sin(40 * frequency))
    ringing = 0.3 * generator.standard_normal((5, 1)) / (2j * np.pi * frequency - poles[0])
    data = accelerance(frequency, poles, residues) + ringing * inverse_force
    start = poles_of(np.array([15.01]), np.array([0.001]))
    blind = fit_rational(frequency, (block(data),), start)
    seeing = fit_rational(frequency, (block(data, inverse_force),), start)
    # The conjugate pole is background: it is far away, but not exactly a cubic.
    assert abs(seeing.poles[0] - poles[0]) < 1e-4 * abs(poles[0].real)
    assert abs(blind.poles[0] - poles[0]) > 10 * abs(seeing.poles[0] - poles[0])
    np.testing.assert_allclose(seeing.residues[0][:, 0], residues[:, 0] * poles[0] ** 2, rtol=1e-3)


def test_the_stated_standard_deviation_is_the_scatter_over_seeds() -> None:
    """Calibration: over 200 seeds the errors divided by their standard deviation have unit variance."""
    poles = poles_of(np.array([15.0, 15.5]), np.array([0.01, 0.008]))
    residues = residues_of(np.random.default_rng(5), 3, poles)
    frequency = np.arange(13.5, 17.0, 1 / 60)
    clean = accelerance(frequency, poles, residues)
    ratios = []
    for seed in range(200):
        generator = np.random.default_rng([6, seed])
        noise = generator.standard_normal((2, *clean.shape))
        fit = fit_rational(frequency, (block(clean + 1.0 * (noise[0] + 1j * noise[1])),), poles, relocate=False)
        error = fit.poles - poles
        ratios.append(np.concatenate([error.real, error.imag]) / np.tile(fit.pole_std, 2))
    spread = np.sqrt((np.array(ratios) ** 2).mean(axis=0))
    assert np.all((spread > 0.8) & (spread < 1.15)), spread


def test_errors_shrink_with_the_root_of_the_number_of_responses() -> None:
    poles = poles_of(np.array([15.0]), np.array([0.01]))
    frequency = np.arange(14.0, 16.0, 1 / 60)
    rms = []
    for rows in (2, 18):
        residues = np.full((rows, 1), 1 / (2j * poles[0].imag))
        clean = accelerance(frequency, poles, residues)
        errors = []
        for seed in range(60):
            generator = np.random.default_rng([7, rows, seed])
            noise = generator.standard_normal(clean.shape) + 1j * generator.standard_normal(clean.shape)
            errors.append(
                abs(fit_rational(frequency, (block(clean + noise),), poles, relocate=False).poles[0] - poles[0])
            )
        rms.append(np.sqrt(np.mean(np.square(errors))))
    assert rms[0] / rms[1] == pytest.approx(3.0, rel=0.3)


def test_too_few_lines_are_refused() -> None:
    with pytest.raises(ValueError, match="5 lines cannot hold 8 unknowns"):
        fit_rational(np.arange(10.0, 10.5, 0.1), (block(np.ones((2, 5), complex)),), np.array([-1 + 64j]))


def test_stacked_blocks_are_worth_what_they_are_alone() -> None:
    """Blocks of one size are solved together, others beside them; each must count as if it were the only one."""
    generator = np.random.default_rng(6)
    x = np.linspace(-1.0, 1.0, 40)
    z = np.array([-0.05 + 0.2j, -0.1 - 0.4j])

    def noisy(rows: int, leaks: bool) -> Block:
        values = generator.standard_normal((rows, x.size)) + 1j * generator.standard_normal((rows, x.size))
        leakage = generator.standard_normal(x.size) + 1j if leaks else None
        return Block(values, generator.uniform(0.5, 2.0, x.size), generator.uniform(0.5, 2.0, rows), leakage)

    blocks = (noisy(2, True), noisy(2, True), noisy(3, True), noisy(3, False))
    together = RationalProblem.of(x, blocks, 3, 4.0)
    assert [s.data.shape[0] for s in together.stacks] == [2, 1, 1]
    alone = [RationalProblem.of(x, (b,), 3, 4.0) for b in blocks]
    np.testing.assert_allclose(together.cost(z), sum(p.cost(z) for p in alone), rtol=1e-12)
    cost, gram, gradient = together.normal_equations(z)
    parts = [p.normal_equations(z) for p in alone]
    np.testing.assert_allclose(cost, together.cost(z), rtol=1e-12)
    np.testing.assert_allclose(gram, sum(p[1] for p in parts), rtol=1e-10)
    np.testing.assert_allclose(gradient, sum(p[2] for p in parts), rtol=1e-10)
    # The cost falls as its gradient says: twice the real part of conj(gradient) dz.
    step = 1e-6 * np.array([1.0 + 0.5j, -0.3j])
    rise = (together.cost(z + step) - together.cost(z - step)) / 2
    np.testing.assert_allclose(rise, 2 * (gradient.conj() @ step).real, rtol=1e-4)
