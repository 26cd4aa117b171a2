"""The local polynomial method: its variance is calibrated, and it removes leakage."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.signals import estimate_frf, linear_chirp, local_polynomial_variance
from vgvt.signals.local_polynomial import local_polynomial_fit

RATE_HZ = 200.0


def noisy_runs(single_mass, make_campaign, count: int, level: float, seed: int):
    generator = np.random.default_rng(seed)
    force = linear_chirp(np.arange(12_000) / RATE_HZ, 1.0, 40.0, 50.0)
    response = single_mass.acceleration(force, RATE_HZ)
    for _ in range(count):
        yield make_campaign([{"F1+Z": force, "1+Z": response + level * generator.standard_normal(force.size)}])


@pytest.mark.parametrize("estimator", ["ratio", "local_polynomial"])
def test_stated_variance_is_the_scatter_over_repeated_tests(single_mass, make_campaign, estimator: str) -> None:
    estimates = [
        estimate_frf(c, estimator, band_hz=(5.0, 35.0), local_variance=True)
        for c in noisy_runs(single_mass, make_campaign, 60, 0.5, 1)
    ]
    values = np.array([e.values[0, 0] for e in estimates])
    scatter = values.var(axis=0, ddof=1)
    stated = np.mean([e.variance[0, 0] for e in estimates], axis=0)
    # Away from the resonance line by line; the mean ratio of 1800 lines over 60 tests scatters by well under 1 %.
    assert (scatter / stated).mean() == pytest.approx(1.0, abs=0.1)


def test_noise_power_is_calibrated_for_white_noise_alone() -> None:
    generator = np.random.default_rng(4)
    force = np.fft.rfft(generator.standard_normal(20_000))
    noise = np.fft.rfft(0.3 * generator.standard_normal(20_000))
    variance = local_polynomial_variance(2.0 * force + noise, force)
    assert np.isnan(variance[0])
    ratio = variance[1:-1] * np.abs(force[1:-1]) ** 2 / (0.3**2 * 20_000)
    assert ratio.mean() == pytest.approx(1.0, abs=0.03)


def test_a_response_that_is_a_local_polynomial_is_found_exactly() -> None:
    generator = np.random.default_rng(5)
    lines = np.arange(400)
    force = generator.standard_normal((2, 400)) + 1j * generator.standard_normal((2, 400))
    first, second, leak = ((1 + 0.3j) + 0.01 * lines), (2 - 1e-4 * lines**2), (0.5j - 0.02 * lines)
    fit = local_polynomial_fit((first * force[0] + second * force[1] + leak)[None], force, lines[1:])
    np.testing.assert_allclose(fit.values[0], [first[1:], second[1:]], rtol=1e-8)
    assert fit.noise_power.max() < 1e-18


def one_line(responses, references, line: int, half_width: int):
    """The fit around one line by `numpy.linalg.lstsq`, column by column as the definition has it."""
    centre = min(max(line, 1 + half_width), responses.shape[1] - 1 - half_width)
    window = np.arange(centre - half_width, centre + half_width + 1)
    powers = ((window - line) / half_width)[:, None] ** np.arange(3)
    design = np.hstack([*(reference[window, None] * powers for reference in references), powers])
    found, _, rank, _ = np.linalg.lstsq(design, responses[:, window].T, rcond=1e-13)
    left = responses[:, window].T - design @ found
    noise = (np.abs(left) ** 2).sum(axis=0) / (window.size - design.shape[1])
    gain = (np.abs(np.linalg.pinv(design)[: 3 * len(references) : 3]) ** 2).sum(axis=1)
    return found[: 3 * len(references) : 3].T, noise, gain, rank


@pytest.mark.parametrize("inputs", [1, 2])
def test_every_line_is_its_own_least_squares_fit(inputs: int) -> None:
    """Also at the ends of the axis, and where a reference is zero on most lines of the window."""
    generator = np.random.default_rng(6)
    shape = (inputs + 3, 120)
    force, *_ = np.split(generator.standard_normal(shape) + 1j * generator.standard_normal(shape), [inputs])
    responses = generator.standard_normal((3, 120)) + 1j * generator.standard_normal((3, 120))
    force[0, 50:90] = 0.0
    force[0, 69] = 1.0
    fit = local_polynomial_fit(responses, force, np.arange(1, 120))
    ranks = []
    for line in range(1, 120):
        values, noise, gain, rank = one_line(responses, force, line, 8)
        ranks.append(int(rank))
        if rank == 3 * (inputs + 1):
            np.testing.assert_allclose(fit.noise_power[:, line - 1], noise, rtol=1e-8)
            np.testing.assert_allclose(fit.values[:, :, line - 1], values, rtol=1e-6, atol=1e-9)
            np.testing.assert_allclose(fit.variance[:, :, line - 1], noise[:, None] * gain, rtol=1e-6)
    assert 3 * inputs + 1 in ranks  # one line of force alone in its window
    dead = local_polynomial_fit(responses, np.zeros((1, 120), complex), np.arange(1, 120))
    assert not dead.values.any()


def test_leakage_of_a_record_cut_short_is_taken_out(single_mass, make_campaign) -> None:
    damped = replace(single_mass, damping_ratio=0.1)
    # Downwards through 10 Hz at 51.4 s, and cut there: the record ends in full swing.
    force = linear_chirp(np.arange(10_280) / RATE_HZ, 40.0, 5.0, 60.0)
    campaign = make_campaign([{"F1+Z": force, "1+Z": damped.acceleration(force, RATE_HZ)}])
    errors = {}
    for estimator in ("ratio", "local_polynomial"):
        frf = estimate_frf(campaign, estimator, band_hz=(10.5, 30.0))
        exact = damped.held_accelerance(frf.frequency_hz, RATE_HZ)
        errors[estimator] = np.sqrt((np.abs(frf.values[0, 0] - exact) ** 2).mean() / (np.abs(exact) ** 2).mean())
    assert errors["local_polynomial"] < 0.2 * errors["ratio"]


def test_a_window_too_small_for_its_unknowns_is_refused() -> None:
    with pytest.raises(ValueError, match="raise half_width"):
        local_polynomial_fit(np.ones((1, 100), complex), np.ones((1, 100), complex), np.arange(1, 5), 3, 3)
