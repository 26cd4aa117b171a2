"""What a reading says of an explanation that a campaign has left open: both fitted together.

Along a bent valley (a warming and what stiffness loses by it) a campaign's normal law reaches values that its own
data refuse; a reading that picks one of these tells more than that law foresees.
"""

from __future__ import annotations

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

Array = NDArray[np.float64]
_TRIALS = 30
# What a trial step beyond every aircraft costs, in deviations.
_NOWHERE = 1e4


def reading_density(fit: Fit, check: Check, reading: Array) -> float | None:
    """Log density, nats, of a reading (K,) by a fit and its campaign (Laplace); None where it cannot be read."""
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
    return -0.5 * float(2 * ended.cost - fit.cost + spread + norm)


def followed_nats(true: Fit, other: Fit, check: Check) -> float | None:
    """Nats that a reading is expected to put between two fits, the other fitted to it and the campaign.

    At the mean that ``true`` foretells; how readings scatter about it is seen by the normal law of either.
    """
    law, wide = foretold(true, check), foretold(other, check)
    told = None if law is None else reading_density(other, check, law[0])
    if law is None or wide is None or told is None:
        return None
    scatter = float(np.trace(np.linalg.solve(wide[1], law[1]))) - law[0].size
    return log_density(law[0], *law) - told + 0.5 * scatter
