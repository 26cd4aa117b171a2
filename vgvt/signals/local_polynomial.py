"""The local polynomial method: a frequency response and the noise around it from one record."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError

_LINES_AT_ONCE = 4096


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
    """Fill ``fit`` for some lines: one thin QR a line, shared by all responses."""
    inputs, last = references.shape[0], responses.shape[1] - 1
    centre = np.clip(lines, 1 + half_width, last - half_width)
    window = centre[:, None] + np.arange(-half_width, half_width + 1)
    # Offsets in units of the half width keep the powers of r well scaled.
    powers = ((window - lines[:, None]) / half_width)[:, :, None] ** np.arange(order + 1)
    scale = np.sqrt((np.abs(references[:, window]) ** 2).mean(axis=2))
    scale[scale == 0] = 1.0
    blocks = [(references[i][window] / scale[i][:, None])[:, :, None] * powers for i in range(inputs)]
    basis, triangle = np.linalg.qr(np.concatenate([*blocks, powers.astype(complex)], axis=2))
    freedom = window.shape[1] - basis.shape[2]
    # Where the reference vanishes the fit is singular; the pseudo-inverse keeps the rest alive.
    inverse = np.linalg.pinv(triangle)
    columns = np.arange(inputs) * (order + 1)
    gain = (np.abs(inverse[:, columns, :]) ** 2).sum(axis=2).T / scale**2
    for c, response in enumerate(responses):
        data = response[window][:, :, None]
        projected = basis.conj().transpose(0, 2, 1) @ data
        residual = data - basis @ projected
        fit.noise_power[c, part] = (np.abs(residual[:, :, 0]) ** 2).sum(axis=1) / freedom
        fit.values[c, :, part] = (inverse @ projected)[:, columns, 0].T / scale
        fit.variance[c, :, part] = fit.noise_power[c, part] * gain
