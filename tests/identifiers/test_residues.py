"""Residues for known poles: exact without noise, unbiased and honestly uncertain with it."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import Direction, Dof
from vgvt_identifiers.residues import fit_residues
from vgvt_identifiers.spectra import RunSpectra

FREQUENCY = np.arange(3.0, 30.0, 1 / 20)
S = 2j * np.pi * FREQUENCY


def poles_of(frequency_hz: list[float], damping: float) -> np.ndarray:
    omega = 2 * np.pi * np.array(frequency_hz)
    return np.asarray(omega * (-damping + 1j * np.sqrt(1 - damping**2)))


def modal_sum(poles: np.ndarray, residues: np.ndarray) -> np.ndarray:
    """Receptances (R, K) of residues (R, M), both poles of every pair."""
    return np.asarray(
        (residues[:, :, None] / (S - poles[:, None]) + residues.conj()[:, :, None] / (S - poles.conj()[:, None])).sum(1)
    )


def chirp_spectrum() -> np.ndarray:
    """Force over the band: of even size, with the phase of a sweep."""
    return np.asarray(10.0 * np.exp(-1j * np.pi * (FREQUENCY - 3.0) ** 2 * 20 / 27))


def run_of(accelerance: np.ndarray, force: np.ndarray, variance: np.ndarray) -> RunSpectra:
    dofs = tuple(Dof(n + 1, Direction.PLUS_Z) for n in range(accelerance.shape[0]))
    drive = Dof(9, Direction.PLUS_Z)
    return RunSpectra(1, drive, dofs, force, accelerance, variance, accelerance, variance)


POLES = poles_of([7.0, 12.0, 12.3, 24.0], 0.01)
RESIDUES = np.array([[0.9, -0.4, 0.7, 0.2], [0.3 + 0.1j, 0.5, -0.6, 0.4]]) / (2j * POLES.imag)


def test_residues_come_back_with_modes_outside_the_band_and_a_ring_that_was_cut() -> None:
    rigid = 0.3 / S**2
    far = modal_sum(poles_of([260.0], 0.01), np.array([[0.4], [-0.2]]) / (2j * 2 * np.pi * 260))
    force = chirp_spectrum()
    ring = 30 * modal_sum(POLES, np.array([[1.0, 0.3, -0.5, 2.0], [0.4, 1.0, 0.3, 0.1j]]))
    values = S**2 * (modal_sum(POLES, RESIDUES) + rigid + far) + ring / force
    fit = fit_residues(run_of(values, force, np.full(values.shape, 1e-8)), FREQUENCY, POLES)
    np.testing.assert_allclose(fit.residues, RESIDUES, rtol=2e-5)
    np.testing.assert_allclose(fit.transient, ring / force, atol=1e-4 * np.abs(ring / force).max())
    blind = fit_residues(run_of(values, force, np.full(values.shape, 1e-8)), FREQUENCY, POLES, transient=False)
    assert np.abs(blind.residues / RESIDUES - 1).max() > 1e-3


def test_standard_deviations_are_those_of_repeated_noise() -> None:
    generator = np.random.default_rng(4)
    force, clean = chirp_spectrum(), S**2 * modal_sum(POLES, RESIDUES)
    level = np.linspace(0.05, 0.2, FREQUENCY.size)
    variance = np.broadcast_to(level**2, clean.shape)
    found, stated = [], []
    for _ in range(100):
        noise = generator.standard_normal((2, *clean.shape)) * level / np.sqrt(2)
        fit = fit_residues(run_of(clean + noise[0] + 1j * noise[1], force, variance), FREQUENCY, POLES)
        found.append(fit.residues)
        stated.append(fit.std)
    scatter = np.sqrt((np.abs(np.array(found) - RESIDUES) ** 2).mean(axis=0))
    # 100 repeats of a complex number: the scatter itself is known within 7 % (one standard deviation).
    np.testing.assert_allclose(np.mean(stated, axis=0) / scatter, 1.0, atol=0.25)


def test_noise_of_too_small_a_stated_variance_enlarges_the_standard_deviation() -> None:
    generator = np.random.default_rng(5)
    clean = S**2 * modal_sum(POLES, RESIDUES)
    noise = 0.1 * (generator.standard_normal(clean.shape) + 1j * generator.standard_normal(clean.shape))
    honest = fit_residues(run_of(clean + noise, chirp_spectrum(), np.full(clean.shape, 0.02)), FREQUENCY, POLES)
    proud = fit_residues(run_of(clean + noise, chirp_spectrum(), np.full(clean.shape, 0.0002)), FREQUENCY, POLES)
    np.testing.assert_allclose(proud.chi_square, 100 * honest.chi_square, rtol=1e-6)
    np.testing.assert_allclose(
        proud.std,
        honest.std * np.sqrt(np.maximum(honest.chi_square, 1) ** -1)[:, None] * np.sqrt(honest.chi_square)[:, None],
        rtol=1e-6,
    )


def test_lines_without_force_are_left_out() -> None:
    force, values = chirp_spectrum(), S**2 * modal_sum(POLES, RESIDUES)
    force[100:110], values[:, 100:110] = 0.0, 0.0
    fit = fit_residues(run_of(values, force, np.full(values.shape, 1e-8)), FREQUENCY, POLES)
    np.testing.assert_allclose(fit.residues, RESIDUES, rtol=1e-6)
    assert not fit.errors[:, 100:110].any()


def test_too_few_lines_are_refused() -> None:
    short = slice(0, 8)
    run = run_of(np.ones((1, 8), complex), chirp_spectrum()[short], np.ones((1, 8)))
    with pytest.raises(ValueError, match="cannot hold"):
        fit_residues(run, FREQUENCY[short], POLES)
