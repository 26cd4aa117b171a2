"""The MAC family is blind to scale and phase, and to nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vgvt.data import auto_mac, modal_assurance, modal_phase_collinearity


def shapes(seed: int, modes: int = 3, dofs: int = 8) -> np.ndarray:
    """Complex random shapes."""
    parts = np.random.default_rng(seed).standard_normal((2, modes, dofs))
    return parts[0] + 1j * parts[1]


@given(st.integers(0, 10**6), st.floats(1e-6, 1e6), st.floats(-3.2, 3.2))
def test_scale_and_phase_do_not_matter(seed: int, scale: float, phase: float) -> None:
    a, b = shapes(seed), shapes(seed + 1)
    turned = a * scale * np.exp(1j * phase)
    np.testing.assert_allclose(modal_assurance(turned, b), modal_assurance(a, b), atol=1e-12)
    np.testing.assert_allclose(modal_phase_collinearity(turned), modal_phase_collinearity(a), atol=1e-9)


@given(st.integers(0, 10**6))
def test_it_is_symmetric_between_zero_and_one_with_a_diagonal_of_ones(seed: int) -> None:
    mac = auto_mac(shapes(seed))
    np.testing.assert_allclose(mac, mac.T, atol=1e-14)
    np.testing.assert_allclose(np.diag(mac), 1.0)
    assert mac.min() >= 0
    assert mac.max() <= 1 + 1e-12


def test_it_is_the_squared_cosine() -> None:
    angle = np.radians([0, 30, 60, 90])
    second = np.column_stack([np.cos(angle), np.sin(angle)])
    np.testing.assert_allclose(modal_assurance(np.array([1.0, 0.0]), second)[0], np.cos(angle) ** 2, atol=1e-15)


def test_a_shape_of_zeros_is_like_nothing() -> None:
    assert modal_assurance(np.zeros(4), np.ones(4))[0, 0] == 0
    assert modal_phase_collinearity(np.zeros(4))[0] == 0


@pytest.mark.parametrize("value", [np.nan, np.inf, complex(0, np.nan)])
def test_a_shape_that_is_not_known_is_like_nobody_knows_what(value: complex) -> None:
    """Not like nothing: 0 would say that two shapes have been compared."""
    unknown = np.array([[1.0, value, 0.0, 2.0], [1.0, 1.0, 1.0, 1.0]])
    mac = modal_assurance(unknown, np.ones(4))[:, 0]
    assert np.isnan(mac[0]) and mac[1] == pytest.approx(1)
    np.testing.assert_array_equal(np.isnan(modal_phase_collinearity(unknown.astype(complex))), [True, False])


def test_shapes_at_other_points_are_refused() -> None:
    with pytest.raises(ValueError, match="share their DOFs"):
        modal_assurance(np.ones((2, 3)), np.ones((2, 4)))


def test_a_real_shape_is_collinear_and_a_travelling_wave_is_not() -> None:
    along = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    assert modal_phase_collinearity(np.sin(along) * np.exp(0.7j))[0] == pytest.approx(1)
    assert modal_phase_collinearity(np.exp(1j * along))[0] == pytest.approx(0, abs=1e-12)
