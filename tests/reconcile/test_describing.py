"""Describing functions against Fourier's integral of the law itself, and against what the textbooks print."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.reconcile.mechanics.describing import (
    Law,
    cubic_stiffness,
    describing,
    drag_stiffness,
    first_harmonic,
    friction_stiffness,
    mean_displacement,
    play_stiffness,
)

STIFFNESS = 2000.0
AMPLITUDE = np.array([1e-3, 2e-3, 5e-3, 2e-2])
PHASE = 2 * np.pi * np.arange(4096) / 4096


@pytest.mark.parametrize("cubic", [0.0, 1e6, 1e8])
def test_unloaded_cubic_is_three_quarters(cubic: float) -> None:
    found = describing(Law(STIFFNESS, cubic=cubic), AMPLITUDE)
    np.testing.assert_allclose(found, cubic_stiffness(STIFFNESS, cubic, AMPLITUDE), rtol=1e-9)


def test_unloaded_play_is_the_textbook_curve() -> None:
    found = describing(Law(STIFFNESS, play=1.5e-3), AMPLITUDE)
    np.testing.assert_allclose(found, play_stiffness(STIFFNESS, 1.5e-3, AMPLITUDE), rtol=2e-3, atol=0.05)
    assert abs(found[0]) < 1e-6


def test_friction_and_drag_are_the_first_harmonic_of_their_force() -> None:
    """The force follows the velocity's sign, or its square with sign."""
    for amplitude in AMPLITUDE:
        moved = amplitude * np.sin(PHASE)
        speed = 30.0 * amplitude * np.cos(PHASE)
        rubbed = first_harmonic(moved, 0.4 * np.sign(speed))
        assert rubbed == pytest.approx(1j * float(friction_stiffness(0.4, np.array(amplitude))), rel=1e-3)
        dragged = first_harmonic(moved, 0.7 * np.abs(speed) * speed)
        assert dragged == pytest.approx(1j * float(drag_stiffness(0.7, np.array(amplitude), np.array(30.0))), rel=1e-6)
    assert describing(Law(STIFFNESS, friction=0.4), AMPLITUDE)[1] == pytest.approx(
        STIFFNESS + 1j * 4 * 0.4 / (np.pi * AMPLITUDE[1])
    )


def test_a_loaded_cubic_swings_about_where_its_mean_force_holds_the_load() -> None:
    """k b + k3 (b³ + 3/2 b A²) is the load, and κ = k + 3 k3 b² + 3/4 k3 A²."""
    law = Law(STIFFNESS, cubic=2e7, rest=-4e-3)
    b = mean_displacement(law, AMPLITUDE)
    np.testing.assert_allclose(STIFFNESS * b + 2e7 * (b**3 + 1.5 * b * AMPLITUDE**2), law.load, rtol=1e-9)
    expected = STIFFNESS + 3 * 2e7 * b**2 + 0.75 * 2e7 * AMPLITUDE**2
    np.testing.assert_allclose(describing(law, AMPLITUDE), expected, rtol=1e-9)
    assert abs(b[-1]) < 0.5 * abs(law.rest)


def test_a_load_holds_play_shut_until_the_motion_lifts_it() -> None:
    """A joint pressed against a stop is the stop's spring for small motions and softer once it leaves it."""
    law = Law(STIFFNESS, play=1e-3, rest=-3e-3)
    found = describing(law, np.array([1e-4, 1.9e-3, 1e-2]))
    np.testing.assert_allclose(found[:2], STIFFNESS, rtol=1e-6)
    assert 0.5 * STIFFNESS < found[2].real < 0.95 * STIFFNESS


def test_more_weight_moves_a_joint_to_where_it_is_held() -> None:
    law = Law(STIFFNESS, cubic=2e7, play=1e-3, rest=-4e-3)
    more = law.loaded(-0.5)
    assert more.load == pytest.approx(law.load - 0.5, rel=1e-9)
    assert more.rest < law.rest
