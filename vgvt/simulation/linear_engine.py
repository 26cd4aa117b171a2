"""The linear engine: exact response of the linearised rig to the command, a cubic spline between its samples.

Each pole is a scalar recursion, exact for a piecewise cubic command. (Held
straight between samples, a 35 Hz command at 1 kHz would carry images of 1e-3
that alias back onto the record and show wherever the force drops out.)

The recursions of all modes add up to one impulse response an output, to a unit of one
B-spline of the command. Most modes have died out of it within milliseconds, so that it is
cheap to write down; the rest is one convolution an output, by Fourier transforms.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.interpolate
import scipy.linalg
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

from vgvt.simulation.state_space import StateSpace

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
# Samples written at once: as many as keep the work in the processor's cache.
_CHUNK_SAMPLES = 2048
# A mode that has decayed to this is below the round-off of the others.
_FORGOTTEN = np.log(1e-18)
# What a step of the spline holds of the four B-splines over it: rows t^0 … t^3, columns from the earliest centre.
_PIECES = np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, eq=False)
class Command:
    """A command as a cubic spline, ready to be sent through any number of models.

    ``samples_v`` (inputs, samples); ``splines`` (inputs, samples + 2) are the weights of the B-splines
    centred on one sample before the first to one after the last, ``spectra`` (inputs, lines)
    their transforms over ``length`` samples.
    """

    samples_v: Array
    splines: Array
    spectra: Complex
    length: int


def prepared(command_v: Array) -> Command:
    """The spline, not-a-knot at its ends, through a command (samples,) or (inputs, samples), volts."""
    samples = np.atleast_2d(command_v)
    count = samples.shape[1]
    curvature = scipy.interpolate.CubicSpline(np.arange(count), samples, axis=1)(np.arange(count), 2)
    splines = np.empty((samples.shape[0], count + 2))
    splines[:, 1:-1] = samples - curvature / 6
    splines[:, 0] = curvature[:, 0] + 2 * splines[:, 1] - splines[:, 2]
    splines[:, -1] = curvature[:, -1] + 2 * splines[:, -2] - splines[:, -3]
    length = next_fast_len(2 * splines.shape[1], real=True)
    return Command(samples, splines, np.asarray(rfft(splines, length, axis=1)), length)


def respond(model: StateSpace, command_v: Array | Command, sample_rate_hz: float) -> Array:
    """Outputs (outputs, samples) to a command (samples,) or (inputs, samples) in volts, from rest."""
    command = command_v if isinstance(command_v, Command) else prepared(command_v)
    samples = command.samples_v.shape[1]
    poles, right = scipy.linalg.eig(model.state_matrix)
    # Complex poles come in conjugate pairs: solve one of each and take twice the real part.
    upper = poles.imag >= 0
    gains = np.linalg.solve(right, model.inputs.astype(complex))[upper]
    poles = poles[upper]
    rows = model.output_matrix @ right[:, upper] * np.where(poles.imag > 0, 2.0, 1.0)
    first, settled = spline_pulse(poles, 1.0 / sample_rate_hz)
    # The splines go on before the first sample, where the command does not: take off what they would leave.
    before = (gains @ command.splines[:, :3] * first[:, ::-1]).sum(axis=1)
    weights = gains.T[:, None, :] * rows
    ways = np.vstack([*(weights * settled), rows * before])
    decays = free_decays(ways, poles / sample_rate_hz, samples)
    response = model.feedthrough_rows @ command.samples_v - decays[-rows.shape[0] :]
    for spectrum, weight, decay in zip(command.spectra, weights, np.split(decays, len(weights) + 1), strict=False):
        pulse = np.hstack([(weight @ first).real, decay[:, :-1]])
        response += irfft(rfft(pulse, command.length, axis=1) * spectrum, command.length, axis=1)[:, 2 : samples + 2]
    return np.asarray(response)


def spline_pulse(poles: Complex, step_s: float) -> tuple[Complex, Complex]:
    """Response of z' = pole z + u to a unit B-spline u, for ``poles`` (modes,), sample by sample.

    The first three samples, (modes, 3), from one before the spline's centre, and the
    fourth, (modes,), from which on the mode decays freely.
    """
    growth = np.exp(poles * step_s)[:, None]
    scale = step_s ** -np.arange(4.0)
    forcing = np.array([polynomial_response(complex(pole), step_s) * scale for pole in poles]) @ _PIECES
    states = [np.zeros_like(growth[:, 0])]
    for piece in forcing.T[::-1]:
        states.append(growth[:, 0] * states[-1] + piece)
    return np.array(states[1:4]).T, states[4]


def polynomial_response(pole: complex, step_s: float) -> Complex:
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


def free_decays(rows: Complex, exponents: Complex, samples: int) -> Array:
    """real(rows @ exp(exponents k)) at samples k = 0, 1, …: (R, samples) from (R, modes) and (modes,)."""
    lasting = np.full(exponents.size, float(samples))
    dies = exponents.real < 0
    lasting[dies] = np.minimum(_FORGOTTEN / exponents.real[dies], samples)
    order = np.argsort(-lasting)
    rows, exponents, lasting = rows[:, order], exponents[order], lasting[order]
    chunk = np.exp(exponents[:, None] * np.arange(min(_CHUNK_SAMPLES, samples)))
    decays = np.zeros((rows.shape[0], samples))
    for first in range(0, samples, _CHUNK_SAMPLES):
        # Only the modes that are not yet forgotten: few are left after the first second.
        alive = int(np.count_nonzero(lasting > first))
        piece = decays[:, first : first + _CHUNK_SAMPLES]
        share = rows[:, :alive] * np.exp(exponents[:alive] * first)
        piece += share.real @ chunk[:alive, : piece.shape[1]].real - share.imag @ chunk[:alive, : piece.shape[1]].imag
    return decays
