"""The time step, and what it does to the modes.

The engine steps with MuJoCo's fourth-order Runge–Kutta integrator. For a linear
system a step is the polynomial R(hA) of the state matrix, so the poles that
time-stepped records show can be read off exactly: log R(hλ)/h. Fourth order
leaves about (ωh)⁴/120 of a frequency, where a first-order symplectic step
shifts the coupled shaker modes through the half step by which back-EMF lags.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError

# More steps a sample than this is a model that nobody wants to wait for.
_MOST_STEPS = 64


def substeps(poles: NDArray[np.complex128], sample_rate_hz: float, longest_step_s: float) -> int:
    """The fewest steps a sample that are no longer than asked for and keep all ``poles`` (n,), rad/s, stable.

    A sample is what is read of the model: an instant of a converter that reads several for one that it delivers.

    The boundary of Runge-Kutta's stability is no circle, so the growth of every pole is
    evaluated. Raises InputError where the model would need more than 64 steps.
    """
    fewest = math.ceil(1.0 / (sample_rate_hz * longest_step_s) - 1e-9)
    for count in range(fewest, _MOST_STEPS + 1):
        # A rigid motion that is free to drift may stay where it is; nothing may grow.
        if np.abs(amplification(poles, 1.0 / (sample_rate_hz * count))).max() <= 1.0 + 1e-9:
            return count
    raise InputError(
        "simulation.engine = 'mujoco'",
        f"the fastest motion of this model ({np.abs(poles).max():.2g} rad/s) needs more than {_MOST_STEPS} time steps "
        f"each time it is read, {sample_rate_hz:g} times a second",
        "Use fewer cells a beam, more pitch_inertia_kg_m, a softer stinger, or simulation.engine = 'linear'.",
    )


def amplification(poles: NDArray[np.complex128], step_s: float) -> NDArray[np.complex128]:
    """What one step multiplies the motion of each pole (n,), rad/s, by."""
    z = step_s * poles
    return np.asarray(1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4))))


def stepped_poles(poles: NDArray[np.complex128], step_s: float) -> NDArray[np.complex128]:
    """The poles, rad/s, that records stepped with ``step_s`` show in place of ``poles`` (n,)."""
    return np.asarray(np.log(amplification(poles, step_s)) / step_s)
