"""The residual of a fit as a real vector, and its derivatives: data in standard deviations, then the scores."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.prediction.chain import chain_factor
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.question.shared_noise import apart

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
# Small against a resonance's width for the widest prior; the prediction is smooth to round-off.
_STEP = 1e-4


class Linearised(Protocol):
    """Whatever foretells A/F around the scores that it stands on: an anchor, or one with something more in place."""

    @property
    def problem(self) -> Problem:
        """What it is made for."""
        ...

    @property
    def filtered(self) -> bool:
        """Whether hypotheses act on the measuring chain."""
        ...

    def predict(self, u: Array, e: Array) -> ComplexArray:
        """A/F (C, L) at scores u and e."""
        ...

    def chain(self, u: Array, e: Array) -> ComplexArray:
        """The measuring chain's factor (C, L)."""
        ...

    def slopes(self, wanted: NDArray[np.bool_] | None = None) -> ComplexArray:
        """Derivatives (unknowns + scores e, C, L) of what the chain multiplies, of channels that are wanted (C,)."""
        ...


def data_misfit(problem: Problem, predicted: ComplexArray, sigma: Array | None = None) -> Array:
    """sqrt(2) Re and Im of (model - data)/sigma of the channels to fit, (2 N,): the square sum is a χ².

    sigma² is the variance of the complex value, hence the 2. ``sigma`` (fitted channels, L) stands in for the data's.
    """
    keep = problem.split.train
    difference = standardised(problem, predicted[keep] - problem.measured.values[keep], sigma)
    return np.asarray(np.sqrt(2) * np.concatenate([difference.real.ravel(), difference.imag.ravel()]))


def standardised(problem: Problem, change: ComplexArray, sigma: Array | None = None) -> ComplexArray:
    """Changes (fitted channels, L) or (…, k) of A/F in standard deviations, what channels of a run share taken out.

    Where a coarse ``sigma`` stands in, noise is nothing of what it is judged by.
    """
    judged = _sigma(problem, sigma)
    scaled = change / judged.reshape(*judged.shape, *[1] * (change.ndim - 2))
    return scaled if sigma is not None else apart(problem.measured, problem.split.train, scaled)


def jacobian(anchored: Linearised, u: Array, e: Array, predicted: ComplexArray, sigma: Array | None = None) -> Array:
    """Derivatives (2 N, scores) of :func:`data_misfit` in u, then in e, at the scores that ``anchored`` stands on."""
    problem = anchored.problem
    keep = problem.split.train
    known = len(problem.unknowns)
    chain, here = anchored.chain(u, e), predicted[keep]
    slopes = anchored.slopes(keep)
    changes = [chain[keep] * change for change in slopes[:known]]
    plain = chain_factor(problem, u[known:], None)
    for k, nuisance in enumerate(problem.nuisances):
        if nuisance.kind == "gain":
            changes.append(nuisance.power * nuisance.sd * here * nuisance.rows[keep, None])
        else:
            moved = u[known:].copy()
            moved[k] += _STEP
            changes.append(here * (chain_factor(problem, moved, None) / plain - 1)[keep] / _STEP)
    for k, change in enumerate(slopes[known:]):
        changes.append(chain[keep] * change + (predicted * _relative_slope(anchored, u, e, k, chain))[keep])
    scaled = standardised(problem, np.moveaxis(np.reshape(changes, (-1, *here.shape)), 0, -1), sigma)
    columns = np.moveaxis(scaled, -1, 0).reshape(len(changes), -1)
    return np.asarray(np.sqrt(2) * np.hstack([columns.real, columns.imag]).T)


def _relative_slope(anchored: Linearised, u: Array, e: Array, k: int, chain: ComplexArray) -> ComplexArray | float:
    """What a hypothesis' parameter does to the measuring chain, relative to the chain's factor."""
    if not anchored.filtered:
        return 0.0
    moved = e.copy()
    for step in (_STEP, -_STEP):
        moved[k] = e[k] + step
        try:
            return np.asarray((anchored.chain(u, moved) / chain - 1) / step)
        except ValueError:
            continue
    return 0.0


def coarse_sigma(problem: Problem, coarse: float) -> Array | None:
    """Standard deviations with a relative error added to every line; None, the data's own, where there is none."""
    if coarse == 0:
        return None
    keep = problem.split.train
    measured = problem.measured
    return np.asarray(np.sqrt(measured.sigma[keep] ** 2 + (coarse * np.abs(measured.values[keep])) ** 2))


def _sigma(problem: Problem, sigma: Array | None) -> Array:
    return problem.measured.sigma[problem.split.train] if sigma is None else sigma
