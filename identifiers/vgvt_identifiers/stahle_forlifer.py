"""Separates the modes that share a quadrature response.

Stahle and Forlifer, Ground vibration testing of complex structures, Flight
Flutter Testing Symposium, 1958: at the natural frequency of mode i the
quadrature response of a point is sum_j P_ij Q_j, where Q_j is what mode j alone
shows at its own resonance. With C_j the modal constant, the receptance of one mode is
C_j / (w_j^2 - w^2 + 2 i zeta_j w_j w) (viscous) or C_j / (w_j^2 (1 + i g_j) - w^2)
(structural); the ratio of its imaginary part at w_i to that at w_j gives P.
An accelerance is -w^2 times the receptance, hence a further r^2, r = w_i / w_j.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

Damping = Literal["viscous", "structural"]


def participation_matrix(
    natural_frequency_hz: NDArray[np.float64],
    damping_ratio: NDArray[np.float64],
    damping: Damping = "viscous",
    differentiations: int = 2,
) -> NDArray[np.float64]:
    """P (M, M): quadrature of mode j at the natural frequency of mode i over that at its own.

    ``damping`` viscous takes zeta, structural takes the loss factor g = 2 zeta;
    ``differentiations`` is 0 for receptances, 2 for accelerances. ValueError for
    1, where the quadrature response of a mobility vanishes at resonance.
    """
    if differentiations not in (0, 2):
        raise ValueError(f"differentiations must be 0 (receptance) or 2 (accelerance), got {differentiations}")
    ratio = natural_frequency_hz[:, None] / natural_frequency_hz[None, :]
    loss = 2 * damping_ratio[None, :]
    if damping == "viscous":
        share = loss**2 * ratio / ((1 - ratio**2) ** 2 + (loss * ratio) ** 2)
    else:
        share = loss**2 / ((1 - ratio**2) ** 2 + loss**2)
    return np.asarray(share * ratio**differentiations)


def separate_quadratures(quadrature: NDArray[np.float64], participation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Q (M, D) of the modes alone from the quadrature responses (M, D) at their natural frequencies."""
    return np.asarray(np.linalg.solve(participation, quadrature))
