"""Means of spectral matrices: singular values by another way, noise by its mean over draws, modes that noise hid."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import Direction, Dof, modal_assurance
from vgvt.identification import run_identifier
from vgvt.identification.example import Example
from vgvt_identifiers.cfdd import Cfdd
from vgvt_identifiers.line_averages import averaged, lines_to_average
from vgvt_identifiers.output_spectra import Decomposition, ReferenceMatrix, force_referenced

SENSORS, LINES = 12, 60
FREQUENCY = np.linspace(5.0, 6.0, LINES)


def matrix(seed: int, variance: float, forces: int = 1) -> ReferenceMatrix:
    """One shape a force, rising and falling over the lines, in white noise of this variance an entry."""
    shapes = np.random.default_rng(1).standard_normal((SENSORS, forces))
    clean = shapes[:, :, None] / (1 + 4j * (FREQUENCY - 5.5))
    generator = np.random.default_rng(seed)
    noise = generator.standard_normal((2, *clean.shape)) * np.sqrt(variance / 2)
    dofs = tuple(Dof(n + 1, Direction.PLUS_Z) for n in range(SENSORS))
    values = clean + noise[0] + 1j * noise[1]
    return ReferenceMatrix(FREQUENCY, dofs, dofs[:forces], values, np.full(clean.shape, variance), ())


@pytest.mark.parametrize("forces", [1, 2])
def test_values_and_vectors_are_those_of_the_mean_of_the_matrices(forces: int) -> None:
    source = matrix(3, 0.2, forces)
    found = averaged(force_referenced(source), 7)
    assert found.frequency_hz.size == LINES // 7
    for k in range(LINES // 7):
        lines = source.values[:, :, 7 * k : 7 * k + 7]
        mean = np.einsum("drk,erk->de", lines, lines.conj()) / 7
        values, vectors = np.linalg.eigh(mean)
        np.testing.assert_allclose(found.values[:, k], values[::-1][:forces], rtol=1e-10)
        np.testing.assert_allclose(np.abs(vectors[:, -1].conj() @ found.vectors[k, :, 0]), 1.0, rtol=1e-10)
        assert found.frequency_hz[k] == pytest.approx(FREQUENCY[7 * k : 7 * k + 7].mean())


def test_noise_and_scatter_are_what_draws_show() -> None:
    clean = averaged(force_referenced(matrix(0, 0.0)), 6).values[0]
    draws = [averaged(force_referenced(matrix(seed, 0.1)), 6) for seed in range(400)]
    values, noise = (np.array([getattr(d, name)[0] for d in draws]) for name in ("values", "noise"))
    spread = (values - noise).std(axis=0) / clean
    # 400 draws: means are known within a twentieth of the spread, the spread itself within 3.5 %; ten means at once.
    np.testing.assert_array_less(np.abs((values - noise).mean(axis=0) - clean), 4 * spread * clean / 20)
    stated = np.mean([d.relative_std[0] * d.values[0] for d in draws], axis=0) / clean
    np.testing.assert_allclose(stated, spread, rtol=0.2)


def test_only_what_noise_hides_is_averaged_and_only_once() -> None:
    quiet, loud = force_referenced(matrix(1, 1e-4)), force_referenced(matrix(1, 0.3))
    middle = LINES // 2
    assert lines_to_average(quiet, middle, 0, 0.8) == 1
    lines = lines_to_average(loud, middle, 0, 0.8)
    assert lines > 1
    means: Decomposition = averaged(loud, lines)
    assert lines_to_average(means, means.frequency_hz.size // 2, 0, 0.8) == 1
    with pytest.raises(ValueError, match="once more"):
        averaged(means, 2)


def test_a_mode_whose_single_lines_have_no_shape_is_found() -> None:
    example = Example(
        frequency_hz=(6.0, 14.0, 24.0),
        damping_ratio=(0.02,) * 3,
        stations=6,
        sample_rate_hz=100.0,
        duration_s=120.0,
        sweep_s=110.0,
        noise_m_s2=3.0,
    )
    model = run_identifier(Cfdd(), example.campaign())
    np.testing.assert_allclose(model.natural_frequency_hz, example.frequency_hz, rtol=5e-3)
    averages = [flag for flag in model.flags[0] if flag.startswith("lines_averaged")]
    assert len(averages) == 1
    assert model.natural_frequency_std_hz is not None
    assert model.damping_ratio_std is not None
    assert abs(model.natural_frequency_hz[0] - 6.0) < 3 * model.natural_frequency_std_hz[0]
    assert abs(model.damping_ratio[0] - 0.02) < 3 * model.damping_ratio_std[0]
    assert modal_assurance(model.shapes, example.modes().shapes)[0, 0] > 0.95
