"""What a reading says of an explanation that a campaign has left open: both fitted together.

Along a bent valley (a warming and what stiffness loses by it) a campaign's normal law reaches values that its own
data refuse; a reading that picks one of these tells more than that law foresees.

An explanation bends to a reading by χ² as it is, as a fit does. Counted is what a verdict on both counts: the reading
and the tolerances whole, what bending costs of the campaign's data as far as a value of these is worth anything.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.optimize import least_squares

from vgvt.data import InputError
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.fitting.misfit import data_misfit, jacobian
from vgvt.reconcile.next_test.checks import Check, foretold, log_density, read_by, slopes_of
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.thresholds import noise_share

Array = NDArray[np.float64]
_TRIALS = 30
# What a trial step beyond every aircraft costs, in deviations.
_NOWHERE = 1e4


@dataclass(frozen=True, slots=True, eq=False)
class Law:
    """What a fit foretells of a reading: its mean (K,), covariance (K, K), and what being off the mean costs (K, K).

    ``slope`` (K,) is by how much likelier readings get along each axis: where a fit's data pull against its priors,
    and are worth less than these, what lets go of the priors counts as a gain.
    """

    mean: Array
    covariance: Array
    cost: Array
    slope: Array

    def density(self, reading: Array) -> float:
        """Log density, nats, of a reading (K,), as it is counted."""
        off = reading - self.mean
        told = float(self.slope @ off - 0.5 * off @ self.cost @ off)
        return log_density(self.mean, self.mean, self.covariance) + told


def counted_law(fit: Fit, check: Check) -> Law | None:
    """The normal law of a reading by what a fit knows, as a verdict counts it; None where it cannot be read."""
    known = foretold(fit, check)
    if known is None:
        return None
    mean, covariance = known
    whole, discount = np.linalg.inv(covariance), 1 - _worth(fit)
    # Scores follow the reading by so much of a unit, and the data miss what they did not. At the bottom what the data
    # gain by a step is what the priors lose.
    followed = fit.covariance @ slopes_of(fit, fit.scores, mean, check).T @ whole
    bent = fit.tangent @ followed
    return Law(mean, covariance, whole - discount * (bent.T @ bent), -discount * (followed.T @ fit.scores))


def _worth(fit: Fit) -> float:
    """What one of the values that a fit was made to is worth to a verdict on them."""
    return noise_share(fit.problem.measured, fit.problem.split.train).worth


def reading_nats(true: Fit, other: Fit, check: Check) -> float | None:
    """Nats that a reading is expected to put between two fits where ``true`` is; None where it cannot be read.

    The divergence of one foretold normal law from the other (Kullback and Leibler, Ann. Math. Stat. 22, 1951), each
    value of the campaign's data worth what it is to a verdict.
    """
    first, second = counted_law(true, check), counted_law(other, check)
    if first is None or second is None:
        return None
    gap = second.mean - first.mean
    sizes = np.linalg.slogdet(second.covariance)[1] - np.linalg.slogdet(first.covariance)[1]
    return float(0.5 * (_scatter(first, second) + gap @ second.cost @ gap + sizes) + second.slope @ gap)


def _scatter(true: Law, other: Law) -> float:
    """By how much readings that scatter as one law says cost the other more on average, twice in nats."""
    return float(((other.cost - true.cost) * true.covariance).sum())


def reading_density(fit: Fit, check: Check, reading: Array) -> float | None:
    """Log density, nats, of a reading (K,) by a fit and its campaign (Laplace), counted; None if it cannot be read."""
    mean = read_by(fit, fit.scores, check)
    if mean is None:
        return None
    factor = np.linalg.cholesky(check.covariance(mean.size))
    problem, count = fit.problem, fit.u.size
    moving = [int(k) for k in np.flatnonzero(slopes_of(fit, fit.scores, mean, check).any(axis=0))]

    def white(values: Array) -> Array:
        return np.asarray(scipy.linalg.solve_triangular(factor, values, lower=True))

    def misfit(scores: Array) -> Array:
        there = read_by(fit, scores, check)
        try:
            if there is None:
                raise NoStructureError("no reading")
            here = anchor(problem, scores[:count], fit.hypotheses, scores[count:], slopes=False)
            data = data_misfit(problem, here.predict(scores[:count], scores[count:]))
        except (InputError, NoStructureError, ValueError):
            return np.full(fit.points + scores.size + mean.size, _NOWHERE)
        return np.concatenate([data, scores, white(there - reading)])

    def slopes(scores: Array) -> Array:
        u, e = scores[:count], scores[count:]
        here = anchor(problem, u, fit.hypotheses, e, rough=True)
        there = read_by(fit, scores, check)
        own = np.zeros((mean.size, scores.size)) if there is None else slopes_of(fit, scores, there, check, moving)
        return np.concatenate([jacobian(here, u, e, here.predict(u, e)), np.eye(scores.size), white(own)])

    ended = least_squares(misfit, fit.scores, jac=slopes, method="trf", max_nfev=_TRIALS)
    spread = np.linalg.slogdet(ended.jac.T @ ended.jac)[1] + np.linalg.slogdet(fit.covariance)[1]
    norm = 2 * np.log(np.diag(factor)).sum() + mean.size * np.log(2 * np.pi)
    data = ended.fun[: fit.points]
    overrated = (1 - _worth(fit)) * (float(data @ data) - fit.chi2)
    return -0.5 * float(2 * ended.cost - fit.cost - overrated + spread + norm)


def followed_nats(true: Fit, other: Fit, check: Check) -> float | None:
    """Nats that a reading is expected to put between two fits, the other fitted to it and the campaign.

    At the mean that ``true`` foretells; how readings scatter about it is seen by the normal law of either.
    """
    first, second = counted_law(true, check), counted_law(other, check)
    told = None if first is None else reading_density(other, check, first.mean)
    if first is None or second is None or told is None:
        return None
    return first.density(first.mean) - told + 0.5 * _scatter(first, second)
