"""The likelihood fit of poles: right derivatives, exact answers without noise, and honest covariances with it."""

from __future__ import annotations

import numpy as np
import pytest
from pole_case import FORCE, GAINS, POLES, S, accelerance, poles_of, problem

from vgvt_identifiers.drifting_poles import fit_runs
from vgvt_identifiers.pole_fit import evaluate, fit_poles, projected_slopes
from vgvt_identifiers.pole_search import least_fall, search_poles


def noisy(seed: int, std: float | np.ndarray = 0.01) -> np.ndarray:
    generator = np.random.default_rng(seed)
    clean = accelerance(POLES, GAINS)
    return clean + std * (generator.standard_normal(clean.shape) + 1j * generator.standard_normal(clean.shape))


@pytest.mark.parametrize("own", [False, True])
def test_gradient_and_information_are_the_derivatives_of_the_cost(own: bool) -> None:
    at = POLES + 0.05 * np.abs(POLES.real) * np.exp(1j * np.arange(4))
    state = evaluate(problem(noisy(3, 0.2), 0.2, own), at)
    for part, turn in ((0, 1.0), (4, 1j)):
        for pole in range(4):
            step = 1e-4 * abs(at[pole].real) * turn
            sides = [at + sign * step * np.eye(4)[pole] for sign in (1, -1)]
            up, down = (evaluate(problem(noisy(3, 0.2), 0.2, own), p).cost for p in sides)
            slope = -(up - down) / (2 * abs(step)) / 2
            # Kaufman's Jacobian leaves out a term that vanishes with the error.
            assert state.gradient[part + pole] == pytest.approx(slope, rel=0.05, abs=1e-3 * abs(state.gradient).max())


def test_shared_and_own_weights_agree_when_they_are_equal() -> None:
    shared, own = (evaluate(problem(noisy(4), own=o), POLES) for o in (False, True))
    np.testing.assert_allclose(own.cost, shared.cost, rtol=1e-9)
    np.testing.assert_allclose(own.information, shared.information, rtol=1e-6, atol=1e-6 * shared.information.max())
    np.testing.assert_allclose(own.residues[0], shared.residues[0], rtol=1e-8)
    np.testing.assert_allclose(own.gain, shared.gain, rtol=1e-6)


def test_without_noise_the_poles_come_back_with_a_pair_and_a_line_of_half_a_tenth_of_a_per_cent() -> None:
    start = poles_of([7.02, 10.98, 11.23, 16.001], [0.03, 0.012, 0.01, 0.001])
    state = fit_poles(problem(accelerance(POLES, GAINS)), start)
    assert state.converged
    np.testing.assert_allclose(state.poles, POLES, rtol=1e-9)
    np.testing.assert_allclose(state.residues[0], GAINS, rtol=1e-6)


def test_what_a_cut_record_rings_with_does_not_move_the_poles() -> None:
    ring = 3.0 * accelerance(POLES, GAINS[::-1]) / S**2 * np.abs(POLES).mean()
    state = fit_poles(problem(accelerance(POLES, GAINS) + ring / FORCE), POLES * (1 + 1e-4))
    np.testing.assert_allclose(state.poles, POLES, rtol=1e-9)


def test_errors_of_many_fits_have_the_covariance_that_each_states() -> None:
    fits = [fit_poles(problem(noisy(seed, 0.3), 0.3), POLES, 8) for seed in range(40)]
    stated = np.mean([np.sqrt(np.diag(f.covariance())) for f in fits], axis=0)
    errors = np.array([np.concatenate([(f.poles - POLES).real, (f.poles - POLES).imag]) for f in fits])
    ratio = np.sqrt((errors**2).mean(axis=0)) / stated
    # 40 fits know each standard deviation within 11 % (one standard deviation).
    assert (np.abs(ratio - 1) < 0.4).all() and abs(np.sqrt((ratio**2).mean()) - 1) < 0.15


def test_poles_that_are_not_free_stay_and_count_as_known() -> None:
    free = np.array([True, True, False, True])
    state = fit_poles(problem(noisy(5)), POLES * (1 + 1e-4), free=free)
    assert state.poles[2] == POLES[2] * (1 + 1e-4) and state.poles[0] != POLES[0] * (1 + 1e-4)
    some, all_ = np.diag(state.covariance(free)), np.diag(state.covariance())
    assert some[2] == 0.0 and some[1] < all_[1]


def test_projected_slopes_make_up_the_information() -> None:
    state = evaluate(problem(noisy(6)), POLES)
    total = sum((slopes @ slopes.conj().T).real for _, _, slopes in projected_slopes(problem(noisy(6)), state))
    np.testing.assert_allclose(total, state.information, rtol=1e-6, atol=1e-8 * np.abs(state.information).max())


def test_the_search_finds_all_poles_from_nothing_and_no_other() -> None:
    found = search_poles((problem(noisy(7, 0.05), 0.05),), np.empty(0, complex))
    order = np.argsort(found.poles.imag)
    np.testing.assert_allclose(found.poles[order], POLES, rtol=1e-3)


def test_noise_alone_brings_no_pole_in() -> None:
    generator = np.random.default_rng(8)
    for _ in range(5):
        noise = generator.standard_normal((5, S.size)) + 1j * generator.standard_normal((5, S.size))
        assert not search_poles((problem(noise, 1.0),), np.empty(0, complex)).poles.size


def test_more_responses_ask_for_more_evidence() -> None:
    one, five = (least_fall((problem(noisy(9)[:rows]),), 1e-3) for rows in (1, 5))
    assert one < five < 5 * one


def test_runs_keep_their_own_poles_and_a_run_that_sees_nothing_follows() -> None:
    """Two runs shifted by half a per cent, and one with a hundred thousand times the noise."""
    shifts = (1.0025, 0.9975, 1.0)
    runs = []
    for shift, std in zip(shifts, (0.01, 0.01, 1000.0), strict=True):
        clean = accelerance(POLES * shift, GAINS)
        noise = np.random.default_rng(10).standard_normal((2, *clean.shape)) * std
        runs.append(problem(clean + noise[0] + 1j * noise[1], std))
    found = fit_runs(tuple(runs), POLES, 30)
    for state, shift in zip(found.states[:2], shifts[:2], strict=True):
        np.testing.assert_allclose(state.poles, POLES * shift, rtol=2e-4)
    np.testing.assert_allclose(found.poles, POLES, rtol=1e-3)
    # The model lets a run's frequency differ by 0.2 % (one standard deviation); noise may use some of that.
    np.testing.assert_allclose(found.states[2].poles.imag, found.poles.imag, rtol=4e-3)
