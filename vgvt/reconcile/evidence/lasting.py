"""Evidence by an error of the model's form that lasts: noise is new on every line, such an error is not.

A fit takes the declared model-form floor for noise, so that an error of a thousandth of one channel, which fifty lines
share, seems to be seen fifty times. Here half of the floor's variance lasts over a twelfth of the lines, in phase with
the response, which is a model discrepancy with a covariance (Kennedy and O'Hagan, Bayesian calibration of computer
models, J. R. Stat. Soc. B 63(3), 2001). What an effect buys must be bought from that, too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import TYPE_CHECKING

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from vgvt.reconcile.fitting.descent import solved
from vgvt.reconcile.fitting.misfit import data_misfit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.data import Measured
from vgvt.reconcile.question.problem import Problem

if TYPE_CHECKING:
    from vgvt.reconcile.fitting.fit import Fit

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

LENGTH = 1 / 12
"""The lines, as a share of all, after which the correlation of a model-form error has fallen to 1/e.

Of what calibrations leave of 18 campaigns without any missing effect and nearly without noise, 12 cells a wing against
30 or against finite elements: 0.92 for the next of 160 lines, 0.6 for the eighth, 0.3 for the sixteenth.
"""
SHARE = 0.5
"""The part of a floor's variance that lasts: the channels of those campaigns left 0.06 to 0.48 floors of it."""
# Standard deviations, no further at once than the linearised matrices carry.
_LONGEST = 20.0
# Nats that a free step promises at the bottom of a fit, if any.
_PROMISED = 0.5
# What a step may promise, in nats, unasked; and the shares of it that are tried where it promises more.
_UNASKED, _SHARES = 10.0, (1.0, 0.5, 0.25)


@lru_cache(maxsize=32)
def lasting_nats(found: Fit) -> float:
    """Laplace's log evidence of a fit, nats, where the model's error lasts.

    What is judged by a coarse error on top is on its way, and has that of its own measure.
    """
    if found.sigma is not None:
        return found.evidence_nats
    share = sum(float(np.log(h.share)) for h in found.hypotheses)
    misfit = data_misfit(found.problem, found.predicted)
    gradient = found.tangent.T @ misfit + found.scores
    arrived = found.converged or 0.5 * float(gradient @ found.covariance @ gradient) < _PROMISED
    return lasting_evidence(
        found.problem, misfit, found.tangent, found.scores, share, arrived=arrived, aside=partial(_aside, found)
    )


def _aside(found: Fit, scores: Array) -> Array | None:
    """The misfit (2 N,) of a fit's model at other scores; None where there is no such aircraft."""
    u, e = np.split(scores, [found.u.size])
    try:
        predicted = anchor(found.problem, u, found.hypotheses, e, slopes=False).predict(u, e)
    except NoStructureError:
        return None
    return data_misfit(found.problem, predicted)


def lasting_evidence(
    problem: Problem, misfit: Array, tangent: Array, scores: Array, log_share: float, *, arrived: bool = True,
    aside: Callable[[Array], Array | None] | None = None,
) -> float:  # fmt: skip
    """Laplace's log evidence, nats, of a fit with misfit (2 N,), its derivatives (2 N, scores) and ``scores`` (scores,)
    where the model's error lasts; ``log_share`` is the prior's of its variants.

    The fit is the best by another measure: what is left to gain by this one is taken from the linearised model. Slopes
    that promise more by the fit's own measure, at whose bottom it stands, promise what is not there, as beside a joint
    that is marched: that much of them is not believed, nor a longer step than they carry. Of a fit that has not
    ``arrived`` they do promise what is there, and taking it off from what this measure sees would leave less than any
    scores do: no more is gained than to the linearised model's own bottom. Where much is promised, the misfit ``aside``
    (2 N,), at other scores, is asked for it: a model that misses much promises most, and keeps least.
    """
    judged = lasting(problem, np.column_stack([misfit, tangent]))
    left, slopes = judged[:, 0], judged[:, 1:]
    precision = slopes.T @ slopes + np.eye(scores.size)
    downhill = slopes.T @ left - tangent.T @ misfit
    step = solved(precision, downhill)
    part = min(1.0, _LONGEST / max(float(np.abs(step).max(initial=0.0)), 1e-300))
    here = float(left @ left + scores @ scores)
    cost, least = here - part * (2 - part) * float(downhill @ step), 0.0
    if not arrived:
        # Half the gradient by this measure: |W (m + J d)|² + |s + d|² is least, and no less, where P d = -gradient.
        gradient = slopes.T @ left + scores
        least = here - float(gradient @ solved(precision, gradient))
    cost = max(cost, least)
    if aside is not None and here - cost > 2 * _UNASKED:
        cost = max(cost, _kept(problem, scores, part * step, here, aside))
    return -0.5 * (cost + float(np.linalg.slogdet(precision)[1])) + log_share


def _kept(problem: Problem, scores: Array, step: Array, here: float, aside: Callable[[Array], Array | None]) -> float:
    """The least cost by this measure on the way back along a ``step`` (scores,) from scores at which it is ``here``."""
    costs = [here]
    for share in _SHARES:
        there = scores - share * step
        misfit = aside(there)
        if misfit is not None:
            judged = lasting(problem, misfit[:, None])
            costs.append(float(np.sum(judged**2) + there @ there))
    return float(np.nanmin(costs))


def lasting(problem: Problem, vectors: Array) -> Array:
    """Changes (2 N, k) of the data's misfit, standardised anew so that their products know of what lasts.

    The square sum of one is its χ² by noise and an error of the model's form together.
    """
    keep = problem.split.train
    values = problem.measured.values[keep]
    factors = _factors(problem.measured, keep.tobytes())
    count, lines = values.shape
    parts = np.reshape(vectors, (2, count, lines, -1))
    # An error of the form turns with the response: it is a share of it.
    turned = (parts[0] + 1j * parts[1]) * _phase(values).conj()[:, :, None]
    out = np.empty(parts.shape)
    for c, factor in enumerate(factors):
        both = np.hstack([turned[c].real, turned[c].imag])
        white = scipy.linalg.solve_triangular(factor, both, lower=True, overwrite_b=True, check_finite=False)
        out[0, c], out[1, c] = np.hsplit(white, 2)
    return out.reshape(np.shape(vectors))


@dataclass(frozen=True, slots=True, eq=False)
class Imitated:
    """What a problem's unknowns can make up for where the model's error lasts: a ``basis`` (2 N + scores, scores)."""

    problem: Problem
    basis: Array

    @classmethod
    def of(cls, problem: Problem, tangent: Array) -> Imitated:
        """From derivatives (2 N, scores) of the misfit."""
        basis, _ = np.linalg.qr(np.vstack([lasting(problem, tangent), np.eye(tangent.shape[1])]))
        return cls(problem, basis)

    def deviations(self, change: Array) -> float:
        """By how many standard deviations a change (2 N + scores,) of misfit and scores shows beyond that."""
        points = change.size - self.basis.shape[1]
        judged = np.concatenate([lasting(self.problem, change[:points]), change[points:]])
        return float(np.linalg.norm(judged - self.basis @ (self.basis.T @ judged)))


@lru_cache(maxsize=2)
def _factors(measured: Measured, train: bytes) -> Array:
    """Cholesky's factors (C, L, L) of the covariance over lines of the channels to fit, in what they are judged by."""
    keep, lines = np.frombuffer(train, dtype=bool), measured.frequency_hz.size
    fresh = np.minimum(measured.noise[keep] / measured.sigma[keep] ** 2, 1.0)
    apart = np.abs(np.subtract.outer(np.arange(lines), np.arange(lines)))
    alike = SHARE * np.exp(-apart / (LENGTH * lines))
    factors = np.empty((fresh.shape[0], lines, lines))
    # One by one: all at once, with what they are made of, are several times as much memory.
    for factor, form in zip(factors, np.sqrt(1 - fresh), strict=True):
        whole = form[:, None] * alike * form
        np.fill_diagonal(whole, 1.0)
        factor[:] = np.linalg.cholesky(whole)
    return factors


def _phase(values: ComplexArray) -> ComplexArray:
    """Factors (C, L) of size one with the phases of values (C, L)."""
    size = np.abs(values)
    return np.asarray(np.where(size > 0, values, 1.0) / np.where(size > 0, size, 1.0))
