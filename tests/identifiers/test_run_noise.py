"""Noise of responses and of the force, told apart from what a fit leaves over."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt_identifiers.run_noise import first_noise, noise_of_errors

LINES = 2000
FREQUENCY = np.linspace(3.0, 30.0, LINES)


def gains() -> np.ndarray:
    """Three responses with two resonances each, (3, LINES)."""
    r = FREQUENCY / np.array([[8.0], [19.0]])
    peaks = r**2 / (1 - r**2 + 0.02j * r)
    return np.array([[1.0, 0.5], [0.4, -1.0], [0.8, 0.3]]) @ peaks


def errors_of(response: np.ndarray, force: float, seed: int = 0) -> np.ndarray:
    """Errors of ratios for a force of size one: own noise of power ``response`` (3, LINES) less G times the force's."""
    generator = np.random.default_rng(seed)

    def circular(*shape: int) -> np.ndarray:
        return (generator.standard_normal(shape) + 1j * generator.standard_normal(shape)) / np.sqrt(2)

    return np.asarray(np.sqrt(response) * circular(3, LINES) - gains() * np.sqrt(force) * circular(LINES))


def test_colour_and_level_of_every_response_are_found() -> None:
    response = np.array([[1.0], [4.0], [0.25]]) * np.linspace(2.0, 1.0, LINES)
    found = noise_of_errors(errors_of(response, 0.0), gains(), np.ones(LINES, complex), 0)
    # Medians over 48 lines, then smoothed: about 15 % of scatter.
    assert np.sqrt(np.mean((found.response / response - 1) ** 2)) < 0.25
    assert found.response.mean() == pytest.approx(response.mean(), rel=0.05)


@pytest.mark.parametrize("level", [0.02, 0.5])
def test_noise_of_the_force_is_told_from_the_responses(level: float) -> None:
    response = np.ones((3, LINES))
    found = noise_of_errors(errors_of(response, level, 1), gains(), np.ones(LINES, complex), 0)
    # It shows at the resonances alone, on few dozens of lines.
    assert np.median(found.force) == pytest.approx(level, rel=0.5)
    power = np.abs(gains()) ** 2
    told, true = found.response + power * found.force, 1.0 + power * level
    for lines in (np.abs(FREQUENCY - 8.0) < 0.1, np.abs(FREQUENCY - 19.0) < 0.2, FREQUENCY < 5.0):
        assert (told[:, lines] / true[:, lines]).mean() == pytest.approx(1.0, abs=0.35)


def test_lines_that_the_force_spoils_weigh_less() -> None:
    response, force = np.ones((3, LINES)), np.ones(LINES, complex)
    found = noise_of_errors(errors_of(response, 0.5, 2), gains(), force, 0)
    weight, scale = found.shared_weights(force)
    top, quiet = int(np.argmin(np.abs(FREQUENCY - 8.0))), int(np.argmin(np.abs(FREQUENCY - 4.0)))
    assert weight[0, top] < 0.2 * weight[0, quiet]
    own = found.weights(force)
    np.testing.assert_allclose(own.mean(axis=1), (weight * scale[:, None]).mean(axis=1), rtol=0.1)


def test_noise_of_the_force_that_no_response_shows_by_itself_is_found_by_all_of_them() -> None:
    """Twenty responses, in each of which the force's noise is nowhere more than its own."""
    generator = np.random.default_rng(5)
    ratios = (generator.standard_normal((20, 2)) @ gains()[:2]) / 50
    level = 1.0 / (np.abs(ratios) ** 2).max()

    def circular(*shape: int) -> np.ndarray:
        return (generator.standard_normal(shape) + 1j * generator.standard_normal(shape)) / np.sqrt(2)

    errors = circular(20, LINES) - ratios * np.sqrt(level) * circular(LINES)
    found = noise_of_errors(errors, ratios, np.ones(LINES, complex), 0)
    top = int(np.argmax((np.abs(ratios) ** 2).sum(axis=0)))
    assert found.force[top] == pytest.approx(level, rel=0.3)
    assert found.response[:, abs(FREQUENCY - FREQUENCY[top]) < 0.3].mean() == pytest.approx(1.0, rel=0.1)


@pytest.mark.parametrize("responses", [1, 2, 20])
def test_noise_of_responses_alone_is_not_taken_for_the_force_s(responses: int) -> None:
    generator = np.random.default_rng(7)
    ratios = generator.standard_normal((responses, 2)) @ gains()[:2]
    named = 0
    for _ in range(20):
        errors = generator.standard_normal((responses, LINES)) + 1j * generator.standard_normal((responses, LINES))
        named += bool(noise_of_errors(errors, ratios, np.ones(LINES, complex), 0).force.any())
    # e^-7 in each of four bands: one in twenty campaigns would already be a rare accident.
    assert named <= 1


def test_a_record_without_noise_still_has_weights() -> None:
    ratios = gains()
    plain = first_noise(np.zeros(ratios.shape), np.ones(LINES, complex))
    assert np.isfinite(plain.weights(np.ones(LINES, complex))).all()
    # Every instrument is wrong by a part of what it shows.
    careful = first_noise(np.zeros(ratios.shape), np.ones(LINES, complex), ratios)
    assert (careful.response >= plain.response).all() and (careful.response > 0).all()


@pytest.mark.parametrize("lines", [29, 39, 40, 41])
def test_a_narrow_band_is_one_band_of_lines(lines: int) -> None:
    """Bands of 40 lines at least were cut out of 29: one of them was empty, and `auto` ended with an error."""
    rng = np.random.default_rng(0)
    ratios = rng.normal(size=(3, lines)) + 1j * rng.normal(size=(3, lines))
    found = noise_of_errors(0.1 * ratios[::-1], ratios, np.ones(lines, complex), 0)
    assert found.response.shape == (3, lines) and np.isfinite(found.response).all() and (found.response > 0).all()
    assert np.isfinite(found.force).all() and np.isfinite(found.force_share).all()
