"""The MAC family: how alike two shapes are.

Allemang, The modal assurance criterion: twenty years of use and abuse,
Sound and Vibration 37(8), 2003.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def modal_assurance(first: NDArray[np.number], second: NDArray[np.number]) -> NDArray[np.float64]:
    """MAC between every shape of ``first`` (M, D) and of ``second`` (N, D), shape (M, N).

    MAC = |a^H b|^2 / (a^H a · b^H b); a shape of zeros has MAC 0 with everything, one that is not finite NaN.
    """
    a, b = np.atleast_2d(first), np.atleast_2d(second)
    if a.shape[1] != b.shape[1]:
        raise ValueError(f"shapes must share their DOFs: {a.shape[1]} against {b.shape[1]}")
    with np.errstate(invalid="ignore"):
        cross = np.abs(a.conj() @ b.T) ** 2
        power = np.outer((np.abs(a) ** 2).sum(axis=1), (np.abs(b) ** 2).sum(axis=1))
        return np.asarray(np.divide(cross, power, out=np.zeros_like(power), where=power != 0))


def auto_mac(shapes: NDArray[np.number]) -> NDArray[np.float64]:
    """MAC of a set of shapes (M, D) with itself, shape (M, M)."""
    return modal_assurance(shapes, shapes)


def modal_phase_collinearity(shapes: NDArray[np.number]) -> NDArray[np.float64]:
    """MPC of each shape (M, D), shape (M,): 1 for a real shape times a phase, towards 0 for a complex one.

    Pappa, Elliott and Schenk, Consistent-mode indicator for the eigensystem
    realization algorithm, J. Guidance 16(5), 1993. A shape of zeros has MPC 0, one that is not finite NaN.
    """
    a = np.atleast_2d(shapes)
    with np.errstate(invalid="ignore"):
        xx = (a.real**2).sum(axis=1)
        yy = (a.imag**2).sum(axis=1)
        xy = (a.real * a.imag).sum(axis=1)
        total = (xx + yy) ** 2
        return np.asarray(np.divide((xx - yy) ** 2 + 4 * xy**2, total, out=np.zeros_like(total), where=total != 0))
