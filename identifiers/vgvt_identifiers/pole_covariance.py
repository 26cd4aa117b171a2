"""Covariance of fitted poles when weights and noise are not quite the same, and responses share the force's noise."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.pole_fit import PoleProblem, PoleState, projected_slopes
from vgvt_identifiers.run_noise import RunNoise


def pole_covariance(
    problem: PoleProblem,
    state: PoleState,
    noise: tuple[RunNoise, ...],
    forces: tuple[NDArray[np.complex128], ...],
    free: NDArray[np.bool_] | None = None,
) -> NDArray[np.float64]:
    """Covariance (2 N, 2 N) in (rad/s)^2 of all real parts, then all imaginary parts of the poles.

    The bread is the information, the filling what noise of the responses and of the ``forces`` (K,)
    of every run puts into the gradient; they agree, and this is the inverse information, where
    weights are those of independent responses. Poles that are not ``free`` (N,)
    count as known. White, Econometrica 48(4), 1980, with modelled errors.
    """
    count = 2 * state.poles.size
    filling = np.zeros((count, count))
    shared = [np.zeros((2, f.size, count)) for f in forces]
    for run, row, slopes in projected_slopes(problem, state):
        rows, lines = problem.rows[run], forces[run].size
        weight = rows.weight[min(row, rows.weight.shape[0] - 1)] * rows.row_scale[row]
        inverse = np.divide(1, forces[run], out=np.zeros_like(forces[run]), where=np.abs(forces[run]) > 0)
        own = weight * np.abs(inverse) * np.sqrt(noise[run].response[row] / 2)
        real, imaginary = slopes[:lines], slopes[lines:]
        spread = np.concatenate([real * own[:, None], imaginary * own[:, None]])
        filling += spread.T @ spread
        if noise[run].force.any():
            # A force error n turns every response's ratio by -G n / F, all at once.
            moved = (weight * state.smooth[run][row] * inverse)[:, None]
            shared[run][0] += real * moved.real + imaginary * moved.imag
            shared[run][1] += imaginary * moved.real - real * moved.imag
    for run, parts in enumerate(shared):
        spread = (parts * np.sqrt(noise[run].force / 2)[:, None]).reshape(-1, count)
        filling += spread.T @ spread
    bread = state.covariance(free)
    return np.asarray(bread @ filling @ bread)


def pole_deviations(
    poles: NDArray[np.complex128], covariance: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Standard deviations of natural frequency in Hz and of damping ratio, (N,) each, by first-order propagation."""
    count = poles.size
    size = np.abs(poles)
    variance = np.diag(covariance)
    mixed = covariance[np.arange(count), count + np.arange(count)]
    along, across = poles.real / size, poles.imag / size
    frequency = along**2 * variance[:count] + across**2 * variance[count:] + 2 * along * across * mixed
    # zeta = -a / |p|: its gradient is (-b^2, a b) / |p|^3
    first, second = -(poles.imag**2) / size**3, poles.real * poles.imag / size**3
    damping = first**2 * variance[:count] + second**2 * variance[count:] + 2 * first * second * mixed
    return np.sqrt(np.maximum(frequency, 0)) / (2 * np.pi), np.sqrt(np.maximum(damping, 0))
