"""How far two systems are apart seen from a feedback loop: the pointwise ν-gap.

Vinnicombe, Frequency domain uncertainty and the graph topology, IEEE Transactions on Automatic
Control 38(9), 1993; used on a flexible aircraft by Moreno et al., American Control Conference,
2014, equation 14 (which prints the identities too small for a column system).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

STANDARD_GRAVITY_M_S2 = 9.80665
_MOST_TURNS = 0.5  # beyond it the graphs of the two systems are no longer near, however small their distance


def pointwise_nu_gap(first: NDArray[np.complex128], second: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Chordal distance of two systems at every line: (responses, references, frequency) gives (frequency,).

    ψ = σ̄[(I + P2 P2ᴴ)^-½ (P2 - P1) (I + P1ᴴ P1)^-½], 0 for equal systems and 1 for the furthest.
    It depends on the units of the FRFs: scale both first so that 1 is a typical loop gain. The
    ν-gap is the maximum of ψ over all frequencies when the winding condition holds (``winding_turns``), else 1; over a
    measured band the maximum is a lower bound of it. ValueError when the shapes differ.
    """
    p1, p2 = _lines_first(first, second)
    difference = p2 - p1
    outputs, inputs = np.eye(p1.shape[1], dtype=complex), np.eye(p1.shape[2], dtype=complex)
    # σ̄(A X B)² is the largest eigenvalue of (Xᴴ A² X) B², and both factors are inputs x inputs.
    left = _h(difference) @ _solve(outputs + p2 @ _h(p2), difference)
    right = np.asarray(np.linalg.cholesky(inputs + _h(p1) @ p1), dtype=complex)
    squared = _solve(right, _h(_solve(right, left)))
    largest = np.linalg.eigvalsh((squared + _h(squared)) / 2)[:, -1]
    return np.asarray(np.sqrt(np.clip(largest, 0.0, 1.0)))


def nu_gap_of_accelerances(first: NDArray[np.complex128], second: NDArray[np.complex128]) -> NDArray[np.float64]:
    """ν-gap (frequency,) of two systems of accelerances in (m/s²)/N, (responses, references, frequency), taken in g/N.

    As in the paper; 1 at every line where the band breaks the winding condition. ValueError when the shapes differ.
    """
    systems = first / STANDARD_GRAVITY_M_S2, second / STANDARD_GRAVITY_M_S2
    gap = pointwise_nu_gap(*systems)
    return np.ones_like(gap) if abs(winding_turns(*systems)) >= _MOST_TURNS else gap


def winding_turns(first: NDArray[np.complex128], second: NDArray[np.complex128]) -> float:
    """Turns of det(I + P2ᴴ P1) about the origin along the lines of two systems (responses, references, frequency).

    Along the whole imaginary axis, from -∞ to ∞, it is a whole number, and the ν-gap is below 1 only if it makes up
    for the difference in unstable poles: 0 for two stable systems. Along a band it is what the
    band adds; half a turn there means that a loop which the one leaves stable the other may not.
    Lines must be close enough for less than half a turn between neighbours. ValueError when the shapes differ.
    """
    p1, p2 = _lines_first(first, second)
    determinant = np.linalg.det(np.eye(p1.shape[2]) + _h(p2) @ p1)
    phase = np.unwrap(np.angle(determinant))
    return float((phase[-1] - phase[0]) / (2 * np.pi))


def _lines_first(
    first: NDArray[np.complex128], second: NDArray[np.complex128]
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    p1, p2 = (np.moveaxis(np.asarray(p, dtype=complex), -1, 0) for p in (first, second))
    if p1.shape != p2.shape or p1.ndim != 3:
        raise ValueError(
            f"both systems must be (responses, references, frequency), got {np.shape(first)} and {np.shape(second)}"
        )
    return p1, p2


def _solve(matrix: NDArray[np.complex128], right: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """matrix⁻¹ right at every line."""
    return np.asarray(np.linalg.solve(matrix, right), dtype=complex)


def _h(matrix: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Conjugate transpose of the last two axes."""
    return np.asarray(matrix.conj().swapaxes(-1, -2))
