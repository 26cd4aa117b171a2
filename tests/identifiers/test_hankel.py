"""The realisation: against control's, against theory, and its sensitivities against finite differences."""

from __future__ import annotations

import control
import numpy as np
import pytest

from vgvt_identifiers.data_correlation import realise_correlated
from vgvt_identifiers.hankel import HankelModel, hankel_gram, realise
from vgvt_identifiers.indicators import (
    consistent_mode_indicator,
    correlated_amplitude_coherence,
    extended_modal_amplitude_coherence,
)

ROOTS = np.exp(np.array([-0.01 + 0.5j, -0.02 + 1.3j, -0.015 + 2.2j]))


def decays(responses: int, samples: int, noise: float = 0.0, seed: int = 0) -> np.ndarray:
    """Impulse responses (R, N) of three modes with random amplitudes."""
    generator = np.random.default_rng(seed)
    size = (responses, ROOTS.size)
    amplitude = generator.standard_normal(size) + 1j * generator.standard_normal(size)
    clean = 2 * (amplitude @ ROOTS[:, None] ** np.arange(samples)).real
    return np.asarray(clean + noise * generator.standard_normal(clean.shape))


@pytest.mark.parametrize(("responses", "noise"), [(1, 0.0), (1, 0.3), (4, 0.1)])
def test_it_is_the_realisation_of_the_control_library(responses: int, noise: float) -> None:
    impulse = decays(responses, 260, noise)
    ours = realise(impulse, 120, 60, 6)
    # control takes the direct term first and starts the Hankel matrix behind it.
    markov = np.concatenate([np.zeros((responses, 1, 1)), impulse[:, None, :]], axis=2)
    theirs, singular = control.eigensys_realization(markov, 6, m=120, n=60)
    assert ours.singular_values[:6] == pytest.approx(singular[:6], rel=1e-9)
    mine, other = (np.sort_complex(np.linalg.eigvals(a)) for a in (ours.a, theirs.A))
    assert mine == pytest.approx(other, abs=1e-9)
    own = np.array([ours.c @ np.linalg.matrix_power(ours.a, k) @ ours.b for k in range(40)])
    expected = np.array([theirs.C @ np.linalg.matrix_power(theirs.A, k) @ theirs.B for k in range(40)])
    assert own == pytest.approx(expected[:, :, 0], abs=1e-9 * np.abs(impulse).max())


def test_the_gram_matrix_is_that_of_the_whole_hankel_matrix() -> None:
    impulse = decays(3, 90, 0.5)
    hankel = np.concatenate([np.array([h[i : i + 30] for i in range(40)]) for h in impulse])
    assert hankel_gram(impulse, 40, 30) == pytest.approx(hankel.T @ hankel, rel=1e-11)


@pytest.mark.parametrize("responses", [1, 3])
def test_without_noise_the_roots_are_exact_and_the_model_is_the_response(responses: int) -> None:
    impulse = decays(responses, 200)
    plain, correlated = realise(impulse, 100, 50, 10), realise_correlated(impulse, 80, 40, 10)
    assert plain.truncated(6).roots().values == pytest.approx(ROOTS, abs=1e-9)
    assert correlated.truncated(6).roots().values == pytest.approx(ROOTS, abs=1e-6)
    model = plain.truncated(6)
    predicted = np.array([model.c @ np.linalg.matrix_power(model.a, k) @ model.b for k in range(60)]).T
    assert predicted == pytest.approx(impulse[:, :60], abs=1e-9)


@pytest.mark.parametrize("model", [realise, realise_correlated])
def test_sensitivities_are_those_of_a_small_change(model: object) -> None:
    impulse = decays(2, 160)

    def build(samples: np.ndarray) -> HankelModel:
        if model is realise:
            return realise(samples, 80, 40, 6)
        return realise_correlated(samples, 60, 30, 6, 3, 2, 7)

    base = build(impulse)
    roots = base.roots()
    generator = np.random.default_rng(5)
    change = 1e-6 * generator.standard_normal(impulse.shape)
    predicted = np.einsum("nrk,rk->n", base.sensitivity(roots), change)
    moved = build(impulse + change).roots().values - roots.values
    # First order holds for a matrix of the rank of the model, so the responses are free of other noise.
    assert moved == pytest.approx(predicted, abs=1e-3 * np.abs(predicted).max())


def test_coherence_is_one_for_a_mode_and_small_for_noise() -> None:
    impulse = decays(3, 200, 0.02)
    for build, coherence in (
        (realise(impulse, 100, 50, 14), extended_modal_amplitude_coherence),
        (realise_correlated(impulse, 80, 40, 14), correlated_amplitude_coherence),
    ):
        roots = build.roots()
        values = coherence(build, roots)
        near = np.abs(roots.values[:, None] - ROOTS).min(axis=1) < 1e-2
        assert near.sum() == 3
        assert values[near].min() > 0.9
        assert np.median(values[~near]) < 0.3
    assert consistent_mode_indicator(np.array([0.9]), np.array([[1.0, -2.0]]) * (1 + 1j)) == pytest.approx(0.9)


def test_too_few_samples_are_refused() -> None:
    with pytest.raises(ValueError, match="cannot fill"):
        realise(decays(1, 30), 10, 29, 4)
    with pytest.raises(ValueError, match="cannot fill"):
        realise_correlated(decays(1, 60), 10, 30, 4)


def test_a_matrix_that_takes_every_sample_is_the_same() -> None:
    """Rows and columns that use the response to its last sample: the recursion reads none beyond."""
    impulse = np.random.default_rng(8).standard_normal((2, 30))
    hankel = np.vstack([np.lib.stride_tricks.sliding_window_view(h, 11)[:20] for h in impulse])
    np.testing.assert_allclose(hankel_gram(impulse, 20, 11), hankel.T @ hankel, atol=1e-12)
