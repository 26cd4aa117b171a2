"""Impulse responses of a band: exact exponentials behind the taper, whatever lies outside."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt_identifiers.hankel import realise
from vgvt_identifiers.impulse import impulse_responses
from vgvt_identifiers.root_noise import pole_spread

FREQUENCY_HZ = np.array([5.67, 8.37, 18.34, 19.82, 23.17, 28.6])
DAMPING = np.array([0.0155, 0.0106, 0.0206, 0.0233, 0.0285, 0.0255])
POLES = 2 * np.pi * FREQUENCY_HZ * (-DAMPING + 1j * np.sqrt(1 - DAMPING**2))
OUTSIDE = 2 * np.pi * np.array([0.8 * (-0.25 + 0.97j), 44 * (-0.03 + 1j)])


def accelerances(lines_hz: np.ndarray, responses: int = 1, seed: int = 0) -> np.ndarray:
    """Six modes in the band, one below and one above it."""
    generator = np.random.default_rng(seed)
    poles = np.concatenate([POLES, OUTSIDE])
    residues = generator.standard_normal((responses, poles.size)) / (2j * poles.imag)
    s = 2j * np.pi * lines_hz
    above, below = 1 / (s - poles[:, None]), 1 / (s - poles.conj()[:, None])
    return np.asarray(s**2 * (residues @ above + residues.conj() @ below))


@pytest.mark.parametrize("first_hz", [3.0, 3.037])
def test_poles_are_exact_although_the_band_ends(first_hz: float) -> None:
    """The lines need not be multiples of their spacing, as those of an analyser seldom are."""
    lines = first_hz + 0.08 * np.arange(401)
    impulse = impulse_responses(lines, accelerances(lines), 601, 0.3, 0.3)
    roots = realise(impulse.values, 500, 100, 20).roots()
    found = impulse.structure_poles(roots.values)
    near = np.array([found[np.argmin(np.abs(found - p))] for p in POLES])
    assert np.abs(near) == pytest.approx(np.abs(POLES), rel=1e-4)
    assert near.real == pytest.approx(POLES.real, rel=5e-3)


def test_without_a_taper_the_edges_of_the_band_bias_a_small_model() -> None:
    lines = 3.0 + 0.08 * np.arange(401)
    errors = {}
    for taper in (0.0, 0.3):
        wrong = []
        for seed in range(12):
            impulse = impulse_responses(lines, accelerances(lines, seed=seed), 601, taper, taper)
            found = impulse.structure_poles(realise(impulse.values, 500, 100, 12).roots().values)
            wrong += [np.abs(found - p).min() / abs(p.real) for p in POLES]
        errors[taper] = float(np.median(wrong))
    assert errors[0.3] < errors[0.0] / 5


def test_a_high_narrow_band_is_shifted_down() -> None:
    centre = 2 * np.pi * 112.0
    pole = centre * (-0.004 + 1j)
    lines = np.arange(100, 120, 0.05)
    s = 2j * np.pi * lines
    impulse = impulse_responses(lines, (s**2 / (s - pole))[None], 601, 0.3, 0.3)
    assert impulse.shift_hz > 90
    assert 1 / impulse.step_s < 50
    found = impulse.structure_poles(realise(impulse.values, 300, 60, 8).roots().values)
    assert np.abs(found - pole).min() < 1e-3 * abs(pole.real)


def test_the_spread_of_the_poles_is_what_noise_makes_of_them() -> None:
    """Monte Carlo over 120 seeds: a deviation of that many has a relative standard deviation of 6.5 %."""
    lines, deviation, seeds = 3.0 + 0.08 * np.arange(401), 0.05, 120
    clean = accelerances(lines, 2, seed=3)
    found, stated = [], []
    for seed in range(seeds):
        generator = np.random.default_rng(seed)
        noise = generator.standard_normal((2, *clean.shape))
        noisy = clean + deviation * (noise[0] + 1j * noise[1]) / np.sqrt(2)
        impulse = impulse_responses(lines, noisy, 601, 0.3, 0.3)
        model = realise(impulse.values, 300, 80, 14)
        roots = model.roots()
        spread = pole_spread(roots.values, model.sensitivity(roots), impulse, np.full(clean.shape, deviation**2))
        place = [int(np.argmin(np.abs(spread.poles - p))) for p in POLES]
        poles = spread.poles[place]
        found.append([np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)])
        stated.append([spread.frequency_std_hz[place], spread.damping_ratio_std[place]])
    ratio = np.median(stated, axis=0) / np.std(found, axis=0, ddof=1)
    assert np.abs(np.log(ratio)).max() < np.log(1.3), ratio
    assert np.exp(np.log(ratio).mean()) == pytest.approx(1, abs=0.1)


def test_uneven_or_few_lines_are_refused() -> None:
    with pytest.raises(InputError, match="evenly spaced"):
        impulse_responses(np.array([1.0, 2, 3]), np.ones((1, 3), complex))
    with pytest.raises(InputError, match="evenly spaced"):
        impulse_responses(np.geomspace(1, 10, 50), np.ones((1, 50), complex))
