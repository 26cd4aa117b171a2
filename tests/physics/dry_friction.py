"""A linear system with rigid Coulomb friction on a few coordinates, step by step: an oracle with hard sticking.

The system moves by its exact matrix exponential under a friction torque that is held through each step: the
torque that brings every joint to rest at the end of the step, or as much of it as the joint can bear, by
projected Gauss-Seidel (implicit time stepping after Moreau; Acary and Brogliato, Numerical
Methods for Nonsmooth Dynamical Systems, 2008, chapter 10). First order in the step.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
from harmonic_balance import Array, Vibrator


def rubbed(
    system: Vibrator, friction: float, volts: Array, hz: Array, seconds: float, step_s: float, kept_rate_hz: float
) -> Array:
    """Outputs (cases, outputs, samples) of cases of volts (cases,) at hz (cases,), friction torque on every joint.

    The command of a case is that of ``shaken_aircraft.stepped``.
    """
    n = system.state.shape[0]
    half = n // 2
    steps = round(seconds / step_s)
    every = round(1.0 / (kept_rate_hz * step_s))
    # Exact for a command that is straight between steps.
    joints = system.select.shape[0]
    block = np.zeros((n + 2 + joints, n + 2 + joints))
    block[:n, :n], block[:n, n], block[n, n + 1] = system.state, system.command, 1.0 / step_s
    block[:n, n + 2 :] = system.entry
    exact = scipy.linalg.expm(block * step_s)
    propagate, held, ramp, rubbing = exact[:n, :n], exact[:n, n], exact[:n, n + 1], exact[:n, n + 2 :]
    speed = np.hstack([np.zeros((joints, half)), system.select[:, :half]])
    mobility = speed @ rubbing
    time = np.arange(steps + 1) * step_s
    grown = np.sin(0.5 * np.pi * np.minimum(time, 1.0)) ** 2
    command = volts[:, None] * grown * np.cos(2 * np.pi * hz[:, None] * time)
    state = np.zeros((n, hz.size))
    torque = np.zeros((joints, hz.size))
    kept = np.empty((steps // every + 1, system.output.shape[0], hz.size))
    for k in range(steps):
        u = command[:, k]
        forced = system.feedthrough[:, None] * u
        before = torque
        moved = propagate @ state + np.outer(held, u) + np.outer(ramp, command[:, k + 1] - u)
        torque = _stopping(speed @ moved, mobility, torque, friction)
        if k % every == 0:
            # The torque of the instant is the mean of those before and after it.
            kept[k // every] = system.output @ state + forced + system.passed @ (before + torque) / 2
        state = moved + rubbing @ torque
    return np.asarray(kept[: steps // every].transpose(2, 1, 0))


def _stopping(speed: Array, mobility: Array, torque: Array, bound: float) -> Array:
    """The torques (joints, cases) within ``bound`` that stop the joints, or come as near to it as they can."""
    torque = torque.copy()
    for _ in range(6):
        for j in range(torque.shape[0]):
            others = speed[j] + mobility[j] @ torque - mobility[j, j] * torque[j]
            torque[j] = np.clip(-others / mobility[j, j], -bound, bound)
    return torque
