"""Noise of the responses and of the force of one run, from what a fit leaves over, and the weights they ask for.

What is left of response o on a line is n_o - G_o n_f: with covariance
diag(S_o) + S_f g g^H its information about g is that of the diagonal alone over
1 + S_f sum |G_o|^2 / S_o (Sherman and Morrison); errors in variables after
Pintelon and Schoukens, System Identification, 2nd ed., 2012, chapter 9.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

_BLOCK = 48  # lines over which the noise of a response counts as equal
_ROUNDS = 3
_IMPERFECTION = 5e-4
_BANDS = 4  # in which the noise of the force counts as equal
_SIGNIFICANT = 3.0  # standard deviations that force noise must be worth


@dataclass(frozen=True, slots=True, eq=False)
class RunNoise:
    """Powers E|n|^2 on every line: of the responses' transforms (R, K) and of the force's (K,).

    ``force_share`` (K,) is S_f sum |G_o|^2 / S_o, how much the noise of the force outweighs the responses'.
    """

    response: NDArray[np.float64]
    force: NDArray[np.float64]
    force_share: NDArray[np.float64]

    def weights(self, force: NDArray[np.complex128]) -> NDArray[np.float64]:
        """Weights (R, K), 1/std of a real part of the ratios on lines of this force (K,)."""
        power = self.response * (1 + self.force_share) / 2
        return np.asarray(np.abs(force) / np.sqrt(power))

    def shared_weights(self, force: NDArray[np.complex128]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """One row of weights (1, K) with row scales (R,), for responses whose noise has nearly the same colour."""
        level = np.exp(np.log(self.response).mean(axis=1))
        colour = (self.response / level[:, None]).mean(axis=0)
        power = colour * (1 + self.force_share) / 2
        return np.asarray(np.abs(force) / np.sqrt(power))[None], np.asarray(1 / np.sqrt(level))


def first_noise(
    variance: NDArray[np.float64],
    force: NDArray[np.complex128],
    ratios: NDArray[np.complex128] | None = None,
) -> RunNoise:
    """Noise before any fit, from the variance (R, K) of the ratios and the force (K,).

    With ``ratios`` (R, K) every response counts as wrong by a small part of itself at least, as no instrument is
    better: without that, records free of noise would ask for poles that mean nothing.
    """
    known = np.where(np.isfinite(variance), variance, 1.0)
    if ratios is not None:
        known = known + (_IMPERFECTION * np.abs(ratios)) ** 2
    return RunNoise(_positive(known * np.abs(force) ** 2), np.zeros(force.size), np.zeros(force.size))


def noise_of_errors(
    errors: NDArray[np.complex128], smooth: NDArray[np.complex128], force: NDArray[np.complex128], unknowns: int
) -> RunNoise:
    """Noise from the errors (R, K) that a fit with ``unknowns`` real unknowns a row leaves of ratios ``smooth`` (R, K).

    ``force`` is (K,). Response noise is the median of |error|^2 over neighbouring lines, freed of
    force noise; force noise is what grows with |G|^2, alike in all responses.
    """
    freedom = max(1 - unknowns / (2 * force.size), 0.5)
    power = np.abs(errors * force) ** 2 / freedom
    gain = np.abs(smooth) ** 2
    response = np.broadcast_to(_positive(power).mean(axis=1, keepdims=True), power.shape)
    excess = np.zeros(force.size)
    for _ in range(_ROUNDS):
        excess = _force_noise(power, gain, response)
        response = _positive(_local_level(power / (1 + excess * gain / response)))
    return RunNoise(response, excess, excess * (gain / response).sum(axis=0))


def _positive(power: NDArray[np.float64]) -> NDArray[np.float64]:
    """Powers (R, K) kept above what round-off makes of the largest of its row."""
    typical = power.mean(axis=1, keepdims=True)
    return np.asarray(np.maximum(power, 1e-6 * typical + np.finfo(float).tiny))


def _local_level(power: NDArray[np.float64]) -> NDArray[np.float64]:
    """Level (R, K) of exponentially distributed powers: medians over blocks of lines, over ln 2, joined smoothly."""
    lines = power.shape[1]
    blocks = max(lines // _BLOCK, 1)
    edges = np.linspace(0, lines, blocks + 1).astype(int)
    level = np.array([np.median(power[:, a:b], axis=1) for a, b in pairwise(edges)]) / np.log(2)
    level = np.log(level + np.finfo(float).tiny)
    padded = np.vstack([level[:1], level, level[-1:]])
    calm = (padded[:-2] + 2 * padded[1:-1] + padded[2:]) / 4
    centres = (edges[:-1] + edges[1:]) / 2
    return np.asarray(np.exp(np.array([np.interp(np.arange(lines), centres, row) for row in calm.T])))


def _force_noise(
    power: NDArray[np.float64], gain: NDArray[np.float64], response: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Noise power of the force (K,), one value for each of a few bands of lines.

    A band that cannot tell takes over its neighbours' value, as far as its own errors allow that.
    """
    lines = power.shape[1]
    edges = np.unique([0, *np.round(np.geomspace(max(lines / 2**_BANDS, 40), lines, _BANDS)).astype(int)])
    parts = [slice(a, min(b, lines)) for a, b in pairwise(edges)]
    slopes, std = np.transpose([_regressed(power[:, p] / response[:, p], gain[:, p] / response[:, p]) for p in parts])
    sure = slopes > _SIGNIFICANT * std
    if sure.any():
        index = np.arange(len(parts))
        likely = np.exp(np.interp(index, index[sure], np.log(slopes[sure])))
        slopes = np.where(sure, slopes, np.minimum(likely, slopes + 2 * std))
    else:
        slopes = np.zeros(len(parts))
    return np.repeat(slopes, [p.stop - p.start for p in parts])


def _regressed(power: NDArray[np.float64], gain: NDArray[np.float64]) -> tuple[float, float]:
    """Slope of powers (R, k) over gains (R, k) and its std, with a level for each row and weights from the fit."""
    level = np.ones((power.shape[0], 1))
    slope = 1.0 / max(float(np.median(gain)), 1e-300)
    std = np.inf
    for _ in range(4 * _ROUNDS):
        weight = 1 / (level + slope * gain) ** 2
        total = weight.sum(axis=1, keepdims=True)
        middle = (weight * gain).sum(axis=1, keepdims=True) / total
        information = float((weight * (gain - middle) ** 2).sum())
        if information <= 0:
            return 0.0, np.inf
        slope = max(float((weight * (gain - middle) * power).sum()) / information, 0.0)
        level = np.maximum((weight * (power - slope * gain)).sum(axis=1, keepdims=True) / total, 1e-3)
        # Responses share the noise of the force, so they count as one another's repeats.
        std = np.sqrt(gain.shape[0] / information)
    return slope, std
