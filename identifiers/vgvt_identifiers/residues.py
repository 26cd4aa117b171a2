"""Residues of one run for known poles: weighted linear least squares over all lines at once.

A_o(s) = s^2 sum_m [R_om / (s - p_m) + conj] + rest_o(s) + T_o(s) / F(s),  s = i omega

A real structure has a real impulse response, so the upper and the lower pole
share one complex residue and the rest has real coefficients of s: below the
band modes leave a mass line (1, 1/s, 1/s^2), above it stiffness lines (s, s^2,
s^3); Ewins, Modal Testing, 2nd ed., 2000, section 4.4. T is what a cut record
still rings with and has the same poles; Pintelon, Schoukens and Vandersteen,
Automatica 33(5), 1997.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.spectra import RunSpectra
from vgvt_identifiers.too_few import TooFewError
from vgvt_identifiers.weighted_rows import solve_rows

_TRANSIENT_POLYNOMIALS = 2


@dataclass(frozen=True, slots=True, eq=False)
class Residues:
    """Receptance residues of one run, H(s) = sum R / (s - p) + conj in m/(N s), and the curves they make.

    ``residues`` and ``std`` (R, M) hold R and the root of E|error|^2 per response
    and pole; ``fitted`` (R, K) is the accelerance without the transient,
    ``transient`` (R, K) the transient over the force, ``errors`` (R, K) what is
    left of the measured ratio, ``chi_square`` (R,) its weighted mean square per degree of freedom.
    A response has so many real ``unknowns``.
    """

    poles: NDArray[np.complex128]
    residues: NDArray[np.complex128]
    std: NDArray[np.float64]
    fitted: NDArray[np.complex128]
    transient: NDArray[np.complex128]
    errors: NDArray[np.complex128]
    chi_square: NDArray[np.float64]
    unknowns: int


def fit_residues(
    run: RunSpectra,
    frequency_hz: NDArray[np.float64],
    poles_rad_s: NDArray[np.complex128],
    *,
    variance: NDArray[np.float64] | None = None,
    lower_terms: int = 2,
    upper_terms: int = 2,
    transient: bool = True,
) -> Residues:
    """Residues of the poles (M,), upper half plane, in the ratios of ``run`` on ``frequency_hz`` (K,).

    ``variance`` (R, K) is E|error|^2 of the ratios, that of the run if left out;
    standard deviations are scaled by the misfit, never down. ``lower_terms`` and
    ``upper_terms`` (0 to 3) are the real terms for modes outside the band.
    Lines without force are left out. TooFewError for fewer equations than unknowns.
    """
    poles = np.asarray(poles_rad_s, dtype=np.complex128)
    smooth = _smooth_columns(frequency_hz, poles, lower_terms, upper_terms)
    alive = np.abs(run.force) > 0
    noise = run.variance if variance is None else variance
    rings = transient and not run.averaged
    leaked = _transient_columns(frequency_hz, run.force, poles) if rings else np.empty((alive.size, 0), complex)
    design = np.hstack([smooth, leaked])
    if 2 * int(alive.sum()) <= design.shape[1]:
        raise TooFewError(f"{int(alive.sum())} lines cannot hold {design.shape[1]} real unknowns a response")
    solved = solve_rows(design, run.accelerance, np.where(alive, noise, np.inf))
    found, count = solved.coefficients, poles.size
    # Columns are scaled to size one at the pole: a receptance residue is 1/|p|^2 of them.
    scale = 1 / np.abs(poles) ** 2
    residues = np.asarray((found[:, :count] + 1j * found[:, count : 2 * count]) * scale, complex)
    spread = solved.variance[:, :count] + solved.variance[:, count : 2 * count]
    std = np.sqrt(spread * np.maximum(1.0, solved.chi_square)[:, None]) * scale
    fitted = np.asarray(found[:, : smooth.shape[1]] @ smooth.T, complex)
    rest = np.asarray(found[:, smooth.shape[1] :] @ leaked.T, complex)
    errors = np.asarray((run.accelerance - fitted - rest) * alive)
    return Residues(poles, residues, std, fitted, rest, errors, solved.chi_square, design.shape[1])


def _smooth_columns(
    frequency_hz: NDArray[np.float64], poles: NDArray[np.complex128], lower: int, upper: int
) -> NDArray[np.complex128]:
    """Columns (K, 2 M + lower + upper): real and imaginary part of every residue, then the real terms of s."""
    s = 2j * np.pi * frequency_hz
    middle = abs(s[frequency_hz.size // 2])
    scaled = s / middle
    size = s[:, None] ** 2 / np.abs(poles) ** 2
    above, below = size / (s[:, None] - poles), size / (s[:, None] - poles.conj())
    low = scaled[:, None] ** -np.arange(lower)
    high = scaled[:, None] ** np.arange(1, upper + 1)
    return np.hstack([above + below, 1j * (above - below), low, high])


def _transient_columns(
    frequency_hz: NDArray[np.float64], force: NDArray[np.complex128], poles: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """Columns (K, 2 M + 2) of what rings at the ends of the record, over the force; zero where there is none."""
    s = 2j * np.pi * frequency_hz
    above, below = 1 / (s[:, None] - poles), 1 / (s[:, None] - poles.conj())
    plain = (s / abs(s[-1]))[:, None] ** np.arange(_TRANSIENT_POLYNOMIALS)
    columns = np.hstack([above + below, 1j * (above - below), plain])
    inverse = np.divide(1, force, out=np.zeros_like(force), where=np.abs(force) > 0)
    return np.asarray(columns * inverse[:, None])
