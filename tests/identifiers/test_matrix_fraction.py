"""Matrix fractions give the poles of modal sums, and their stated deviations are those of repeated noise."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt_identifiers.fraction_poles import fraction_poles, mode_poles, stabilised
from vgvt_identifiers.fraction_uncertainty import pole_deviations
from vgvt_identifiers.matrix_fraction import Fraction, FractionRows, fraction_at, reduced_equations
from vgvt_identifiers.stabilisation import Criteria

FREQUENCY = np.arange(3.0, 40.0, 1 / 24)
PAIR = (np.array([6.3, 13.7, 13.97, 26.9]), np.array([0.012, 0.009, 0.009, 0.0005]))
"""Two modes 2 % apart, and one of 0.05 % damping."""


def poles_of(frequency_hz: np.ndarray, damping: np.ndarray) -> np.ndarray:
    omega = 2 * np.pi * frequency_hz
    return np.asarray(omega * (-damping + 1j * np.sqrt(1 - damping**2)))


def accelerances(poles: np.ndarray, references: int, responses: int = 8, seed: int = 3) -> np.ndarray:
    """Modal sums (responses, references, K) of real normal modes."""
    shapes = np.random.default_rng(seed).choice([-1, 1], (poles.size, responses)) * np.linspace(0.5, 1.2, responses)
    shapes = shapes * np.random.default_rng(seed + 1).uniform(0.7, 1.3, shapes.shape)
    s = 2j * np.pi * FREQUENCY
    gain = shapes[:, :, None] * shapes[:, None, :references] / (2j * poles.imag)[:, None, None]
    terms = gain[..., None] / (s - poles[:, None, None, None]) + gain.conj()[..., None] / (
        s - poles.conj()[:, None, None, None]
    )
    return np.asarray(s**2 * terms.sum(axis=0))


def rows_of(values: np.ndarray, sigma: float, generator: np.random.Generator | None = None) -> FractionRows:
    if generator is not None:
        noise = generator.standard_normal((2, *values.shape)) / np.sqrt(2)
        values = values + sigma * (noise[0] + 1j * noise[1])
    return FractionRows(FREQUENCY, values, np.full(values.shape, sigma**2), np.empty((len(values), 0, FREQUENCY.size)))


def nearest(fraction: Fraction, poles: np.ndarray) -> np.ndarray:
    return np.argmin(np.abs(fraction.poles_rad_s - poles[:, None]), axis=1)


@pytest.mark.parametrize("references", [1, 2])
def test_noise_free_poles_of_a_close_pair_and_a_very_light_damping(references: int) -> None:
    poles = poles_of(*PAIR)
    fraction = fraction_at(reduced_equations(rows_of(accelerances(poles, references), 1e-7), 24), 24)
    found = fraction.poles_rad_s[nearest(fraction, poles)]
    np.testing.assert_array_less(np.abs(found - poles), 1e-3 * np.abs(poles.real))


def test_two_references_tell_two_modes_of_the_same_pole() -> None:
    """One reference sees one combination of the two shapes only."""
    poles = poles_of(np.array([10.0, 10.0, 20.0]), np.array([0.01, 0.01, 0.01]))
    values = accelerances(poles, 2)
    for references, count in ((1, 1), (2, 2)):
        found = fraction_at(reduced_equations(rows_of(values[:, :references], 1e-7), 16), 16)
        near = np.abs(found.poles_rad_s - poles[0]) < 0.02 * abs(poles[0].real)
        assert np.count_nonzero(near) == count


def test_what_a_record_rings_with_at_its_ends_is_told_from_the_response() -> None:
    poles, generator = poles_of(*PAIR), np.random.default_rng(5)
    values = accelerances(poles, 1)
    force = np.exp(2j * np.pi * generator.uniform(size=FREQUENCY.size)) * generator.uniform(0.5, 2.0, FREQUENCY.size)
    s = 2j * np.pi * FREQUENCY
    left = (generator.standard_normal((8, 4)) @ (1 / (s - poles[:, None])))[:, None] / force
    sizes = np.full(values.shape, 1e-14)
    leakage = np.broadcast_to(1 / force, (8, 1, FREQUENCY.size))
    misfits = []
    for known in (leakage, leakage[:, :0]):
        fraction = fraction_at(reduced_equations(FractionRows(FREQUENCY, values + left, sizes, known), 20), 20)
        found = fraction.poles_rad_s[nearest(fraction, poles)]
        misfits.append(np.max(np.abs(found - poles) / np.abs(poles.real)))
    assert misfits[0] < 1e-2
    assert misfits[1] > 10 * misfits[0]


@pytest.mark.parametrize("references", [1, 2])
def test_stated_deviations_are_those_of_repeated_noise(references: int) -> None:
    """Ratio of 60 draws to the first-order formula: within 35 %, four standard deviations of such an estimate."""
    poles, generator = poles_of(*PAIR), np.random.default_rng(7)
    values = accelerances(poles, references)
    found, stated = [], []
    for draw in range(60):
        rows = rows_of(values, 0.02, generator)
        equations = reduced_equations(rows, 18, noise_removed=0.5)
        fraction = fraction_at(equations, 18)
        which = nearest(fraction, poles)
        found.append(fraction.poles_rad_s[which])
        if draw < 4:
            stated.append(pole_deviations(rows, equations, fraction, which))
    deviation = np.array([np.std([f.real for f in found], axis=0), np.std([f.imag for f in found], axis=0)]).T
    ratio = deviation / np.mean(stated, axis=0)
    assert np.all(np.abs(np.log(ratio)) < np.log(1.35)), ratio


def test_taking_the_noise_off_the_equations_lowers_the_bias() -> None:
    """Root mean square over the modes; at this noise bias is far larger than the scatter of the mean."""
    poles, values = poles_of(*PAIR), accelerances(poles_of(*PAIR), 1)
    bias = []
    for removed in (0.0, 0.95):
        generator = np.random.default_rng(11)
        errors = []
        for _ in range(10):
            fraction = fraction_at(reduced_equations(rows_of(values, 0.1, generator), 20, removed), 20)
            errors.append(fraction.poles_rad_s[nearest(fraction, poles)] - poles)
        bias.append(np.abs(np.mean(errors, axis=0)) / np.abs(poles.real))
    assert np.sqrt(np.mean(bias[1] ** 2)) < 0.5 * np.sqrt(np.mean(bias[0] ** 2))


def test_the_diagram_of_a_noisy_sum_holds_its_modes_and_no_other() -> None:
    poles = poles_of(*PAIR)
    rows = rows_of(accelerances(poles, 1), 0.1, np.random.default_rng(13))
    band = (float(FREQUENCY[0]), float(FREQUENCY[-1]))
    found = fraction_poles(rows, band, 32)
    modes = mode_poles(found, stabilised(found, band, Criteria()))
    assert modes.poles_rad_s.size == poles.size
    np.testing.assert_array_less(np.abs(modes.poles_rad_s - poles), 0.2 * np.abs(poles.real))


def test_too_few_lines_are_refused() -> None:
    rows = FractionRows(FREQUENCY[:6], np.ones((1, 1, 6), complex), np.ones((1, 1, 6)), np.empty((1, 0, 6)))
    with pytest.raises(ValueError, match="lines cannot hold"):
        fraction_poles(rows, (3.0, 4.0))
    with pytest.raises(ValueError, match="lines cannot hold"):
        reduced_equations(rows, 4)
