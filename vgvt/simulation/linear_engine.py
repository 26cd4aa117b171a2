"""The linear engine: exact response of the linearised rig to the command, straight between its samples.

The state-space model is solved mode by mode: each pole is a scalar recursion
with first-order hold, exact for a piecewise linear command (Franklin, Powell
and Workman, Digital Control of Dynamic Systems, section 6.3).
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
import scipy.signal
from numpy.typing import NDArray

from vgvt.simulation.state_space import StateSpace


def respond(model: StateSpace, command_v: NDArray[np.float64], sample_rate_hz: float) -> NDArray[np.float64]:
    """Outputs (outputs, samples) to a command (samples,) in volts, from rest."""
    poles, right = scipy.linalg.eig(model.state_matrix)
    modal_input = np.linalg.solve(right, model.input_matrix.astype(complex))
    modal_output = model.output_matrix @ right
    # Complex poles come in conjugate pairs: solve one of each and take twice the real part.
    upper = poles.imag >= 0
    weight = np.where(poles.imag[upper] > 0, 2.0, 1.0)
    response = model.feedthrough[:, None] * command_v
    step = 1.0 / sample_rate_hz
    for pole, gain, row, count in zip(poles[upper], modal_input[upper], modal_output.T[upper], weight, strict=True):
        state = _first_order_hold(complex(pole), step, command_v)
        response += count * (np.outer(row * gain, state)).real
    return np.asarray(response)


def _first_order_hold(pole: complex, step_s: float, command: NDArray[np.float64]) -> NDArray[np.complex128]:
    """State of z' = pole z + u from rest, u straight between samples, shape of ``command``."""
    decay = np.exp(pole * step_s)
    held = np.expm1(pole * step_s) / pole
    ramp = (held - step_s) / (pole * step_s)
    return np.asarray(scipy.signal.lfilter([ramp, held - ramp], [1.0, -decay], command.astype(complex)))
