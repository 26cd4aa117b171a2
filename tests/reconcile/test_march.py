"""Marched reactions against a Runge-Kutta solution of the same oscillator, and against Den Hartog's for friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.fft
from numpy.typing import NDArray

from vgvt.reconcile.mechanics.joints import Joints
from vgvt.reconcile.mechanics.law import Law
from vgvt.reconcile.mechanics.march import Memory, marched
from vgvt.reconcile.mechanics.response import Matrices, accelerances
from vgvt.reconcile.mechanics.run_march import Push, marched_run
from vgvt.reconcile.prediction.levels import level_accelerances

INERTIA, STIFFNESS, DAMPING = 0.3, 2000.0, 0.8
# Den Hartog has no damping but friction: little enough for that, enough to come to rest within twice the record.
SLIGHT = 0.25
RATE = 2000.0
Array = NDArray[np.float64]


def memory(damping: float = DAMPING) -> Memory:
    """One degree of freedom that is pushed and seen at its own coordinate."""
    pole = np.roots([INERTIA, damping, STIFFNESS])[:1]
    assert pole.imag > 0
    residue = 1 / (INERTIA * (pole - pole.conj()))
    return Memory(pole, 2 * np.ones((1, 1)) * residue, np.ones((1, 1), dtype=complex), np.zeros((1, 1)))


def linear_motion(force: Array, damping: float = DAMPING) -> Array:
    """Motion (N,) of the oscillator under a force (N,) that starts from rest."""
    count = 2 * force.size
    omega = 2 * np.pi * scipy.fft.rfftfreq(count, 1 / RATE)
    answer = 1 / (STIFFNESS + 1j * omega * damping - INERTIA * omega**2)
    return np.asarray(scipy.fft.irfft(scipy.fft.rfft(force, count) * answer, count)[: force.size])


def sweep(size: float, time: Array) -> Array:
    """From 6 to 20 Hz in three seconds; the oscillator is at 13 Hz. Then it rings down."""
    phase = 2 * np.pi * (6 * time + 14 * time**2 / 6)
    return np.asarray(size * np.sin(phase) * (time < 3) * np.minimum(1, time / 0.2) * np.clip((3 - time) / 0.2, 0, 1))


@pytest.mark.parametrize("size", [1.0, 12.0])
@pytest.mark.parametrize(
    "law",
    [
        Law(STIFFNESS, cubic=3e6),
        Law(STIFFNESS, cubic=3e6, rest=-8e-3),
        Law(STIFFNESS, play=1e-3, rest=-2e-3),
        Law(STIFFNESS, play=1e-3, cubic=1e6, rest=-4e-3),
    ],
)
def test_meets_the_ordinary_differential_equation(law: Law, size: float) -> None:
    time = np.arange(round(4 * RATE)) / RATE
    force = sweep(size, time)
    modelled = replace(law, modelled=STIFFNESS)
    plain = linear_motion(force)
    extra = marched(plain[None, None], memory(), [[modelled]], 1 / RATE)[0, 0]
    found = plain - linear_motion(extra)

    def torque(x: float) -> float:
        pressed = x - min(max(x, -law.play), law.play)
        return law.stiffness * pressed + law.cubic * pressed**3

    # Four stages of Runge and Kutta over every second sample: forces are known at the middle of each step.
    x, v, h, solved = 0.0, 0.0, 2 / RATE, [0.0]
    for k in range(0, time.size - 2, 2):
        push = force[k : k + 3] + torque(law.rest)

        def bent(x: float, v: float, f: float) -> float:
            return (f - DAMPING * v - torque(law.rest + x)) / INERTIA

        a1 = bent(x, v, push[0])
        a2 = bent(x + h / 2 * v, v + h / 2 * a1, push[1])
        a3 = bent(x + h / 2 * v + h * h / 4 * a1, v + h / 2 * a2, push[1])
        a4 = bent(x + h * v + h * h / 2 * a2, v + h * a3, push[2])
        x += h * v + h * h / 6 * (a1 + a2 + a3)
        v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        solved.append(x)
    found, plain = found[: time.size - 1 : 2], plain[: time.size - 1 : 2]
    assert np.linalg.norm(found - solved) < 0.02 * np.linalg.norm(solved)
    if size > 5:
        assert np.linalg.norm(plain - solved) > 0.2 * np.linalg.norm(solved)


@pytest.mark.parametrize(("ratio", "load"), [(0.6, 1.2), (1.3, 3.0)])
def test_forced_friction_meets_den_hartog(ratio: float, load: float) -> None:
    """x k/T = sqrt(1/(1-r²)² - (M/T)² (sin(π/r) / (r (1 + cos(π/r))))²), without stops (Trans. ASME 53, 1931)."""
    friction, omega = 0.5, np.sqrt(STIFFNESS / INERTIA)
    turning = np.sin(np.pi / ratio) / (ratio * (1 + np.cos(np.pi / ratio)))
    expected = load / STIFFNESS * np.sqrt((1 / (1 - ratio**2)) ** 2 - (friction / load * turning) ** 2)
    time = np.arange(round(8 * RATE)) / RATE
    plain = linear_motion(load * np.cos(ratio * omega * time) * np.minimum(1, time), SLIGHT)
    law = Law(STIFFNESS, friction=friction, modelled=STIFFNESS)
    reaction = marched(plain[None, None], memory(SLIGHT), [[law]], 1 / RATE)[0, 0]
    found = plain - linear_motion(reaction, SLIGHT)
    assert np.abs(found[-2000:]).max() == pytest.approx(expected, rel=0.01)
    assert np.abs(reaction).max() <= friction * (1 + 1e-9)


def test_a_stuck_joint_does_not_move() -> None:
    """Below the slip torque nothing turns."""
    time = np.arange(round(3 * RATE)) / RATE
    plain = linear_motion(0.4 * np.cos(60 * time) * np.minimum(1, time))
    law = Law(STIFFNESS, friction=0.5, modelled=STIFFNESS)
    reaction = marched(plain[None, None], memory(), [[law]], 1 / RATE)[0, 0]
    assert np.abs(plain - linear_motion(reaction))[1000:].max() < 0.02 * np.abs(plain).max()


@pytest.mark.parametrize(("between", "stiffer"), [(4e-5, 1.0), (1.3e-4, 100.0)])
def test_joints_yield_to_each_other(between: float, stiffer: float) -> None:
    """Without modes, by their flexibilities alone: g = k (free - Y g), of two joints at once, however stiff."""
    yields, stiffness = np.array([[1e-4, between], [between, 2e-4]]), stiffer * np.array([1000.0, 1500.0])
    still = Memory(np.array([-1.0 + 1.0j]), np.zeros((2, 1)), np.zeros((1, 2), dtype=complex), yields)
    free = np.array([[[1e-3], [2e-3]]]) * np.minimum(1, np.arange(400) / 200)
    found = marched(free, still, [[Law(k) for k in stiffness]], 1 / RATE)
    wanted = np.linalg.solve(np.eye(2) + stiffness[:, None] * yields, stiffness * free[0, :, -1])
    # At every step of the rise, after thirty turns: what lags would be right only once it is over.
    np.testing.assert_allclose(found[0, :, 1:], wanted[:, None] * np.minimum(1, np.arange(1, 400) / 200), rtol=1e-3)


def structure(extra: Array | None = None, damping: float = 0.5) -> Matrices:
    """Four coordinates, two sensors; ``extra`` (4, 4) more stiffness."""
    stream = np.random.default_rng(3)
    a, b = stream.standard_normal((2, 4, 4))
    stiffness = 4000 * (a @ a.T + np.eye(4)) + (0 if extra is None else extra)
    return Matrices(
        b @ b.T + np.eye(4), damping * np.eye(4), stiffness, stream.standard_normal(4), stream.standard_normal((4, 4)),
        stream.standard_normal((4, 4)), np.zeros(4),
    )  # fmt: skip


def test_joint_stiffness_is_that_of_the_assembled_structure() -> None:
    """A constant stiffness at the joints, by rank, with roving masses in two runs: as if it were in the matrix."""
    rows = np.random.default_rng(5).standard_normal((2, 4))
    runs, masses = (np.array([0, 1]), np.array([2, 3])), (np.array([0.02, 0.03]), np.array([0.05, 0.0]))
    omega = 2 * np.pi * np.linspace(1, 40, 60)
    added = np.array([300.0, 700.0])
    wanted = accelerances(structure(rows.T @ np.diag(added) @ rows), omega, runs, masses)
    joints = Joints(((),), rows, np.zeros(2), np.zeros((4, 2)), np.zeros((2, 2)))
    shown = np.broadcast_to(added[:, None], (2, 2, omega.size)).astype(complex)
    found = level_accelerances(structure(), joints, shown, omega, runs, masses)
    np.testing.assert_allclose(found, wanted, rtol=1e-6, atol=1e-9)


def test_a_joint_that_the_model_has_too_soft_shows_the_difference_at_every_level() -> None:
    """A linear law stiffer than the model's: κ is the difference, whatever the force."""
    rows = np.array([[0.3, -0.2, 0.5, 0.1]])
    law = Law(1500.0, modelled=1000.0)
    joints = Joints(((law,),), rows, np.zeros(1), np.zeros((4, 1)), np.zeros((1, 1)))
    time = np.arange(round(10 * RATE)) / RATE
    force = sweep(1.0, time)
    for level in (1, 4):
        push = Push(level * force, RATE, np.arange(65, 195, 10), 20.0)
        shown, _ = marched_run(structure(damping=30.0), joints, (law,), push)
        np.testing.assert_allclose(shown, 500.0, rtol=0.02)


@pytest.mark.parametrize(("kg", "most"), [(0.0, 1e-5), (2.0, 1e-3)])
def test_what_the_coordinates_miss_is_felt_between_sensors_and_joints(kg: float, most: float) -> None:
    """Fast modes as static flexibility, against the structure that has them, the joints' stiffness in its matrix.

    Between two sensors it is left out, which is what heavy ones are off by.
    """
    g, fast = np.random.default_rng(11), 1e9
    slow = structure()
    axis, rows, drive = np.ones((4, 1)) * [1.0], np.array([[1000.0], [-700.0]]), np.array([1.0])
    seen = g.standard_normal((2, 4))
    pad = np.zeros((4, 1))
    whole = Matrices(
        np.block([[slow.mass, pad], [pad.T, np.eye(1)]]), np.block([[slow.damping, pad], [pad.T, np.zeros((1, 1))]]),
        np.block([[slow.stiffness, pad], [pad.T, fast * np.eye(1)]]), np.append(slow.drive, drive),
        np.hstack([slow.axis, axis]), np.hstack([slow.tilt, pad]), np.zeros(4),
    )  # fmt: skip
    added, joined = np.array([3e4, 5e4]), np.hstack([seen, rows])
    runs, masses = (np.array([0, 1]), np.array([2, 3])), (np.full(2, kg), np.full(2, kg))
    omega = 2 * np.pi * np.linspace(1, 40, 60)
    stiffer = replace(whole, stiffness=whole.stiffness + joined.T @ np.diag(added) @ joined)
    wanted = accelerances(stiffer, omega, runs, masses)
    joints = Joints(((),), seen, rows @ drive / fast, axis @ rows.T / fast, rows @ rows.T / fast)
    shown = np.broadcast_to(added[:, None], (2, 2, omega.size)).astype(complex)
    found = level_accelerances(replace(slow, spare=axis @ drive / fast), joints, shown, omega, runs, masses)
    assert np.linalg.norm(found - wanted) < most * np.linalg.norm(wanted)
