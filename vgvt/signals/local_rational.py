"""The local rational method: frequency responses to several forces that act at once, from whole records.

Around a line the responses are ratios of polynomials: A(r) X(k+r) = sum_j B_j(r) F_j(k+r) + T(r) + noise, with T
for what the ends of the record leak. The denominator A, which is that of the modes nearby, is common to all
responses, so that a resonance narrower than the window is followed, where a window in time or a polynomial
would make it wide. McKelvey and Guérin, Non-parametric frequency response estimation using a
local rational model, IFAC Proceedings Volumes 45(16), 2012.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError

_LINES_AT_ONCE = 512
_LEAST_SINE = 1e-6  # of a column to those before it; with flatter ones the forces do not fill the window
_DENOMINATOR = 2  # modes in a window that are followed
_ROUNDS = 2  # of the weights of the responses in their common denominator
_FLOOR = 1e-12  # noise that a response has at least, a part of itself

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, eq=False)
class RunLines:
    """Whole-record spectra of one run with the 0 Hz line first: references (R, L) and responses (C, L)."""

    step_hz: float
    references: ComplexArray
    responses: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class RationalFit:
    """Frequency responses (C, R, K), their variance (C, R, K), and sums of F_i F_j* over the windows (R, R, K).

    NaN at lines whose window the forces do not fill.
    """

    values: ComplexArray
    variance: Array
    power: ComplexArray


def rational_half_width(references: int, runs: int, order: int = 2) -> int:
    """Half the lines of a window that hold twice what a run adds to be found, and three to spare."""
    return -(-(references + runs) * (order + 1) // runs) + 1


def local_rational_fit(
    runs: Sequence[RunLines], frequency_hz: Array, order: int = 2, half_width: int = 8
) -> RationalFit:
    """One fit of all ``runs`` (same references and responses, lines of their own) around every ``frequency_hz`` (K,).

    Polynomials of ``order`` over the 2 ``half_width`` + 1 lines of every run around a frequency, shifted inwards at
    the ends of the axis. InputError for a record with fewer lines.
    """
    width, unknowns = 2 * half_width + 1, runs[0].references.shape[0] * (order + 1)
    if len(runs) * (width - order - 1) <= unknowns + _DENOMINATOR:
        raise ValueError(f"{width} lines of {len(runs)} runs cannot hold the unknowns: raise half_width or lower order")
    fewest = min(run.references.shape[1] - 1 for run in runs)
    if fewest < width:
        raise InputError(
            "local rational method",
            f"the shortest record has {fewest} frequency lines, the window needs {width}",
            "use a longer record, or an estimator that averages",
        )
    parts = [
        _fit_lines(runs, frequency_hz[start : start + _LINES_AT_ONCE], order, half_width)
        for start in range(0, frequency_hz.size, _LINES_AT_ONCE)
    ]
    return RationalFit(
        np.concatenate([p.values for p in parts], axis=2),
        np.concatenate([p.variance for p in parts], axis=2),
        np.concatenate([p.power for p in parts], axis=2),
    )


def _fit_lines(runs: Sequence[RunLines], frequency_hz: Array, order: int, half_width: int) -> RationalFit:
    offsets = np.arange(-half_width, half_width + 1)
    # What polynomials over the lines can follow is the same space wherever they start: T is projected out once.
    polynomials = (offsets / half_width)[:, None] ** np.arange(order + 1)
    rest = np.linalg.qr(polynomials, mode="complete")[0][:, order + 1 :].T
    scale_hz = half_width * max(run.step_hz for run in runs)
    places, columns, data = [], [], []
    power: ComplexArray = np.zeros((frequency_hz.size, *[runs[0].references.shape[0]] * 2), complex)
    for run in runs:
        last = run.references.shape[1] - 1
        centre = np.clip(np.rint(frequency_hz / run.step_hz).astype(int), 1 + half_width, last - half_width)
        window = centre[:, None] + offsets
        place = (window * run.step_hz - frequency_hz[:, None]) / scale_hz
        forces = run.references[:, window].transpose(1, 0, 2)
        power += forces @ forces.conj().transpose(0, 2, 1)
        places.append(place)
        # The powers of one reference side by side, (K, W, R (order + 1)).
        powers = place[:, :, None, None] ** np.arange(order + 1)
        columns.append(rest @ (forces.transpose(0, 2, 1)[..., None] * powers).reshape(*window.shape, -1))
        moved = run.responses[:, window].transpose(1, 2, 0)
        data.append([rest @ (moved * place[:, :, None] ** q) for q in range(_DENOMINATOR + 1)])
    together = [np.concatenate([d[q] for d in data], axis=1) for q in range(_DENOMINATOR + 1)]
    basis, triangle, scale, sound = _factors(np.concatenate(columns, axis=1))
    terms, noise, doubt = _denominators(basis, together)
    numerator = sum(terms[:, q, None, None] * together[q] for q in range(_DENOMINATOR + 1))
    back = np.linalg.inv(triangle)[:, :: order + 1] / scale[:, :: order + 1, None]
    weights = back @ basis.conj().transpose(0, 2, 1)
    values = np.where(sound[:, None, None], weights @ numerator, np.nan)
    # What the values owe to the denominator is uncertain with it, and independent of the rest: (Q, K, R, C).
    slopes = np.array([weights @ part for part in together[1:]])
    shared = np.einsum("qkrc,kqp,pkrc->crk", slopes, doubt, slopes.conj()).real
    variance = _spread(weights, rest, places, terms)[None] * noise.T[:, None] + shared
    return RationalFit(values.transpose(2, 1, 0), np.where(sound, variance, np.nan), power.transpose(1, 2, 0))


def _factors(columns: ComplexArray) -> tuple[ComplexArray, ComplexArray, Array, NDArray[np.bool_]]:
    """Basis (K, W, N) and triangle (K, N, N) of columns over their scale (K, N), and which lines they suffice on."""
    scale = np.sqrt((np.abs(columns) ** 2).sum(axis=1))
    scale = np.where(scale > 0, scale, 1.0)
    basis, triangle = np.linalg.qr(columns / scale[:, None])
    sound = np.abs(np.diagonal(triangle, axis1=1, axis2=2)).min(axis=1) > _LEAST_SINE
    triangle = np.where(sound[:, None, None], triangle, np.eye(triangle.shape[1]))
    return basis, triangle, scale, np.asarray(sound)


def _denominators(basis: ComplexArray, data: list[ComplexArray]) -> tuple[ComplexArray, Array, ComplexArray]:
    """Terms (K, 1 + Q) of A, the first of them 1, the noise power (K, C) of A X, and the covariance (K, Q, Q) of terms.

    Least squares over all responses, each weighted by the noise that the round before leaves.
    """
    left = [d - basis @ (basis.conj().transpose(0, 2, 1) @ d) for d in data]
    lines, rows, responses = left[0].shape
    freedom = rows - basis.shape[2]
    least = _FLOOR**2 * (np.abs(data[0]) ** 2).mean(axis=1) + np.finfo(float).tiny
    noise = np.maximum((np.abs(left[0]) ** 2).sum(axis=1) / freedom, least)
    terms = np.ones((lines, len(data)), complex)
    inverse: ComplexArray = np.zeros((lines, len(data) - 1, len(data) - 1), complex)
    for _ in range(_ROUNDS):
        weight = 1 / np.sqrt(noise)[:, None]
        wanted = -(left[0] * weight).reshape(lines, -1, 1)
        slopes = np.stack([(part * weight).reshape(lines, -1) for part in left[1:]], axis=2)
        normal = slopes.conj().transpose(0, 2, 1) @ slopes
        inverse = np.linalg.pinv(normal, rcond=_FLOOR, hermitian=True)
        terms[:, 1:] = (inverse @ (slopes.conj().transpose(0, 2, 1) @ wanted))[:, :, 0]
        error = sum(terms[:, q, None, None] * part for q, part in enumerate(left))
        spare = freedom - (len(data) - 1) / responses
        noise = np.maximum((np.abs(error) ** 2).sum(axis=1) / spare, least)
    return terms, noise, inverse


def _spread(weights: ComplexArray, rest: Array, places: list[Array], terms: ComplexArray) -> Array:
    """Variance (R, K) of the values for unit noise power of A X, whose noise is A times that of X."""
    size = rest.shape[0]
    total: Array = np.zeros(weights.shape[:2])
    mean: Array = np.zeros(weights.shape[0])
    for number, place in enumerate(places):
        own = weights[:, :, number * size : (number + 1) * size] @ rest
        denominator = np.abs(sum(terms[:, q, None] * place**q for q in range(terms.shape[1]))) ** 2
        total = total + (np.abs(own) ** 2 * denominator[:, None]).sum(axis=2)
        mean = mean + denominator.mean(axis=1) / len(places)
    return np.asarray((total / mean[:, None]).T)
