"""What a test can know of poles at all: their Fisher information, close modes and all.

Responses A = H F + n with H = s² Σ (R / (s - p) + conj) + background. The information about
the poles of all modes together is the integral of 4 |F|² Re(∂H* ∂H) / G over
frequency, less what residues and background of each response can imitate (Schur complement). For one mode
alone it gives the closed form std(f) = sqrt(2 s / (E |H|² / G)) / 2π; see
Pintelon and Schoukens, System Identification, 2nd ed., 2012, chapter 9, and for the noise of the measured
force Sherman and Morrison: information about H falls by 1 + G_f Σ |H_o|² / G_o. That
factor is exact where one mode dominates; between close modes it leaves too little: see ``shared_noise``.

Several forces F_r push mode m as one, u_m = Σ_r share_mr F_r, as its residues for them stand in fixed proportions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

BACKGROUND = (-1, 0, 1, 2)
"""Powers of s, real coefficients, that stand for the modes below and above at least."""
_NEAR = 40
_SPREAD = 300


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """Frequencies (K,) and the part of the axis that each stands for, Hz (K,)."""

    frequency_hz: Array
    width_hz: Array


@dataclass(frozen=True, slots=True, eq=False)
class Forces:
    """Transforms of R forces on lines, N s (R, K), and the ``shares`` (M, R) that M modes take in them.

    ``independent`` (P, K) are what acts on the rest of each response: combinations of them, one for each command.
    """

    spectra: Complex
    shares: Complex
    independent: Complex

    def of(self, modes: NDArray[np.intp] | list[int]) -> Forces:
        """The same forces for some of the modes."""
        return replace(self, shares=self.shares[modes])

    def pushes(self) -> tuple[Complex, Complex]:
        """What pushes the modes, and what pushes their conjugates, N s (K, M) each."""
        return self.spectra.T @ self.shares.T, self.spectra.T @ self.shares.conj().T


@dataclass(frozen=True, slots=True, eq=False)
class RunInformation:
    """The information of one run about poles p (M,): ``matrix`` (2 M, 2 M) for all real, then all imaginary parts."""

    poles: Complex
    matrix: Array

    def deviations(self) -> tuple[Array, Array]:
        """Least standard deviations of the natural frequencies, Hz (M,), and of the damping ratios (M,)."""
        return deviations(self.poles, self.matrix)


def lines_for(band_hz: tuple[float, float], poles: Complex) -> Lines:
    """Lines (K,) over a band, dense where ``poles`` (M,) rad/s make the responses change, for the trapezoidal rule.

    None at 0 Hz, where an accelerance is nothing and what stands for the modes below has no end.
    """
    low, high = band_hz
    angle = np.linspace(-0.496, 0.496, 2 * _NEAR + 1) * np.pi
    near = [np.abs(p) - p.real * np.tan(angle) for p in poles]
    every = np.concatenate([np.linspace(low, high, _SPREAD), *(w / (2 * np.pi) for w in near)])
    frequency = np.unique(every[(every >= low) & (every <= high) & (every > 0)])
    half = np.diff(frequency) / 2
    return Lines(frequency, np.concatenate([half, [0.0]]) + np.concatenate([[0.0], half]))


def accelerance(frequency_hz: Array, poles: Complex, residues: Complex) -> Complex:
    """H (D, K) at frequencies (K,) of modes with poles (M,) and residues (M, D), receptance times s²."""
    s = 2j * np.pi * frequency_hz
    above, below = 1 / (s - poles[:, None]), 1 / (s - poles.conj()[:, None])
    return np.asarray(s**2 * (residues.T @ above + residues.conj().T @ below))


def weighted_slopes(
    lines: Lines,
    poles: Complex,
    weight: Array,
    background: tuple[int, ...] = BACKGROUND,
    forces: Forces | None = None,
) -> Array:
    """Gram matrix (2 M, 2 M) of the pole slopes, per unit of residue, freed of what residues and background imitate.

    ``weight`` (K,) is 4 |F|² / G on the ``lines``, or 4 / G where ``forces`` of these modes are given; ``background``
    are the powers of s of the rest. Rows: M slopes for the residues' real, M for their imaginary parts.
    """
    left, _ = slopes_and_basis(lines, poles, weight, background, forces)
    return np.asarray(left.T @ left)


def slopes_and_basis(
    lines: Lines, poles: Complex, weight: Array, background: tuple[int, ...], forces: Forces | None = None
) -> tuple[Array, Array]:
    """The slopes (2 K, 2 M) behind ``weighted_slopes``, and an orthonormal basis (2 K, C) of what can imitate them."""
    s = 2j * np.pi * lines.frequency_hz[:, None]
    above, below = 1 / (s - poles), 1 / (s - poles.conj())
    root = np.sqrt(weight * lines.width_hz)
    rest = background_columns(lines, background, forces)
    columns = stacked(np.hstack([mode_columns(lines, poles, forces), rest]), root)
    slopes = stacked(s**2 * _pair(above**2, below**2, forces), root)
    size = np.linalg.norm(columns, axis=0)
    basis, _ = np.linalg.qr(columns / np.where(size > 0, size, 1.0))
    return slopes - basis @ (basis.T @ slopes), basis


def information_of_responses(gram: Array, residues: Complex) -> Array:
    """What each response tells about the poles: (D, 2 M, 2 M) from ``weighted_slopes`` and residues (M, D)."""
    each = turned(residues)
    return np.asarray(np.einsum("oip,ij,ojq->opq", each, gram, each, optimize=True))


def turned(residues: Complex) -> Array:
    """Factors (D, 2 M, 2 M) that turn slopes per unit of residue into slopes by poles, for residues (M, D)."""
    count, responses = residues.shape
    factors = np.zeros((responses, 2 * count, 2 * count))
    index = np.arange(count)
    # dH/dRe p has the coefficients (a, b) of the residue a + jb, dH/dIm p those of j (a + jb) = -b + ja.
    factors[:, index, index] = residues.real.T
    factors[:, count + index, index] = residues.imag.T
    factors[:, index, count + index] = -residues.imag.T
    factors[:, count + index, count + index] = residues.real.T
    return factors


def deviations(poles: Complex, information: Array) -> tuple[Array, Array]:
    """Standard deviations of frequencies, Hz (M,), and damping ratios (M,) from the information (2 M, 2 M).

    Infinite for a mode that the information says nothing about.
    """
    count = poles.size
    size = np.sqrt(np.maximum(np.diag(information), 0.0))
    known = size > 0
    std_hz, std_ratio = np.full(count, np.inf), np.full(count, np.inf)
    seen = np.flatnonzero(known[:count] & known[count:])
    if not seen.size:
        return std_hz, std_ratio
    both = np.concatenate([seen, count + seen])
    scaled = information[np.ix_(both, both)] / size[both, None] / size[both]
    covariance = np.linalg.pinv(scaled, hermitian=True) / size[both, None] / size[both]
    x, y, radius = poles[seen].real, poles[seen].imag, np.abs(poles[seen])
    towards_f = np.hstack([np.diag(x / radius), np.diag(y / radius)]) / (2 * np.pi)
    towards_ratio = np.hstack([np.diag(x**2 / radius**3 - 1 / radius), np.diag(x * y / radius**3)])
    std_hz[seen] = np.sqrt(np.einsum("ij,jk,ik->i", towards_f, covariance, towards_f))
    std_ratio[seen] = np.sqrt(np.einsum("ij,jk,ik->i", towards_ratio, covariance, towards_ratio))
    return std_hz, std_ratio


def mean_deviation(values: Array, deviation: Array) -> float:
    """Standard deviation of the mean of runs' estimates with ``deviation`` (R,) of true ``values`` (R,)."""
    seen = np.isfinite(deviation)
    if not seen.any():
        return float("inf")
    return float(np.sqrt(((mean_weights(values, deviation)[seen] * deviation[seen]) ** 2).sum()))


def mean_weights(values: Array, deviation: Array) -> Array:
    """Weights (R,) in the mean of runs' estimates with ``deviation`` (R,) of true ``values`` (R,), 0 for unseen ones.

    Runs that differ more than their noise count alike, runs of one and the same
    value by their information: the weights of a random-effects mean (Laird and Ware, Biometrics 38(4), 1982).
    """
    seen = np.isfinite(deviation)
    if not seen.any():
        return np.zeros(deviation.shape)
    between = float(np.var(values[seen], ddof=1)) if seen.sum() > 1 else 0.0
    weight = np.where(seen, 1 / (np.where(seen, deviation, 1.0) ** 2 + between), 0.0)
    return np.asarray(weight / weight.sum())


def _pair(above: Complex, below: Complex, forces: Forces | None) -> Complex:
    """Columns (K, 2 M) for real and imaginary parts of a complex factor of ``above``, its conjugate with ``below``."""
    if forces is not None:
        push, conjugate = forces.pushes()
        above, below = above * push, below * conjugate
    return np.hstack([above + below, 1j * (above - below)])


def mode_columns(lines: Lines, poles: Complex, forces: Forces | None = None) -> Complex:
    """Responses (K, 2 M) of poles (M,), rad/s, with residues 1, then with residues j, on ``lines``.

    Accelerances, or accelerations under the ``forces`` of these modes.
    """
    s = 2j * np.pi * lines.frequency_hz[:, None]
    return np.asarray(s**2 * _pair(1 / (s - poles), 1 / (s - poles.conj()), forces))


def background_columns(lines: Lines, powers: tuple[int, ...], forces: Forces | None = None) -> Complex:
    """Powers of s on ``lines``, (K, P), with s one in size in the middle; under each independent one of ``forces``."""
    s = 2j * np.pi * lines.frequency_hz[:, None]
    alone = (s / np.abs(s[s.size // 2])) ** powers
    return np.asarray(alone if forces is None else np.hstack([alone * f[:, None] for f in forces.independent]))


def stacked(columns: Complex, root: Array) -> Array:
    """Real parts above imaginary parts of columns (K, C) times ``root`` (K,), (2 K, C)."""
    return np.vstack([columns.real * root[:, None], columns.imag * root[:, None]])
