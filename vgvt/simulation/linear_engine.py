"""The linear engine: exact response of the linearised rig to the command, a cubic spline between its samples.

The state-space model is solved mode by mode: each pole is a scalar recursion,
exact for a piecewise cubic command. (Held straight between samples, a 35 Hz
command at 1 kHz would carry images of 1e-3 that alias back onto the record and
show wherever the force drops out.)
"""

from __future__ import annotations

import numpy as np
import scipy.interpolate
import scipy.linalg
import scipy.signal
from numpy.typing import NDArray

from vgvt.simulation.state_space import StateSpace

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)


def respond(model: StateSpace, command_v: NDArray[np.float64], sample_rate_hz: float) -> NDArray[np.float64]:
    """Outputs (outputs, samples) to a command (samples,) in volts, from rest."""
    poles, right = scipy.linalg.eig(model.state_matrix)
    modal_input = np.linalg.solve(right, model.input_matrix.astype(complex))
    modal_output = model.output_matrix @ right
    step = 1.0 / sample_rate_hz
    spline = scipy.interpolate.CubicSpline(np.arange(command_v.size) * step, command_v)
    rising_powers = spline.c[::-1]
    # Complex poles come in conjugate pairs: solve one of each and take twice the real part.
    upper = poles.imag >= 0
    weight = np.where(poles.imag[upper] > 0, 2.0, 1.0)
    response = model.feedthrough[:, None] * command_v
    for pole, gain, row, count in zip(poles[upper], modal_input[upper], modal_output.T[upper], weight, strict=True):
        state = np.zeros(command_v.size, dtype=complex)
        forcing = polynomial_response(complex(pole), step) @ rising_powers
        state[1:] = scipy.signal.lfilter([1.0], [1.0, -np.exp(pole * step)], forcing)
        for output, share in zip(response, count * row * gain, strict=True):
            output += share.real * state.real - share.imag * state.imag
    return np.asarray(response)


def polynomial_response(pole: complex, step_s: float) -> NDArray[np.complex128]:
    """State after one step from rest of z' = pole z + t^j for j = 0 … 3, shape (4,)."""
    z = pole * step_s
    powers = np.arange(4)
    if abs(z) < 2.0:
        # The recursion below cancels for slow poles; quadrature is exact to round-off there.
        s = (_NODES + 1) / 2
        moments = (0.5 * _WEIGHTS * np.exp(z * (1 - s))) @ s[:, None] ** powers
    else:
        moments = np.empty(4, dtype=complex)
        moments[0] = np.expm1(z) / z
        for j in (1, 2, 3):
            moments[j] = (j * moments[j - 1] - 1) / z
    return np.asarray(moments * step_s ** (powers + 1))
