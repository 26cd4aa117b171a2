"""Fisher information of poles against the closed form of one mode and against brute force for close ones."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.simulation.fisher import (
    BACKGROUND,
    Forces,
    Lines,
    accelerance,
    deviations,
    information_of_responses,
    lines_for,
    mean_deviation,
    mean_weights,
    weighted_slopes,
)
from vgvt.simulation.shared_noise import shared_information


def pole(hz: float, ratio: float) -> complex:
    return 2 * np.pi * hz * (-ratio + 1j * np.sqrt(1 - ratio**2))


def predicted(poles, residues, band, energy, noise):
    lines = lines_for(band, poles)
    gram = weighted_slopes(lines, poles, np.full(lines.frequency_hz.size, 4 * energy / noise))
    return deviations(poles, information_of_responses(gram, residues).sum(axis=0))


def brute_force(poles, residues, band, energy, noise_of, lines=6000, shares=((1.0,),)):
    """Deviations from the whole Jacobian by finite differences: all poles, residues and backgrounds at once.

    ``noise_of`` gives the covariance (D, D) of the responses on a line, from their accelerances (D, R). Forces of one
    ``energy`` act after each other, each pushing a mode by its share of ``shares`` (M or 1, R).
    """
    f = np.linspace(*band, lines)
    s = 2j * np.pi * f
    count, responses = residues.shape
    middle = abs(s[lines // 2])
    share = np.broadcast_to(np.array(shares), (count, len(shares[0])))
    rests = 4 * share.shape[1]

    def model(x):
        """Accelerances (D, R, K)."""
        p = x[:count] + 1j * x[count : 2 * count]
        rest = x[2 * count :].reshape(responses, -1)
        r = (rest[:, :count] + 1j * rest[:, count : 2 * count]).T
        powers = np.array([(s / middle) ** k for k in (-1, 0, 1, 2)])
        background = rest[:, 2 * count :].reshape(responses, -1, 4) @ powers
        return np.stack([accelerance(f, p, r * c[:, None]) for c in share.T], axis=1) + background

    start = np.concatenate(
        [poles.real, poles.imag, np.hstack([residues.real.T, residues.imag.T, np.zeros((responses, rests))]).ravel()]
    )
    step = np.concatenate([np.full(2 * count, 1e-5), np.full(start.size - 2 * count, 1e-7 * np.abs(residues).max())])
    jacobian = np.array(
        [(model(start + h) - model(start - h)) / (2 * h.max()) for h in np.diag(step)]
    )  # (parameters, D, R, K)
    h = model(start)
    weight = 4 * energy * (f[1] - f[0])
    information = np.zeros((start.size, start.size))
    for k in range(lines):
        inverse = np.linalg.inv(noise_of(h[:, :, k]))
        for r in range(share.shape[1]):
            part = jacobian[:, :, r, k]
            information += weight * (part.conj() @ inverse @ part.T).real
    size = np.sqrt(np.diag(information))
    covariance = np.linalg.inv(information / size[:, None] / size) / size[:, None] / size
    return deviations(poles, np.linalg.inv(covariance[: 2 * count, : 2 * count]))


def test_one_mode_meets_the_closed_form() -> None:
    p, energy, noise = pole(8.0, 0.012), 30.0, 1e-5
    residue = np.array([[0.02 / (2j * p.imag)]])
    std_hz, std_ratio = predicted(np.array([p]), residue, (0.5, 60.0), energy, noise)
    s = -p.real
    peak = abs(residue[0, 0]) * abs(p) ** 2 / s
    closed = np.sqrt(2 * s * noise / energy) / peak / (2 * np.pi)
    assert std_hz[0] == pytest.approx(closed, rel=0.03)
    assert std_ratio[0] / 0.012 == pytest.approx(2 * np.pi * closed / s, rel=0.03)


@pytest.mark.parametrize("apart_hz", [0.1, 0.4, 3.0])
def test_close_modes_meet_brute_force(apart_hz: float) -> None:
    poles = np.array([pole(10.0, 0.012), pole(10.0 + apart_hz, 0.015)])
    residues = np.array([[0.02, 0.015], [0.014, -0.02]]) / (2j * poles.imag[:, None]) * np.exp(0.1j)
    expected = brute_force(poles, residues, (7.0, 16.0), 30.0, lambda h: 1e-5 * np.eye(len(h)))
    found = predicted(poles, residues, (7.0, 16.0), 30.0, 1e-5)
    for mine, theirs in zip(found, expected, strict=True):
        assert mine == pytest.approx(theirs, rel=0.01)


def test_close_modes_are_harder_than_one_alone() -> None:
    poles = np.array([pole(10.0, 0.012), pole(10.1, 0.012)])
    residues = np.array([[0.02], [0.02]]) / (2j * poles.imag[:, None])
    pair = predicted(poles, residues, (7.0, 16.0), 30.0, 1e-5)[1][0]
    alone = predicted(poles[:1], residues[:1], (7.0, 16.0), 30.0, 1e-5)[1][0]
    assert pair > 3 * alone


def test_noise_of_the_force_that_all_responses_share() -> None:
    poles = np.array([pole(9.0, 0.012)])
    residues = np.array([[0.02, 0.013, -0.007]]) / (2j * poles.imag[:, None])
    response_noise, force_noise, energy = 1e-5, 4e-5, 30.0

    def covariance(h):
        return response_noise * np.eye(len(h)) + force_noise * h @ h.conj().T

    expected = brute_force(poles, residues, (6.0, 14.0), energy, covariance)
    lines = lines_for((6.0, 14.0), poles)
    power = (np.abs(accelerance(lines.frequency_hz, poles, residues)) ** 2).sum(axis=0)
    assert (force_noise * power / response_noise).max() > 2  # or nothing would be tested
    gram = weighted_slopes(lines, poles, 4 * energy / (response_noise + force_noise * power))
    found = deviations(poles, information_of_responses(gram, residues).sum(axis=0))
    for mine, theirs in zip(found, expected, strict=True):
        assert mine == pytest.approx(theirs, rel=0.03)


@pytest.mark.parametrize("shares", [((1.0,), (1.0,)), ((1.0, 0.4), (-0.7, 1.0))])
def test_close_modes_whose_forces_are_noisy_meet_brute_force(shares) -> None:
    """Shapes that differ: what one force's noise hides along the one is seen along the other."""
    poles = np.array([pole(10.0, 0.012), pole(10.2, 0.015)])
    residues = np.array([[0.02, 0.015, 0.002], [0.014, -0.02, 0.01]]) / (2j * poles.imag[:, None])
    band, own, felt, energy = (8.0, 13.0), 1e-5, 2e-4, 30.0
    share = np.array(shares, dtype=complex)
    expected = brute_force(
        poles, residues, band, energy, lambda h: own * np.eye(len(h)) + felt * h @ h.conj().T, shares=shares
    )
    lines = lines_for(band, poles)
    count, forces = lines.frequency_hz.size, share.shape[1]
    tiled = Lines(np.tile(lines.frequency_hz, forces), np.tile(lines.width_hz, forces))
    spectra = np.sqrt(energy) * np.kron(np.eye(forces), np.ones(count)).astype(complex)
    pushing = Forces(spectra, share, spectra)
    h = np.stack([accelerance(tiled.frequency_hz, poles, residues * c[:, None]) for c in share.T], axis=1)
    noise = (np.full(count * forces, own), np.sqrt(felt) * h)
    found = deviations(poles, shared_information(tiled, poles, residues, noise, BACKGROUND, pushing))
    for mine, theirs in zip(found, expected, strict=True):
        assert mine == pytest.approx(theirs, rel=0.02)
    weight = 4 / (own + felt * (np.abs(h) ** 2).sum(axis=(0, 1)))
    gram = weighted_slopes(tiled, poles, weight, BACKGROUND, pushing)
    short_cut = deviations(poles, information_of_responses(gram, residues).sum(axis=0))
    assert (np.array(short_cut) > 1.05 * np.array(found)).all()


def test_two_forces_that_are_one_tell_what_one_tells() -> None:
    poles = np.array([pole(10.0, 0.012), pole(11.0, 0.015)])
    lines = lines_for((7.0, 16.0), poles)
    force = 3.0 * np.exp(1j * np.linspace(0, 40, lines.frequency_hz.size))
    split = Forces(np.array([0.25 * force, 0.75 * force]), np.ones((2, 2), dtype=complex), force[None])
    apart = weighted_slopes(lines, poles, np.full(force.size, 4e5), BACKGROUND, split)
    whole = weighted_slopes(lines, poles, np.full(force.size, 4e5 * 9.0))
    np.testing.assert_allclose(apart, whole, rtol=1e-6, atol=1e-9 * np.abs(whole).max())


def test_a_mode_that_nobody_sees_has_no_finite_deviation() -> None:
    poles = np.array([pole(10.0, 0.012), pole(20.0, 0.012)])
    residues = np.array([[0.02], [0.0]]) / (2j * poles.imag[:, None])
    std_hz, std_ratio = predicted(poles, residues, (7.0, 30.0), 30.0, 1e-5)
    assert np.isfinite(std_hz[0])
    assert np.isinf(std_hz[1])
    assert np.isinf(std_ratio[1])


def test_the_mean_of_runs() -> None:
    same = mean_deviation(np.full(4, 8.0), np.array([1.0, 1.0, 2.0, np.inf]))
    assert same == pytest.approx(1 / np.sqrt(1 + 1 + 0.25))
    scattered = mean_deviation(np.array([7.0, 8.0, 9.0]) * 1e3, np.array([1.0, 1.0, 2.0]))
    assert scattered == pytest.approx(np.sqrt(6.0) / 3, rel=1e-3)
    assert np.isinf(mean_deviation(np.ones(2), np.full(2, np.inf)))
    assert mean_weights(np.full(3, 8.0), np.array([1.0, 2.0, np.inf])) == pytest.approx([0.8, 0.2, 0.0])
    assert mean_weights(np.array([7.0, 9.0]) * 1e3, np.array([1.0, 2.0])) == pytest.approx([0.5, 0.5], rel=1e-5)
    assert not mean_weights(np.ones(2), np.full(2, np.inf)).any()
