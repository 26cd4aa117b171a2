"""The output-error fit: exact without noise, its slopes against differences, its deviations against theory."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt_identifiers.output_error import Responses, _normal, fit_output_error

EXPONENTS = np.array([-0.01 + 0.6j, -0.02 + 1.4j, -0.015 + 1.43j])
ANGLE = np.linspace(0.3, 2.2, 500)


def responses(seed: int, count: int = 3, noise: float = 0.0) -> Responses:
    generator = np.random.default_rng(7)
    size = (count, EXPONENTS.size)
    amplitude = generator.standard_normal(size) + 1j * generator.standard_normal(size)
    turn, roots = np.exp(1j * ANGLE), np.exp(EXPONENTS)[:, None]
    values = amplitude @ (1 / (turn - roots)) + amplitude.conj() @ (1 / (turn - roots.conj())) + 0.7
    own = np.random.default_rng(seed).standard_normal((2, *values.shape))
    noisy = values + noise * (own[0] + 1j * own[1]) / np.sqrt(2)
    weight = np.full(count, np.sqrt(2) / noise) if noise else np.ones(count)
    return Responses(noisy, weight, np.ones(ANGLE.size))


def test_it_finds_the_model_from_a_start_nearby() -> None:
    fit = fit_output_error(ANGLE[:, None], (responses(0),), EXPONENTS * (1 + 0.02j) + 0.004j, 60)
    assert np.sort_complex(fit.exponents) == pytest.approx(np.sort_complex(EXPONENTS), abs=1e-7)
    assert fit.converged


def test_means_of_neighbouring_lines_are_fitted_by_means_of_the_model() -> None:
    data = responses(0)
    together = Responses(
        data.values.reshape(3, 100, 5).mean(axis=2), data.row_weight, np.ones(100)
    )  # lines 0.004 apart, five to a mean, as wide as the narrowest mode
    fit = fit_output_error(ANGLE.reshape(100, 5), (together,), EXPONENTS * (1 + 0.02j), 60)
    assert np.sort_complex(fit.exponents) == pytest.approx(np.sort_complex(EXPONENTS), abs=1e-7)


def test_the_gradient_is_the_slope_of_the_cost() -> None:
    block, x, step = responses(1, noise=0.2), EXPONENTS * (1 + 0.01j), 1e-6
    here = _normal(ANGLE[:, None], (block,), x)
    for k in range(2 * x.size):
        move = np.zeros(x.size, complex)
        move[k % x.size] = step if k < x.size else 1j * step
        up, down = (_normal(ANGLE[:, None], (block,), x + s * move).cost for s in (1, -1))
        assert (up - down) / (4 * step) == pytest.approx(here.gradient[k], rel=1e-4)


def test_stated_deviations_are_those_of_many_seeds() -> None:
    """150 seeds: a deviation is known to 6 %."""
    found, stated = [], []
    for seed in range(150):
        fit = fit_output_error(ANGLE[:, None], (responses(seed, noise=0.5),), EXPONENTS, 30)
        order = np.argsort(fit.exponents.imag)
        found.append(fit.exponents[order])
        stated.append(np.sqrt(np.stack(fit.covariance[:2])[:, order]))
    scatter = np.stack([np.std(np.real(found), axis=0), np.std(np.imag(found), axis=0)])
    ratio = np.mean(stated, axis=0) / scatter
    assert np.abs(np.log(ratio)).max() < np.log(1.25), ratio
    assert np.abs(np.mean(found, axis=0) - np.array(EXPONENTS)).max() < 4 * scatter.max() / np.sqrt(150)
