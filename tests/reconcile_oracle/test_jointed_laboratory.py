"""The second laboratory's nonlinear joints against closed forms, an adaptive solver, and its own linear half."""

from __future__ import annotations

import jointed_laboratory as jointed
import numpy as np
import pytest
import second_laboratory as lab
from scipy.integrate import solve_ivp
from test_second_laboratory import miss, scenario

STIFFNESS, GAP_RAD = 2000.0, 2e-3


def rooted() -> lab.Rig:
    """The only run of the small scenario, its roots bending."""
    return lab.rig_of(jointed.jointed(scenario(8), STIFFNESS), 0)


def ratio(force: np.ndarray, motion: np.ndarray) -> np.ndarray:
    """A/F (sensors, lines) of whole records where the sweep is."""
    frequency = np.fft.rfftfreq(force.size, 1 / 250.0)
    inside = (frequency > 4.0) & (frequency < 34.0)
    return np.asarray(np.fft.rfft(motion, axis=1)[:, inside] / np.fft.rfft(force)[inside])


def test_without_a_law_the_records_are_those_of_the_frequency_domain() -> None:
    force, motion = jointed.recorded(rooted(), jointed.Cubic(0.0), 1.0)
    (run,) = lab.campaign_of(jointed.jointed(scenario(8), STIFFNESS)).runs
    assert miss(ratio(force, motion), ratio(run.samples[0], run.samples[1:])) < 3e-4


@pytest.mark.slow
def test_play_that_its_weight_keeps_shut_is_not_there_and_opens_beyond_that_weight() -> None:
    """What opens the joint is a dynamic torque of the wing's own weight about its root; not the gap."""
    rig, law = rooted(), jointed.Play(GAP_RAD, STIFFNESS)
    closed = ratio(*jointed.recorded(rig, jointed.Cubic(0.0), 1.0))
    assert miss(ratio(*jointed.recorded(rig, law, 1.0)), closed) < 1e-12
    assert miss(ratio(*jointed.recorded(rig, law, 8.0)), closed) > 0.05


def beam_of_two() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mass, damping and stiffness of two masses in a row; the first motion is the joint's."""
    stiffness = np.array([[2.0e3, 0.0], [0.0, 3.0e3]])
    return np.array([[1.0, 0.6], [0.6, 0.9]]), 2e-4 * stiffness + np.diag([0.5, 0.5]), stiffness


@pytest.mark.slow
@pytest.mark.parametrize(
    "law",
    [
        pytest.param(jointed.Cubic(4e6), id="cubic"),
        pytest.param(jointed.Play(0.02, 2.0e3), id="play"),
    ],
)
@pytest.mark.parametrize("load", [pytest.param(0.0, id="without load"), pytest.param(6.0, id="under load")])
def test_a_driven_joint_moves_as_an_adaptive_solver_says(law: jointed.Law, load: float) -> None:
    mass, damping, stiffness = beam_of_two()
    rest = law.rest(load, 2.0e3)
    time = np.arange(round(0.8 * law.rate_hz) + 1) / law.rate_hz
    force = 30.0 * np.sin(2 * np.pi * 6.0 * time) * np.minimum(2 * time, 1.0)
    push = np.array([0.2, 1.0])
    poles = jointed.poles_of(mass, damping, stiffness, np.column_stack([push, [1.0, 0.0]]))
    moving, state, _ = jointed.stepped(poles, force, np.eye(1, 2), law, np.array([rest]))

    def beyond(angle: float) -> float:
        if isinstance(law, jointed.Cubic):
            return law.cubic_n_m_per_rad3 * ((rest + angle) ** 3 - rest**3)
        half = law.gap_rad / 2
        return float(-law.stiffness * (np.clip(rest + angle, -half, half) - np.clip(rest, -half, half)))

    def flow(t: float, y: np.ndarray) -> np.ndarray:
        pushed = push * np.interp(t, time, force) - np.array([beyond(y[0]), 0.0])
        return np.concatenate([y[2:], np.linalg.solve(mass, pushed - damping @ y[2:] - stiffness @ y[:2])])

    kept = time[::40]
    exact = solve_ivp(flow, (0.0, time[-1]), np.zeros(4), "DOP853", kept, rtol=1e-10, atol=1e-13, max_step=5e-3).y
    found = (moving.out @ state).real[:, ::40]
    linear = (moving.out @ jointed.stepped(poles, force, np.eye(1, 2), jointed.Cubic(0.0), np.zeros(1))[1]).real
    assert miss(linear[:, ::40], exact) > 0.05, "the law must show"
    assert miss(found[:2], exact[:2]) < 2e-4


def test_at_rest_a_joint_carries_its_load() -> None:
    for load in (-9.0, 0.0, 4.0):
        angle = jointed.Cubic(1e7).rest(load, STIFFNESS)
        assert STIFFNESS * angle + 1e7 * angle**3 == pytest.approx(load, abs=1e-9)
        shut = jointed.Play(GAP_RAD, STIFFNESS).rest(load, STIFFNESS)
        beyond = shut - np.clip(shut, -GAP_RAD / 2, GAP_RAD / 2)
        assert STIFFNESS * beyond == pytest.approx(load, abs=1e-9)


def driven(friction_n: float, force_n: float, ratio_of_frequencies: float) -> np.ndarray:
    """Motion of one mass of 1 kg on 400 N/m with dry friction, driven until it repeats itself; the last second."""
    one, stiffness = np.eye(1), 400.0 * np.eye(1)
    poles = jointed.poles_of(one, 1e-9 * one, stiffness, np.ones((1, 2)))
    time = np.arange(round(10.0 * jointed.Friction.rate_hz) + 1) / jointed.Friction.rate_hz
    force = force_n * np.sin(ratio_of_frequencies * 20.0 * time)
    moving, state, _ = jointed.stepped(poles, force, np.eye(1), jointed.Friction(friction_n), np.zeros(1))
    return np.asarray((moving.out[:1] @ state).real[0, -2 * round(jointed.Friction.rate_hz) :])


@pytest.mark.slow
@pytest.mark.parametrize("speed", [0.6, 1.4])
def test_a_mass_that_slides_without_stops_has_den_hartogs_amplitude(speed: float) -> None:
    """Den Hartog, Trans. ASME 53, 1931: a = F/k √(V² − (M/F)² U²), friction and force in steady motion."""
    friction, force = 2.0, 10.0
    at_once = 1 / (1 - speed**2)
    delayed = np.sin(np.pi / speed) / (speed * (1 + np.cos(np.pi / speed)))
    expected = force / 400.0 * np.sqrt(at_once**2 - (friction / force) ** 2 * delayed**2)
    assert np.abs(driven(friction, force, speed)).max() == pytest.approx(expected, rel=0.01)


@pytest.mark.slow
def test_what_friction_can_hold_does_not_move() -> None:
    assert np.abs(driven(2.0, 1.9, 0.6)).max() < 2e-6 * 1.9 / 400.0


def clamped(rig: lab.Rig, run: int) -> lab.Rig:
    """The rig with both roots held by springs that hardly give."""
    del run
    own = np.eye(rig.push.size)
    rows = [own[j] for j in jointed.joint_coordinates(rig)]
    return rig.coupled(*(lab.Coupling(row, row, lambda omega: np.full(omega.size, 1e9 + 0j)) for row in rows))


@pytest.mark.slow
def test_roots_that_stick_are_held_and_those_that_slip_soon_have_their_own_stiffness() -> None:
    """What is driven so quietly that nothing slips is the same aircraft, its roots held; far beyond it, let go."""
    rig, law = rooted(), jointed.Friction(0.3)
    there = jointed.jointed(scenario(8), STIFFNESS)
    (held,), (soft,) = lab.campaign_of(there, (clamped,)).runs, lab.campaign_of(there).runs
    assert miss(ratio(held.samples[0], held.samples[1:]), ratio(soft.samples[0], soft.samples[1:])) > 0.5
    assert miss(ratio(*jointed.recorded(rig, law, 0.01)), ratio(held.samples[0], held.samples[1:])) < 0.01
    assert miss(ratio(*jointed.recorded(rig, law, 100.0)), ratio(soft.samples[0], soft.samples[1:])) < 0.1
