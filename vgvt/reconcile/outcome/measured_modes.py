"""Poles and shapes as responses show them around a mode, the same way for records as for what a model foretells.

A model's modes are held against those that were measured by one local fit of both: what such a fit errs by, near
another mode or in a run whose sensors weigh on the tips, it does to either.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# Lines on each side of a mode: so many half-power widths, and in all so many more than one channel has unknowns.
_WIDTHS, _SPARE_LINES = 4.0, 6
# Terms of a polynomial over the window, for all other modes: beside strong ones a weak mode is small against how they
# bend there.
_BACKGROUND = 4
# A fit that leads so far from where it began, in the logarithm of frequency, or to such damping found another thing.
_ASTRAY, _LEAST_DAMPED, _MOST_DAMPED = 0.1, 1e-5, 0.3
_BEGUN_WITH = 1e-4
# How many times what noise takes, value for value, a pole takes to be one: the best of some dozen lines takes three.
_MORE_THAN_NOISE = 6.0
# Of the frequency: a run that knows a pole no better says nothing of it, as where all its sensors sit in nodes.
_UNSURE = 0.02
# Half-power widths, of both together: modes that are nearer are fitted together.
_BESIDE = 5.0
_RECENTRED = 3
# Two fits have met where frequencies differ by less than this share, and shapes are one.
_SAME, _SAME_MAC = 2e-3, 0.9


@dataclass(frozen=True, slots=True, eq=False)
class SeenMode:
    """A mode as responses show it: Hz and damping ratio with standard deviations, and its ``residues`` (C,).

    Means over the runs that show it, and deviations of those means, from how far apart the runs are; of one run from
    what its fit leaves. Residues are those of A/F, not a number where a channel's run does not show the mode.
    """

    frequency_hz: float
    frequency_std_hz: float
    damping_ratio: float
    damping_std: float
    residues: ComplexArray
    runs: int


class _Pole(NamedTuple):
    """A pole of one run by the logarithms of Hz and damping ratio, their standard deviations, and residues (c,)."""

    logarithms: Array
    std: Array
    residues: ComplexArray


def seen_modes(
    values: ComplexArray,
    sigma: Array,
    frequency_hz: Array,
    run_of: NDArray[np.intp],
    start_hz: Sequence[float],
    start_damping: Sequence[float],
) -> list[SeenMode | None]:
    """The modes that accelerances (C, L) show near given ones; None for one that they do not show.

    ``sigma`` (C, L) is what a channel is judged by, ``frequency_hz`` (L,) its lines, ``run_of`` (C,) the run that each
    belongs to: every run has poles of its own, as sensors rove. Rational fits of order two for each mode of those that
    overlap, a cubic beside (variable projection: Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973).
    """
    # A model's mode may have no damping, or less than none: a fit begins with some.
    hz, damping = np.asarray(start_hz, dtype=float), np.maximum(start_damping, _BEGUN_WITH)
    found: list[SeenMode | None] = [None] * hz.size
    for together in _clusters(hz, damping):
        by_run = {}
        for run in np.unique(run_of):
            own = run_of == run
            poles = _poles_of_run(values[own], sigma[own], frequency_hz, hz[together], damping[together])
            if poles is not None:
                by_run[run] = poles
        for k, mode in enumerate(together):
            found[mode] = _mean({run: poles[k] for run, poles in by_run.items()}, run_of)
    return _each_once(found, hz)


def _each_once(found: list[SeenMode | None], start_hz: Array) -> list[SeenMode | None]:
    """Modes that fits from several starts met at are that of the nearest start: of the others nothing is seen."""
    kept = list(found)
    for k, one in enumerate(found):
        for j, other in enumerate(found[:k]):
            if one is None or other is None or abs(one.frequency_hz / other.frequency_hz - 1) > _SAME:
                continue
            if (mac_of_residues(one, other) or 0.0) > _SAME_MAC:
                farther = max(k, j, key=lambda i: abs(np.log(start_hz[i] / one.frequency_hz)))
                kept[farther] = None
    return kept


def _clusters(hz: Array, damping: Array) -> list[NDArray[np.intp]]:
    """Indices of modes, together where the next one is no farther than their widths."""
    clusters: list[list[int]] = []
    for k in np.argsort(hz):
        if clusters:
            last = clusters[-1][-1]
            if hz[k] - hz[last] < _BESIDE * (hz[k] * damping[k] + hz[last] * damping[last]):
                clusters[-1].append(int(k))
                continue
        clusters.append([int(k)])
    return [np.array(c) for c in clusters]


def _poles_of_run(
    values: ComplexArray, sigma: Array, frequency_hz: Array, hz: Array, damping: Array
) -> list[_Pole | None] | None:
    """The poles that one run shows near given ones, its lines chosen anew around what was found; None without any."""
    if not np.isfinite(values).all():
        return None
    at = np.log(np.concatenate([hz, damping]))
    fitted: _Fitted | None = None
    for _ in range(_RECENTRED):
        lines = _window(frequency_hz, np.exp(at[: hz.size]), np.exp(at[hz.size :]))
        if lines.size < 2 * hz.size + _BACKGROUND + 1:
            return None
        # The level of a channel alone: weights that follow its lines would be another basis for each.
        weight = 1 / np.median(sigma[:, lines], axis=1)
        fitted = _fitted(values[:, lines] * weight[:, None], frequency_hz[lines], at)
        if fitted is None or np.abs(fitted.at[: hz.size] - np.log(hz)).max() > _ASTRAY:
            return None
        at = fitted.at
    assert fitted is not None
    poles: list[_Pole | None] = []
    for k in range(hz.size):
        own = [k, hz.size + k]
        pole = _Pole(fitted.at[own], fitted.std[own], fitted.residues[k] / weight)
        inside = np.log(2 * _LEAST_DAMPED) < pole.logarithms[1] < np.log(_MOST_DAMPED / 1.1)
        poles.append(pole if inside and pole.std[0] < _UNSURE and fitted.taken[k] > _MORE_THAN_NOISE else None)
    return poles


def _window(frequency_hz: Array, hz: Array, damping: Array) -> NDArray[np.intp]:
    """Lines around modes (k,), no fewer than their fit needs."""
    away = np.min(np.abs(frequency_hz[:, None] - hz) / (_WIDTHS * hz * damping), axis=1)
    needed = min(2 * hz.size + _BACKGROUND + _SPARE_LINES, away.size)
    return np.flatnonzero(away <= max(1.0, np.sort(away)[needed - 1]))


class _Fitted(NamedTuple):
    """Logarithms of k Hz and damping ratios, their deviations, residues (k, c), and what each takes over noise (k,)."""

    at: Array
    std: Array
    residues: ComplexArray
    taken: Array


def _fitted(data: ComplexArray, frequency_hz: Array, start: Array) -> _Fitted | None:
    """The poles that fit weighted accelerances (c, n) best, from logarithms of k Hz and damping ratios."""
    from scipy.optimize import least_squares

    count, s = start.size // 2, 2j * np.pi * frequency_hz
    middle, half = frequency_hz.mean(), max(float(np.ptp(frequency_hz)) / 2, 1e-12)
    background = np.array([((frequency_hz - middle) / half) ** k for k in range(_BACKGROUND)], dtype=complex)

    def basis(at: Array) -> ComplexArray:
        omega, ratio = 2 * np.pi * np.exp(at[:count, None]), np.exp(at[count:, None])
        # Of unit height at its peak, so that columns are alike in size.
        own = 2 * ratio * s**2 / (s**2 + 2 * ratio * omega * s + omega**2)
        return np.concatenate([own, background]).T

    def rest(columns: ComplexArray) -> ComplexArray:
        q, _ = np.linalg.qr(columns)
        return np.asarray(data.T - q @ (q.conj().T @ data.T))

    def left(at: Array) -> Array:
        found = rest(basis(at))
        return np.concatenate([found.real.ravel(), found.imag.ravel()])

    low = np.concatenate([start[:count] - 1.5 * _ASTRAY, np.full(count, np.log(_LEAST_DAMPED))])
    high = np.concatenate([start[:count] + 1.5 * _ASTRAY, np.full(count, np.log(_MOST_DAMPED))])
    begun = np.clip(start, low + 1e-6, high - 1e-6)
    scale = np.exp(np.tile(begun[count:], 2))
    try:
        found = least_squares(left, begun, bounds=(low, high), x_scale=np.maximum(scale, 1e-3), max_nfev=60)
    except np.linalg.LinAlgError:
        return None
    free = found.fun.size - 2 * data.shape[0] * (count + _BACKGROUND) - start.size
    normal = found.jac.T @ found.jac
    if free < 1 or not np.isfinite(normal).all() or np.linalg.matrix_rank(normal) < start.size:
        return None
    noise = 2 * found.cost / free
    columns = basis(found.x)
    size = np.linalg.lstsq(columns, data.T, rcond=None)[0][:count]
    without = [np.sum(np.abs(rest(np.delete(columns, k, axis=1))) ** 2) for k in range(count)]
    taken = (np.array(without) - 2 * found.cost) / (2 * data.shape[0] + 2)
    return _Fitted(
        found.x, np.sqrt(np.diag(np.linalg.inv(normal)) * noise), size * 2 * np.exp(found.x[count:, None]),
        taken / max(noise, 1e-300),
    )  # fmt: skip


def _mean(by_run: dict[np.intp, _Pole | None], run_of: NDArray[np.intp]) -> SeenMode | None:
    """What runs say of one mode together, each by how well it knows the pole."""
    known = {run: pole for run, pole in by_run.items() if pole is not None}
    if not known:
        return None
    logarithms = np.array([p.logarithms for p in known.values()])
    variance = np.maximum(np.array([p.std for p in known.values()]) ** 2, 1e-16)
    weight = 1 / variance
    middle = (weight * logarithms).sum(axis=0) / weight.sum(axis=0)
    formal = 1 / weight.sum(axis=0)
    apart = (weight * (logarithms - middle) ** 2).sum(axis=0) / weight.sum(axis=0)
    std = np.sqrt(np.maximum(formal, apart / max(len(known) - 1, 1)))
    residues = np.full(run_of.size, np.nan, dtype=complex)
    for run, pole in known.items():
        residues[run_of == run] = pole.residues
    hz, ratio = np.exp(middle)
    return SeenMode(float(hz), float(hz * std[0]), float(ratio), float(ratio * std[1]), residues, len(known))


def mac_of_residues(one: SeenMode, other: SeenMode) -> float | None:
    """Modal assurance criterion of two modes over the channels that both have; None with fewer than two of these."""
    both = np.isfinite(one.residues) & np.isfinite(other.residues)
    if both.sum() < 2:
        return None
    a, b = one.residues[both], other.residues[both]
    return float(np.abs(np.vdot(a, b)) ** 2 / max(np.vdot(a, a).real * np.vdot(b, b).real, 1e-300))
