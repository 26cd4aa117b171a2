"""The local polynomial method: a frequency response and the noise around it from one record."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError

_LINES_AT_ONCE = 1024
_LEAST_SINE = 1e-6  # of a column to those before it; flatter ones lose more digits than a plain solution may


@dataclass(frozen=True, slots=True, eq=False)
class LocalFit:
    """Frequency responses (C, R, K), their variance (C, R, K) and the noise power of the responses (C, K)."""

    values: NDArray[np.complex128]
    variance: NDArray[np.float64]
    noise_power: NDArray[np.float64]


def local_polynomial_fit(
    responses: NDArray[np.complex128],
    references: NDArray[np.complex128],
    lines: NDArray[np.intp],
    order: int = 2,
    half_width: int = 8,
) -> LocalFit:
    """Fit X(k+r) = sum_p g_p r^p F(k+r) + sum_p t_p r^p + noise over |r| <= half_width around each of ``lines``.

    ``responses`` (C, L) and ``references`` (R, L) are whole-record spectra with
    the 0 Hz line first, which is never used. At the ends of the axis the window is
    shifted inwards. The polynomial t takes up leakage. The estimate is biased
    (and its variance too large) where a resonance is as narrow as the window.
    Schoukens, Vandersteen, Barbé and Pintelon, Nonparametric preprocessing in
    system identification: a powerful tool, European Journal of Control 15, 2009.
    """
    width, unknowns = 2 * half_width + 1, (references.shape[0] + 1) * (order + 1)
    if width <= unknowns:
        raise ValueError(f"{width} lines cannot hold {unknowns} unknowns: raise half_width or lower order")
    if responses.shape[1] - 1 < width:
        raise InputError(
            "local polynomial method",
            f"the record has {responses.shape[1] - 1} frequency lines, the window needs {width}",
            "lower half_width or use a longer record",
        )
    shape = (responses.shape[0], references.shape[0], lines.size)
    fit = LocalFit(np.empty(shape, complex), np.empty(shape), np.empty((shape[0], shape[2])))
    for start in range(0, lines.size, _LINES_AT_ONCE):
        part = slice(start, start + _LINES_AT_ONCE)
        _fit_lines(fit, part, responses, references, lines[part], order, half_width)
    return fit


def local_polynomial_variance(
    response: NDArray[np.complex128],
    reference: NDArray[np.complex128],
    order: int = 2,
    half_width: int = 8,
) -> NDArray[np.float64]:
    """Variance E|G - EG|^2 of the ratio G = response / reference of two whole-record spectra (L,), shape (L,).

    The noise power of the response comes from the local polynomial fit; the
    reference counts as free of noise. NaN at 0 Hz and where the reference is zero.
    """
    lines = np.arange(1, response.size)
    noise = local_polynomial_fit(response[None], reference[None], lines, order, half_width).noise_power[0]
    power = np.abs(reference) ** 2
    variance = np.full(response.size, np.nan)
    np.divide(noise, power[1:], out=variance[1:], where=power[1:] > 0)
    return variance


def _fit_lines(
    fit: LocalFit,
    part: slice,
    responses: NDArray[np.complex128],
    references: NDArray[np.complex128],
    lines: NDArray[np.intp],
    order: int,
    half_width: int,
) -> None:
    """Fill ``fit`` for some lines at once, all responses sharing the factors of the references.

    The window of every line holds the same polynomials, so t is projected out by one constant matrix.
    """
    last = responses.shape[1] - 1
    centre = np.clip(lines, 1 + half_width, last - half_width)
    window = centre + np.arange(-half_width, half_width + 1)[:, None]
    # Offsets in units of the half width keep the powers of r well scaled.
    powers = (np.arange(-half_width, half_width + 1) / half_width)[:, None] ** np.arange(order + 1)
    rest = np.linalg.qr(powers, mode="complete")[0][:, order + 1 :].T
    around = references[:, window]
    scale = np.sqrt((np.abs(around) ** 2).mean(axis=1))
    scale[scale == 0] = 1.0
    columns = (powers.T[:, :, None] * (around / scale[:, None])[:, None]).reshape(-1, *window.shape)
    basis, triangle = _orthonormal(rest @ columns)
    least = _LEAST_SINE * np.sqrt((np.abs(columns) ** 2).sum(axis=1))
    sound = (least < np.diagonal(triangle).real.T).all(axis=0)
    at_line = ((lines - centre) / half_width) ** np.arange(order + 1)[:, None]
    weights = _value_weights(triangle, at_line, sound) / scale[:, None]
    data = rest @ responses[:, window]
    values = np.zeros((responses.shape[0], *scale.shape), complex)
    for column, vector in enumerate(basis):
        projected = np.einsum("wk,cwk->ck", vector.conj(), data)
        data -= vector * projected[:, None]
        values += weights[:, column] * projected[:, None]
    fit.values[:, :, part] = values
    fit.noise_power[:, part] = (np.abs(data) ** 2).sum(axis=1) / (data.shape[1] - basis.shape[0])
    fit.variance[:, :, part] = fit.noise_power[:, None, part] * (np.abs(weights) ** 2).sum(axis=1)
    flat = np.flatnonzero(~sound)
    if flat.size:
        _fit_flat_lines(fit, part.start + flat, responses, references, lines[flat], window[:, flat], order)


def _orthonormal(columns: NDArray[np.complex128]) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Thin QR factors of columns (N, W, K) on every line K: basis (N, W, K) and triangle (N, N, K).

    Gram and Schmidt's, twice over, which is as orthogonal as Householder's.
    """
    basis = np.empty_like(columns)
    triangle = np.zeros((columns.shape[0], columns.shape[0], columns.shape[2]), complex)
    for j, column in enumerate(columns):
        left = column.copy()
        for i in (*range(j), *range(j)):
            share = np.einsum("wk,wk->k", basis[i].conj(), left)
            left -= basis[i] * share
            triangle[i, j] += share
        size = np.sqrt((np.abs(left) ** 2).sum(axis=0))
        triangle[j, j] = size
        basis[j] = left / np.where(size > 0, size, 1.0)
    return basis, triangle


def _value_weights(
    triangle: NDArray[np.complex128], at_line: NDArray[np.float64], sound: NDArray[np.bool_]
) -> NDArray[np.complex128]:
    """Weights (R, N, K) of the projections on the basis in g(line), by forward substitution through the triangle."""
    terms, unknowns = at_line.shape[0], triangle.shape[0]
    weights = np.zeros((unknowns // terms, unknowns, sound.size), complex)
    for i, weight in enumerate(weights):
        weight[i * terms : (i + 1) * terms] = at_line
        for j in range(unknowns):
            known = weight[j] - (weight[:j] * triangle[:j, j]).sum(axis=0)
            weight[j] = np.divide(known, triangle[j, j], out=np.zeros_like(known), where=sound)
    return weights


def _fit_flat_lines(
    fit: LocalFit,
    places: NDArray[np.intp],
    responses: NDArray[np.complex128],
    references: NDArray[np.complex128],
    lines: NDArray[np.intp],
    window: NDArray[np.intp],
    order: int,
) -> None:
    """Fill ``fit`` where a reference vanishes or is a polynomial itself: the pseudo-inverse keeps the rest alive."""
    half_width = window.shape[0] // 2
    powers = ((window - lines) / half_width).T[:, :, None] ** np.arange(order + 1)
    around = references[:, window.T]
    scale = np.sqrt((np.abs(around) ** 2).mean(axis=2))
    scale[scale == 0] = 1.0
    blocks = [(spectrum / size[:, None])[:, :, None] * powers for spectrum, size in zip(around, scale, strict=True)]
    basis, triangle = np.linalg.qr(np.concatenate([*blocks, powers.astype(complex)], axis=2))
    rows = np.linalg.pinv(triangle)[:, np.arange(references.shape[0]) * (order + 1)] / scale.T[:, :, None]
    data = np.moveaxis(responses[:, window.T], 0, 2)
    projected = basis.conj().transpose(0, 2, 1) @ data
    noise = (np.abs(data - basis @ projected) ** 2).sum(axis=1).T / (window.shape[0] - basis.shape[2])
    fit.values[:, :, places] = np.moveaxis(rows @ projected, 0, 2).transpose(1, 0, 2)
    fit.noise_power[:, places] = noise
    fit.variance[:, :, places] = noise[:, None] * (np.abs(rows) ** 2).sum(axis=2).T
