"""How well scores are known when the model's own error is not random: the Laplace posterior made wide enough for it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.question.thresholds import SMOOTHED

Array = NDArray[np.float64]


def honest_covariance(fit: Fit) -> Array:
    """Covariance (scores, scores) of a fit whose declared model-form error is common to neighbouring lines.

    Laplace's posterior takes the floor in sigma for noise that is fresh on every line and channel, so that thousands of
    lines wear it down. An error of the model does not wear down: here it is one complex factor on all channels of every
    five neighbouring lines, the worst that a smooth error can be. The noise stays what it is. (The sandwich
    of Huber, Proc. 5th Berkeley Symposium 1, 1967, with the unit prior as data.)
    """
    measured, keep = fit.problem.measured, fit.problem.split.train
    sigma = measured.sigma[keep] if fit.sigma is None else fit.sigma
    count, lines = sigma.shape
    slopes = fit.tangent.reshape(2, count, lines, -1)
    noise = measured.noise[keep] / sigma**2
    meat = np.einsum("pcls,cl,pclt->st", slopes, noise, slopes, optimize=True) + np.eye(slopes.shape[3])
    # sigma² - noise is the floor squared times what it is relative to.
    form = np.sqrt(np.maximum(sigma**2 - measured.noise[keep], 0.0)) / sigma
    turned = form * np.exp(1j * np.angle(fit.predicted[keep]))
    for part in np.array_split(np.arange(lines), max(1, lines // SMOOTHED)):
        for direction in (turned[:, part], 1j * turned[:, part]):
            together = np.stack([direction.real, direction.imag])
            pull = np.einsum("pcl,pcls->s", together, slopes[:, :, part])
            meat += np.outer(pull, pull)
    return np.asarray(fit.covariance @ meat @ fit.covariance)


def honest(fit: Fit) -> Fit:
    """The same fit with that covariance, never narrower in a score than Laplace's, and with what is ``unseen``."""
    wide = honest_covariance(fit)
    grown = np.sqrt(np.maximum(1.0, np.diag(fit.covariance) / np.diag(wide)))
    wide *= np.outer(grown, grown)
    return replace(fit, covariance=wide if fit.unseen is None else wide + fit.unseen.T @ fit.unseen)
