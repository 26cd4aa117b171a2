"""Standard deviations of the poles of a matrix fraction, by first-order propagation of the noise of the responses.

Pintelon, Guillaume and Schoukens, Uncertainty calculation in (operational)
modal analysis, Mech. Syst. Signal Process. 21(6), 2007. An error of a response
enters the equations times A; the equations give the error of the coefficients
of A, and those the error of a pole.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.matrix_fraction import Fraction, FractionRows, ReducedEquations


def pole_deviations(
    rows: FractionRows, equations: ReducedEquations, fraction: Fraction, which: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Standard deviations (P, 2) in rad/s of the real and the imaginary part of the poles ``which`` (P,).

    They hold where noise is small: neither bias nor the share of noise in the equations themselves is in them.
    """
    columns = equations.columns(fraction.order)
    free = np.arange(columns.size) % (fraction.order + 1) > 0
    kept = columns[free]
    inverse = np.linalg.inv(equations.matrix[np.ix_(kept, kept)])
    z = equations.z_of(rows.frequency_hz)
    powers = z[:, None] ** np.arange(equations.order + 1)
    # A on the lines (K, I, I), for the noise that A passes on into the equations.
    on_lines = np.einsum("kp,pij->kij", powers[:, : fraction.order + 1], fraction.coefficients)
    deviations = np.empty((which.size, 2))
    for row, pole in enumerate(which):
        gradient, slope = _gradient(fraction, int(pole))
        direction = np.zeros(equations.matrix.shape[0], dtype=complex)
        direction[kept] = inverse @ gradient[free].conj()
        seen = _equation_columns(rows, equations, powers, direction)
        passed = np.abs(on_lines @ fraction.vectors[pole]) ** 2
        noise = np.einsum("rik,ki->rk", rows.variance, passed)
        variance_z = (rows.weight**2 * np.abs(seen) ** 2 * noise).sum() / abs(slope) ** 2
        deviations[row] = np.sqrt(variance_z / 2) / abs(fraction.poles_z[pole] * equations.step_s)
    return deviations


def _gradient(fraction: Fraction, pole: int) -> tuple[NDArray[np.complex128], complex]:
    """Derivative of u^H A(z) v by the coefficients, (input, power), and by z."""
    z, right = fraction.poles_z[pole], fraction.vectors[pole]
    power = np.arange(fraction.order + 1)
    at_pole = np.einsum("p,pij->ij", z**power, fraction.coefficients)
    left = np.linalg.svd(at_pole)[0][:, -1]
    slope = np.einsum("p,pij->ij", power * z ** (power - 1.0), fraction.coefficients)
    return np.outer(left.conj(), z**power).ravel(), complex(left.conj() @ slope @ right)


def _equation_columns(
    rows: FractionRows,
    equations: ReducedEquations,
    powers: NDArray[np.complex128],
    direction: NDArray[np.complex128],
) -> NDArray[np.complex128]:
    """The equation error (R, K) that a direction of the coefficients of A makes, numerators taken out."""
    size = equations.order + 1
    per_input = direction.reshape(equations.inputs, size) @ powers.T
    error = np.einsum("rik,ik->rk", rows.values, per_input)
    numerators = equations.numerators @ direction
    error -= numerators[:, :size] @ powers.T
    for column in range(rows.leakage.shape[1]):
        part = numerators[:, (column + 1) * size : (column + 2) * size]
        error -= rows.leakage[:, column] * (part @ powers.T)
    return np.asarray(error)
