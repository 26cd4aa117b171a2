"""Maximum-likelihood poles of one run, or common to several, with the noise estimated along the way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.pole_covariance import pole_covariance, pole_deviations
from vgvt_identifiers.pole_fit import FitRows, PoleProblem, PoleState, fit_poles
from vgvt_identifiers.run_noise import RunNoise, first_noise, noise_of_errors
from vgvt_identifiers.spectra import RunSpectra

_ROUNDS = 3
_COARSE_STEPS = 12


@dataclass(frozen=True, slots=True, eq=False)
class LikelihoodFit:
    """Poles with what they were fitted to, the noise that was found, and standard deviations (N,)."""

    problem: PoleProblem
    state: PoleState
    noise: tuple[RunNoise, ...]
    frequency_std_hz: NDArray[np.float64]
    damping_ratio_std: NDArray[np.float64]

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Poles (N,), rad/s."""
        return self.state.poles


def weighted_problem(
    frequency_hz: NDArray[np.float64],
    runs: tuple[RunSpectra, ...],
    noise: tuple[RunNoise, ...],
    *,
    shared: bool,
) -> PoleProblem:
    """The fit of some runs on lines (K,), weighted by their noise, all responses of a run alike if ``shared``."""
    rows = []
    for run, level in zip(runs, noise, strict=True):
        inverse = np.divide(1, run.force, out=np.zeros_like(run.force), where=np.abs(run.force) > 0)
        if shared:
            weight, scale = level.shared_weights(run.force)
        else:
            weight, scale = level.weights(run.force), np.ones(len(run.responses))
        rows.append(FitRows(run.accelerance, weight, scale, None if run.averaged else inverse))
    return PoleProblem(frequency_hz, tuple(rows))


def likelihood_fit(
    frequency_hz: NDArray[np.float64],
    runs: tuple[RunSpectra, ...],
    start: NDArray[np.complex128],
    noise: tuple[RunNoise, ...] | None = None,
    *,
    shared: bool = False,
    rounds: int = _ROUNDS,
) -> LikelihoodFit:
    """Poles of largest likelihood near ``start`` (N,) rad/s, common to all ``runs``, on lines (K,).

    The noise of every response and of the force is estimated from what the fit leaves over, and the
    fit repeated with it. ``shared`` weighs all responses of a run alike in the
    last round too, which is faster and nearly as good where their noise has one colour.
    """
    forces = tuple(r.force for r in runs)
    if noise is None:
        noise = tuple(first_noise(r.variance, r.force) for r in runs)
    poles = start
    for last in (*[False] * (rounds - 1), True):
        alike = shared or not last
        problem = weighted_problem(frequency_hz, runs, noise, shared=alike)
        state = fit_poles(problem, poles, _COARSE_STEPS if not last else 2 * _COARSE_STEPS)
        poles = state.poles
        noise = noise_after(state, forces)
    std_hz, std_ratio = pole_deviations(poles, pole_covariance(problem, state, noise, forces))
    return LikelihoodFit(problem, state, noise, std_hz, std_ratio)


def noise_after(state: PoleState, forces: tuple[NDArray[np.complex128], ...]) -> tuple[RunNoise, ...]:
    """Noise of every run, with forces (K,), from what the fit of ``state`` leaves over."""
    unknowns = 4 * state.poles.size + 6
    return tuple(noise_of_errors(e, g, f, unknowns) for e, g, f in zip(state.errors, state.smooth, forces, strict=True))
