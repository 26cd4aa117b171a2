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

# |hλ| up to which Runge-Kutta 4 is stable for any damping: 2.78 on the real axis, 2.83 on the imaginary one.
_STABLE = 2.7


def substeps(poles: NDArray[np.complex128], sample_rate_hz: float, longest_step_s: float) -> int:
    """Steps a sample: no step longer than asked for, and all of the model's ``poles`` (n,), rad/s, stable."""
    step = min(longest_step_s, _STABLE / float(np.abs(poles).max()))
    return math.ceil(1.0 / (sample_rate_hz * step) - 1e-9)


def stepped_poles(poles: NDArray[np.complex128], step_s: float) -> NDArray[np.complex128]:
    """The poles, rad/s, that records stepped with ``step_s`` show in place of ``poles`` (n,)."""
    z = step_s * poles
    amplification = 1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4)))
    return np.asarray(np.log(amplification) / step_s)
