"""What responses together tell of poles when the noise of measured forces is in all of them at once.

Noise of covariance C = G I + G_f H Hᴴ on a line, H the responses' accelerances (S, R) with singular vectors u and
values σ, has C⁻¹ = (I - Σ α u uᴴ) / G with α = G_f σ² / (G + G_f σ²) (Woodbury). So the information is that without
noise of the force less what lies along √α u. ``weighted_slopes`` takes for it the factor 1 / (1 + G_f Σ|H|² / G),
which hits every direction alike: right where one mode dominates, too little between close modes of other shapes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.simulation.fisher import Forces, Lines, information_of_responses, slopes_and_basis, turned

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def shared_information(
    lines: Lines,
    poles: Complex,
    residues: Complex,
    noise: tuple[Array, Complex],
    background: tuple[int, ...],
    forces: Forces,
) -> Array:
    """Information (2 M, 2 M) of responses with ``residues`` (M, S) about all real, then all imaginary parts of poles.

    ``noise`` are the density of each response's own (K,) and what the forces' adds, √G_f H (S, R, K); ``background``
    are powers of s. Less what residues and background of each response can imitate, as in ``weighted_slopes``.
    """
    own, felt = noise
    slopes, basis = slopes_and_basis(lines, poles, 4 / own, background, forces)
    shared = _along(felt / np.sqrt(own))
    by_pole = np.einsum("drk,kj,djp->rkp", shared, _complex(slopes), turned(residues))
    imitated = np.einsum("drk,kc->rkdc", shared, _complex(basis))
    lost, rest = _real(by_pole, by_pole.shape[2]), _real(imitated, residues.shape[1] * basis.shape[1])
    common = rest.T @ lost
    free = information_of_responses(slopes.T @ slopes, residues).sum(axis=0)
    both = np.linalg.solve(np.eye(rest.shape[1]) - rest.T @ rest, common)
    return np.asarray(free - lost.T @ lost - common.T @ both)


def _along(felt: Complex) -> Complex:
    """Conjugates of √α u, (S, R', K), of noise √(G_f/G) H (S, R, K)."""
    left, value, _ = np.linalg.svd(np.moveaxis(felt, 2, 0), full_matrices=False)
    return np.moveaxis((left * (value / np.sqrt(1 + value**2))[:, None, :]).conj(), 0, 2)


def _complex(stacked: Array) -> Complex:
    """Columns (K, C) of what has real above imaginary parts (2 K, C)."""
    real, imaginary = np.split(stacked, 2)
    return np.asarray(real + 1j * imaginary)


def _real(columns: Complex, count: int) -> Array:
    """Real above imaginary parts (rows, ``count``) of columns with two leading axes for the rows."""
    flat = columns.reshape(-1, count)
    return np.vstack([flat.real, flat.imag])
