"""The Stahle-Forlifer equations against exact systems of two close modes."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import modal_assurance
from vgvt_identifiers.stahle_forlifer import participation_matrix, separate_quadratures

FREQUENCY = np.array([33.13, 33.53])  # the torsion pair of the GARTEUR SM-AG19
DAMPING = np.array([0.008, 0.012])
SHAPES = np.array([[1.0, 0.8, -0.3, 0.4], [-0.9, 0.7, 0.5, 0.2]])


def quadrature(differentiations: int, structural: bool = False) -> np.ndarray:
    """Imaginary part (2, 4) at both natural frequencies of an exact system, drive at the first point."""
    omega = 2 * np.pi * FREQUENCY
    at = omega[:, None, None]
    loss = 1j * 2 * DAMPING[:, None] * (omega[:, None] ** 2 if structural else omega[:, None] * at)
    modal = SHAPES * SHAPES[:, :1] / (omega[:, None] ** 2 - at**2 + loss)
    return np.asarray(((1j * at[:, 0]) ** differentiations * modal.sum(axis=1)).imag)


def alone(differentiations: int) -> np.ndarray:
    """Imaginary part (2, 4) of each mode alone at its own natural frequency."""
    omega = 2 * np.pi * FREQUENCY[:, None]
    modal = SHAPES * SHAPES[:, :1] / (1j * 2 * DAMPING[:, None] * omega**2)
    return np.asarray(((1j * omega) ** differentiations * modal).imag)


@pytest.mark.parametrize("differentiations", [0, 2])
@pytest.mark.parametrize("damping", ["viscous", "structural"])
def test_the_correction_is_exact_for_the_system_it_assumes(damping: str, differentiations: int) -> None:
    share = participation_matrix(FREQUENCY, DAMPING, damping, differentiations)  # type: ignore[arg-type]
    found = separate_quadratures(quadrature(differentiations, damping == "structural"), share)
    np.testing.assert_allclose(found, alone(differentiations), rtol=1e-9)


def test_accelerations_need_the_further_square_of_the_frequency_ratio() -> None:
    """Two modes far apart show it best: without r^2 the lower mode leaks into the upper one's shape."""
    frequency, damping = np.array([8.0, 16.0]), np.array([0.05, 0.05])
    displacement = participation_matrix(frequency, damping, differentiations=0)
    acceleration = participation_matrix(frequency, damping, differentiations=2)
    ratio = frequency[:, None] / frequency[None, :]
    np.testing.assert_allclose(acceleration, displacement * ratio**2, rtol=1e-12)
    np.testing.assert_allclose(np.diag(acceleration), 1.0, rtol=1e-12)


def test_close_modes_are_better_after_the_correction() -> None:
    raw = quadrature(2)
    share = participation_matrix(FREQUENCY, DAMPING)
    before = np.diag(modal_assurance(raw, SHAPES))
    after = np.diag(modal_assurance(separate_quadratures(raw, share), SHAPES))
    assert before.min() < 0.9
    assert after.min() > 1 - 1e-12


def test_modes_far_apart_are_left_as_they_are() -> None:
    share = participation_matrix(np.array([8.0, 16.0, 31.0]), np.array([0.005, 0.005, 0.005]))
    np.testing.assert_allclose(share, np.eye(3), atol=1e-3)


def test_a_mobility_has_no_quadrature_response_at_resonance() -> None:
    with pytest.raises(ValueError, match="differentiations must be 0"):
        participation_matrix(FREQUENCY, DAMPING, differentiations=1)
