"""Noise of the responses and of the force of one run, from what a fit leaves over, and the weights they ask for.

What is left of response o on a line is n_o - G_o n_f: with covariance
diag(S_o) + S_f g g^H its information about g is that of the diagonal alone over
1 + S_f sum |G_o|^2 / S_o (Sherman and Morrison); errors in variables after
Pintelon and Schoukens, System Identification, 2nd ed., 2012, chapter 9. Every response
sees the same noise of the force, so that the best guess of it on a line adds all of them up;
what it leaves is the responses' own (expectation and maximisation: Dempster, Laird
and Rubin, Journal of the Royal Statistical Society B 39(1), 1977).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

_BLOCK = 48  # lines over which the noise of a response counts as equal
_ROUNDS = 6
_STEPS = 20
_IMPERFECTION = 5e-4
_BANDS = 4  # in which the noise of the force counts as equal
_EVIDENCE = 7.0  # nats that force noise must be worth; by Markov's inequality noise of responses alone has e^-7
_OWN = 0.02  # least part of a response's error on a line that can be told to be its own


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

    ``force`` is (K,). Noise of the force is what the errors have in common in the proportions of the
    ratios; noise of a response is the median over neighbouring lines of what is left of |error|^2.
    """
    freedom = max(1 - unknowns / (2 * force.size), 0.5)
    error = errors * force / np.sqrt(freedom)
    gain = np.abs(smooth) ** 2
    response = _start(_positive(np.abs(error) ** 2))
    excess = np.zeros(force.size)
    for _ in range(_ROUNDS):
        seen = (gain / response).sum(axis=0)
        along = (smooth.conj() * error / response).sum(axis=0)
        excess = _force_noise(np.abs(along) ** 2, seen)
        shift = excess / (1 + excess * seen)
        own = np.maximum(1 - shift * gain / response, _OWN)
        response = _positive(_local_level(np.abs(error - shift * along * smooth) ** 2 / own))
    return RunNoise(response, excess, excess * (gain / response).sum(axis=0))


def _start(power: NDArray[np.float64]) -> NDArray[np.float64]:
    """Noise of responses (R, K) with no more of it anywhere than is usual in its band: the rest may be the force's."""
    level = _local_level(power)
    for part in _bands(power.shape[1]):
        level[:, part] = np.minimum(level[:, part], np.median(level[:, part], axis=1, keepdims=True))
    return level


def _bands(lines: int) -> list[slice]:
    narrowest = min(max(lines / 2**_BANDS, 40), lines)
    edges = np.unique([0, *np.round(np.geomspace(narrowest, lines, _BANDS)).astype(int)])
    return [slice(int(a), int(b)) for a, b in pairwise(edges)]


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


def _force_noise(along: NDArray[np.float64], seen: NDArray[np.float64]) -> NDArray[np.float64]:
    """Noise power of the force (K,), one value for each of a few bands of lines.

    ``along`` (K,) is |sum conj(G_o) e_o / S_o|^2, of mean q + q^2 S_f with q (K,) what is ``seen`` of the force,
    sum |G_o|^2 / S_o. A band that cannot tell takes over its neighbours' value, as far as its own errors allow that.
    """
    parts = _bands(seen.size)
    power = np.divide(along, seen, out=np.ones_like(seen), where=seen > 0)
    slopes, std, nats = np.transpose([_likeliest(power[p], seen[p]) for p in parts])
    sure = nats > _EVIDENCE
    if sure.any():
        index = np.arange(len(parts))
        likely = np.exp(np.interp(index, index[sure], np.log(slopes[sure])))
        slopes = np.where(sure, slopes, np.minimum(likely, slopes + 2 * std))
    else:
        slopes = np.zeros(len(parts))
    return np.repeat(slopes, [p.stop - p.start for p in parts])


def _likeliest(power: NDArray[np.float64], seen: NDArray[np.float64]) -> tuple[float, float, float]:
    """Likeliest s where powers (k,) are exponential with means 1 + s ``seen`` (k,), its std, its evidence in nats."""
    slope, weight = 0.0, seen**2
    for _ in range(_STEPS):
        total = float(weight.sum())
        if total <= 0:
            return 0.0, np.inf, 0.0
        before, slope = slope, max(float((weight / np.maximum(seen, 1e-300) * (power - 1)).sum()) / total, 0.0)
        weight = (seen / (1 + slope * seen)) ** 2
        if abs(slope - before) <= 1e-3 * slope:
            break
    mean = 1 + slope * seen
    return slope, 1 / np.sqrt(float(weight.sum())), float((power - power / mean - np.log(mean)).sum())
