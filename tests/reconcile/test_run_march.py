"""A run with a nonlinear joint whose record ends ringing, against the whole system stepped by Runge and Kutta."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

from vgvt.reconcile.mechanics.ending import Ending, left_out
from vgvt.reconcile.mechanics.joints import Joints
from vgvt.reconcile.mechanics.law import Law
from vgvt.reconcile.mechanics.response import Matrices, loaded_by
from vgvt.reconcile.mechanics.run_march import Push, _decaying, marched_run
from vgvt.reconcile.prediction.levels import level_accelerances

Array = np.ndarray
RATE_HZ, LENGTH_S, TAPER_S = 250.0, 10.0, 1.0
SAMPLES, TAPERED = round(RATE_HZ * LENGTH_S), round(RATE_HZ * TAPER_S)
LINES = np.arange(36, 110, 4)
HZ = LINES * RATE_HZ / SAMPLES
JOINT, SENSOR_KG = np.array([[0.8, -0.5, 0.3]]), 0.05
CUBIC = Law(60.0, cubic=4e6, modelled=60.0)
PLAY = Law(400.0, play=8e-4, rest=-1.2e-3, modelled=400.0)


def structure() -> Matrices:
    """Modes at 5, 8.4 and 12 Hz with 0.4 to 1 % of damping; two sensors and a drive."""
    g = np.random.default_rng(4)
    back = np.linalg.inv(np.eye(3) + 0.3 * g.standard_normal((3, 3)))
    omega, ratio = 2 * np.pi * np.array([5.0, 8.4, 12.0]), np.array([0.01, 0.004, 0.01])
    axis = g.standard_normal((2, 3))
    return Matrices(
        back.T @ back, back.T @ np.diag(2 * ratio * omega) @ back, back.T @ np.diag(omega**2) @ back,
        g.standard_normal(3), axis, g.standard_normal((2, 3)), np.zeros(2),
    )  # fmt: skip


def sweep() -> Array:
    """From 3 to 12 Hz in 9.6 s, then nothing: too short a rest for anything to die out."""
    t = np.arange(SAMPLES) / RATE_HZ
    phase = 2 * np.pi * (3 * t + 0.5 * 9 / 9.6 * t**2)
    return np.asarray(np.sin(phase) * np.sin(np.pi / 2 * np.clip(np.minimum(t, 9.6 - t) / 0.3, 0, 1)) ** 2)


def recorded(m: Matrices, law: Law, force: Array, finer: int = 16) -> Array:
    """Readings (2, samples) of the structure with sensors on it and the joint's law, from the equations of motion."""
    heavy = m.mass + SENSOR_KG * m.axis.T @ m.axis
    fine = np.fft.irfft(np.pad(np.fft.rfft(force), (0, (finer - 1) * force.size // 2)), finer * force.size) * finer
    h = 2 / (finer * RATE_HZ)
    inverse = np.linalg.inv(heavy)

    def rate(state: Array, push: float) -> Array:
        q, v = state[:3], state[3:]
        x = float(JOINT[0] @ q)
        extra = float(law.elastic(np.array(law.rest + x))) - law.load - law.modelled * x
        return np.concatenate([v, inverse @ (m.drive * push - m.damping @ v - m.stiffness @ q - JOINT[0] * extra)])

    state, out = np.zeros(6), []
    for k in range(0, fine.size - 2, 2):
        if k % finer == 0:
            out.append(m.axis @ rate(state, fine[k])[3:] + m.tilt @ state[:3])
        a = rate(state, fine[k])
        b = rate(state + h / 2 * a, fine[k + 1])
        c = rate(state + h / 2 * b, fine[k + 1])
        d = rate(state + h * c, fine[k + 2])
        state = state + h / 6 * (a + 2 * b + 2 * c + d)
    return np.array(out).T


def window(tapered: int) -> Array:
    out = np.ones(SAMPLES)
    out[SAMPLES - tapered :] = 0.5 * (1 + np.cos(np.pi * (np.arange(tapered) + 0.5) / max(tapered, 1)))
    return out


@pytest.mark.parametrize(
    ("law", "tapered", "padded"),
    [
        (CUBIC, TAPERED, 1.0),
        pytest.param(CUBIC, 0, 1.0, marks=pytest.mark.slow),
        pytest.param(PLAY, TAPERED, 1.0, marks=pytest.mark.slow),
        (PLAY, 0, 1.0),
        # A run shorter than the longest of its campaign: zeros behind its record, and as many lines more between.
        (CUBIC, TAPERED, 1.5),
        (CUBIC, 0, 2.0),
        pytest.param(PLAY, TAPERED, 2.0, marks=pytest.mark.slow),
        pytest.param(PLAY, 0, 1.5, marks=pytest.mark.slow),
    ],
)
def test_a_joint_is_foretold_to_the_end_of_the_record(law: Law, tapered: int, padded: float) -> None:
    """As the quotient of tapered spectra has it: with the sensors on, and with what it leaves ringing."""
    m, force = structure(), sweep()
    spectra = [np.fft.rfft(x * window(tapered))[..., LINES] for x in (recorded(m, law, force), force)]
    read = spectra[0] / spectra[1]
    ending = Ending.of(force, RATE_HZ, tapered, HZ, spectra[1])
    joints = Joints(((law,),), JOINT, np.zeros(1), np.zeros((2, 1)), np.zeros((1, 1)))
    run, masses = (np.arange(2),), (np.full(2, SENSOR_KG),)
    long, lines = np.pad(force, (0, round((padded - 1) * SAMPLES))), np.rint(padded * LINES).astype(int)
    np.testing.assert_allclose(lines / long.size, LINES / SAMPLES)

    def foretold(loaded: Matrices, ending: Ending | None) -> Array:
        shown, rung = marched_run(loaded, joints, (law,), Push(long, RATE_HZ, lines, 12.0, ending))
        return np.asarray(level_accelerances(m, joints, shown[None], 2 * np.pi * HZ, run, masses) + rung)

    heavy, omega = loaded_by(m, run[0], masses[0]), 2 * np.pi * HZ
    found = foretold(heavy, ending) + left_out(m, omega, run, masses, (ending,))
    linear = level_accelerances(m, joints, np.zeros((1, 1, HZ.size), dtype=complex), omega, run, masses)
    # Where the taper touches the force the analysis looks at nothing.
    clear = HZ < 10.5
    size_of = np.abs(read[:, clear]).max()

    def off(a: Array) -> float:
        return float(np.abs(a - read)[:, clear].max() / size_of)

    assert off(linear) > 0.1
    assert off(found) < 2e-3
    # Neither the ends nor the sensors are of no account.
    plain = left_out(m, omega, run, masses, (ending,))
    assert off(foretold(heavy, None) + plain) > 0.05
    assert off(foretold(m, ending) + plain) > 0.05


@pytest.mark.parametrize("law", [CUBIC, PLAY, replace(CUBIC, rest=0.0123, friction=0.4)])
@pytest.mark.parametrize("tapered", [TAPERED, 0])
def test_a_run_that_nothing_drives_has_no_answer(law: Law, tapered: int) -> None:
    """What a joint does at rest is round-off: the quotient of that and of no force had been taken."""
    m, still = structure(), np.zeros(SAMPLES)
    joints = Joints(((law,),), JOINT, np.zeros(1), np.zeros((2, 1)), np.zeros((1, 1)))
    ending = Ending.of(still, RATE_HZ, tapered, HZ, np.zeros(LINES.size, dtype=complex))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        shown, rung = marched_run(m, joints, (law,), Push(still, RATE_HZ, LINES, 12.0, ending))
    assert shown.shape == (1, LINES.size) and np.isnan(shown).all()
    assert rung.shape == (2, LINES.size) and not rung.any()


@pytest.mark.parametrize("modelled", [5e3, 1e5, 1e6])
def test_a_joint_that_runs_away_is_no_number(modelled: float) -> None:
    """Softer than what holds it: its motion grows without end, to what is a number still or beyond."""
    m = structure()
    mad = replace(CUBIC, stiffness=1.0, cubic=0.0, modelled=modelled)
    joints = Joints(((mad,),), JOINT, np.zeros(1), np.zeros((2, 1)), np.zeros((1, 1)))
    shown, _ = marched_run(m, joints, (mad,), Push(sweep(), RATE_HZ, LINES, 12.0))
    assert not np.isfinite(shown).any()


def test_a_mode_of_the_band_that_is_driven_is_no_number() -> None:
    """Without a warning on the way: a trial step of a fit may come by there."""
    m = structure()
    driven = replace(m, damping=m.damping - 80.0 * m.mass)
    joints = Joints(((PLAY,),), JOINT, np.zeros(1), np.zeros((2, 1)), np.zeros((1, 1)))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        shown, _ = marched_run(driven, joints, (PLAY,), Push(sweep(), RATE_HZ, LINES, 12.0))
    assert not np.isfinite(shown).any()


def test_a_pole_above_the_band_that_is_driven_does_not_grow() -> None:
    """As one with damping: within the band it is nothing."""
    m = structure()
    whole = [np.block([[x, np.zeros((3, 1))], [np.zeros((1, 3)), np.eye(1)]]) for x in (m.mass, m.damping, m.stiffness)]
    omega = 2 * np.pi * 30.0
    shown = []
    for ratio in (-0.01, 0.01):
        mass, damping, stiffness = (x.copy() for x in whole)
        damping[3, 3], stiffness[3, 3] = 2 * ratio * omega, omega**2
        wide = [np.hstack([x, np.full((len(x), 1), 0.1)]) for x in (m.axis, m.tilt, JOINT)]
        high = Matrices(mass, damping, stiffness, np.append(m.drive, 0.1), wide[0], wide[1], np.zeros(2))
        joints = Joints(((PLAY,),), wide[2], np.zeros(1), np.zeros((2, 1)), np.zeros((1, 1)))
        shown.append(marched_run(high, joints, (PLAY,), Push(sweep(), RATE_HZ, LINES, 12.0))[0])
    assert np.abs(shown[1]).max() > 10
    # It is given the other one's pole: what is left is round-off.
    np.testing.assert_allclose(shown[0], shown[1], rtol=1e-6)


def test_decay_by_blocks_is_decay_at_every_step() -> None:
    g = np.random.default_rng(6)
    pole = -g.uniform(0.01, 30.0, 9) + 1j * g.uniform(0.0, 900.0, 9)
    shares = g.standard_normal((2, 9)) + 1j * g.standard_normal((2, 9))
    for count in (1, 2, 9, 1000, 1001):
        time = np.arange(count) * 2e-3
        wanted = (shares @ np.exp(np.outer(pole, time))).real
        assert np.abs(_decaying(shares, pole, time) - wanted).max() < 1e-11 * np.abs(shares).sum()
