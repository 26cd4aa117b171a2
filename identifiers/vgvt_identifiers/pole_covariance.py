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
    shared = [np.zeros((count, f.size), complex) for f in forces]
    for run, row, slopes in projected_slopes(problem, state):
        rows = problem.rows[run]
        weight = rows.weight[min(row, rows.weight.shape[0] - 1)] * rows.row_scale[row]
        inverse = np.divide(1, forces[run], out=np.zeros_like(forces[run]), where=np.abs(forces[run]) > 0)
        own = slopes * (weight * np.abs(inverse) * np.sqrt(noise[run].response[row] / 2))
        filling += (own @ own.conj().T).real
        if noise[run].force.any():
            # A force error n turns every response's ratio by -G n / F, all at once.
            shared[run] += slopes * (weight * state.smooth[run][row] * inverse).conj()
    for run, parts in enumerate(shared):
        spread = parts * np.sqrt(noise[run].force / 2)
        filling += (spread @ spread.conj().T).real
    bread = state.covariance(free)
    return np.asarray(bread @ filling @ bread)


def pole_deviations(
    poles: NDArray[np.complex128], covariance: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Standard deviations of natural frequency in Hz and of damping ratio, (N,) each, by first-order propagation."""
    variance = np.maximum(np.diag(parameter_covariance(poles, covariance)), 0.0)
    return np.sqrt(variance[: poles.size]), np.sqrt(variance[poles.size :])


def parameter_covariance(poles: NDArray[np.complex128], covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Covariance (2 N, 2 N) of natural frequencies in Hz, then damping ratios, from that of ``poles`` (N,) in rad/s."""
    size = np.abs(poles)
    along, across = poles.real / size, poles.imag / size
    # zeta = -a / |p|: its gradient is (-b^2, a b) / |p|^3
    frequency = np.hstack([np.diag(along), np.diag(across)]) / (2 * np.pi)
    damping = np.hstack([np.diag(-(across**2) / size), np.diag(along * across / size)])
    slopes = np.vstack([frequency, damping])
    return np.asarray(slopes @ covariance @ slopes.T)
