"""Variances of frequency responses against their scatter, over many lines or many tests."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from vgvt.signals import estimate_frf
from vgvt.signals.cross import CrossSpectra

Complex = NDArray[np.complex128]
HADAMARD = {2: np.array([[1, 1], [1, -1]]), 4: np.kron([[1, 1], [1, -1]], [[1, 1], [1, -1]])}


def noise(generator: np.random.Generator, *shape: int) -> Complex:
    """Complex Gaussian, E|n|² = 1."""
    return np.asarray(generator.standard_normal(shape) + 1j * generator.standard_normal(shape)) / np.sqrt(2)


def sums(forces: Complex, response: Complex) -> CrossSpectra:
    """Of averages of forces (n, R, L) and one response (n, L)."""
    return CrossSpectra(
        1,
        float(len(forces)),
        np.einsum("nil,njl->ijl", forces, forces.conj()),
        np.einsum("nl,njl->jl", response, forces.conj()),
        (np.abs(response) ** 2).sum(axis=0),
    )


def several(generator: np.random.Generator, references: int, signs: bool, lines: int) -> Complex:
    """As many repeats as forces (R, R, L), signs changed orthogonally or phases by chance."""
    if signs:
        return HADAMARD[references][:, :, None] * np.exp(2j * np.pi * generator.random(lines))
    return np.exp(2j * np.pi * generator.random((references, references, lines)))


@pytest.mark.parametrize("signs", [True, False])
@pytest.mark.parametrize("references", [2, 4])
def test_noise_on_neighbouring_lines_is_told_without_bias(references: int, signs: bool) -> None:
    """The mean over 20 000 lines, some 2000 medians that are independent, each known to 40 %: 1 % of error."""
    generator = np.random.default_rng(references)
    forces = several(generator, references, signs, 20_000)
    lines = np.linspace(0, 1, 20_000)
    smooth = np.array([(1 + r) * np.exp(2j * lines * r) for r in range(references)])
    total = sums(forces, np.einsum("nrl,rl->nl", forces, smooth) + noise(generator, references, 20_000))
    stated = total.rough_variance(total.h1())
    assert stated is not None
    # Of unit forces in R repeats with orthogonal signs every reference has the noise power over R.
    power = np.linalg.inv(total.reference.transpose(2, 0, 1)).diagonal(axis1=1, axis2=2).real.T
    assert (stated / power).mean() == pytest.approx(1.0, abs=0.05)
    one_noise = stated / power
    np.testing.assert_allclose(one_noise, one_noise[:1].repeat(references, axis=0))


def test_a_resonance_narrower_than_the_lines_is_not_taken_for_noise_of_the_other_reference() -> None:
    """Half-power width of 4 lines and 100 000 times the noise in one reference, 5 % of that in the other."""
    generator = np.random.default_rng(7)
    forces = several(generator, 2, True, 2000)
    peak = 2 / (1j * (np.arange(2000) - 1000.3) + 2)
    response = np.einsum("nrl,rl->nl", forces, 1e5 * np.array([peak, 0.05 * peak])) + noise(generator, 2, 2000)
    total = sums(forces, response)
    stated = total.rough_variance(total.h1())
    # By itself the first one's roughness stands 2000 times above the noise there.
    assert stated is not None and stated[:, 990:1011].mean() / 0.5 < 60


def exact_scatter(values: Complex) -> float:
    return float(np.mean(np.abs(values - values.mean()) ** 2))


@pytest.mark.parametrize(("coherence", "averages"), [(0.95, 40), (0.5, 40), (0.2, 240)])
@pytest.mark.parametrize("where", ["both", "response"])
def test_the_variance_of_hv_is_its_scatter(coherence: float, averages: int, where: str) -> None:
    """Gaussian signals on 8000 lines; by the formula of H1 it would be 1.03, 1.33 and 1.67 times as much.

    Both are of first order in 1 / (averages coherence).
    """
    generator, lines = np.random.default_rng(11), 8000
    force, gain = noise(generator, averages, lines), 2.0 * np.exp(0.7j)
    on_force = 1 / np.sqrt(coherence) - 1 if where == "both" else 0.0
    on_response = on_force if where == "both" else 1 / coherence - 1
    response = gain * (force + np.sqrt(on_response) * noise(generator, averages, lines))
    force = force + np.sqrt(on_force) * noise(generator, averages, lines)
    total = sums(force[:, None], response)
    assert total.hv_variance().mean() == pytest.approx(exact_scatter(total.hv()[0]), rel=0.04)


def test_what_is_stated_of_hv_is_its_own_variance(make_campaign) -> None:
    """Noise of one level on force and response, coherence 0.44, in 200 parts that do not overlap."""
    generator = np.random.default_rng(13)
    force = generator.standard_normal(400_000)
    signals = [force + np.sqrt(0.5) * generator.standard_normal(force.size) for _ in range(2)]
    campaign = make_campaign([dict(zip(("F1+Z", "1+Z"), signals, strict=True))])
    frf = estimate_frf(campaign, "hv", segment_s=10.0, window="boxcar", overlap=0.0)
    assert frf.variance is not None
    assert frf.variance.mean() == pytest.approx(exact_scatter(frf.values[0, 0]), rel=0.1)


@pytest.mark.parametrize("coherence", [0.95, 0.5])
def test_h1_and_h2_have_one_relative_variance(coherence: float) -> None:
    """H2 has no second moment: its error's median is held against that of a complex Gaussian, ln 2."""
    generator, averages, lines = np.random.default_rng(12), 40, 40_000
    force = noise(generator, averages, lines)
    response = force + np.sqrt(1 / coherence - 1) * noise(generator, averages, lines)
    total = sums(force[:, None], response)
    for values in (total.h1(), total.h2()):
        error = np.abs(values - np.median(values.real) - 1j * np.median(values.imag)) ** 2
        ratio = error / total.variance(values)
        assert np.median(ratio) == pytest.approx(np.log(2), rel=0.05)


@pytest.mark.parametrize(("runs", "half_width", "within"), [(1, 8, 0.03), (2, 8, 0.03), (4, 8, 0.03), (3, 5, 0.06)])
def test_repeats_weighted_by_their_own_estimates_say_how_far_off_they_are(
    make_campaign, runs: int, half_width: int, within: float
) -> None:
    """Forces of noise through a gain, one level of noise or twice that; weights are as uncertain as their variances.

    With known weights' variance it would be 9, 13 and 27 % off; of the last, from 11 lines, the first order leaves 4 %.
    """
    generator = np.random.default_rng(runs)
    square, stated = [], []
    for _ in range(12):
        campaign_runs = []
        for run in range(runs):
            force = generator.standard_normal(20_000)
            campaign_runs.append(
                {"F1+Z": force, "1+Z": 3.0 * force + 0.3 * (1 + run % 2) * generator.standard_normal(20_000)}
            )
        frf = estimate_frf(make_campaign(campaign_runs), "local_polynomial", half_width=half_width)
        assert frf.variance is not None
        square.append(np.abs(frf.values - 3.0) ** 2)
        stated.append(frf.variance)
    # Squares on 17 lines are of one fit, and vary by themselves: 120 000 lines make 1.2 %.
    assert np.mean(square) == pytest.approx(np.mean(stated), rel=within)
