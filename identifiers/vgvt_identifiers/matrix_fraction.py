"""Right matrix fractions H = B A^-1 in the z-domain by reduced normal equations, for all model orders at once.

Guillaume, Verboven, Vanlanduit, Van der Auweraer and Peeters, A poly-reference
implementation of the least-squares complex frequency-domain estimator, IMAC 21,
2003. The band is laid round the unit circle, so the coefficients are complex
and a pole of the model is a pole of the band; its conjugate lies outside and is
part of the background. The lowest coefficient is fixed to one, which throws
poles that model noise out of the stable half plane: Cauberghe, Guillaume,
Verboven, Vanlanduit and Parloo, On the influence of the parameter constraint on
the stability of the poles and the discrimination capabilities of the
stabilisation diagrams, Mech. Syst. Signal Process. 19(5), 2005.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_CIRCLE = 0.9  # part of the unit circle that the band covers: all of it would tie its ends together
_RIDGE = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class FractionRows:
    """Rows of responses: values (R, I, K) to I references and their variance E|e|^2 (R, I, K), on lines (K,) in Hz.

    ``leakage`` (R, L, K) are the 1/F of the runs that a row was measured in:
    what a record lost at its ends is a polynomial over A times that; L is 0 where responses are free of it.
    """

    frequency_hz: NDArray[np.float64]
    values: NDArray[np.complex128]
    variance: NDArray[np.float64]
    leakage: NDArray[np.complex128]

    @property
    def weight(self) -> NDArray[np.float64]:
        """Weight (R, K) of a line in a row: one over the mean variance of its entries."""
        return np.asarray(1 / self.variance.mean(axis=1))


@dataclass(frozen=True, slots=True, eq=False)
class ReducedEquations:
    """Normal equations (R numerators taken out) up to a largest order; index of A's coefficients is (input, power).

    ``matrix`` ((n+1) I, (n+1) I); ``numerators`` (R, P, (n+1) I) give the
    coefficients of B, and those of leakage after them, as minus itself times those of A.
    """

    order: int
    inputs: int
    matrix: NDArray[np.complex128]
    numerators: NDArray[np.complex128]
    centre_rad_s: float
    step_s: float

    def z_of(self, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Points of the unit circle."""
        return np.asarray(np.exp(1j * (2 * np.pi * frequency_hz - self.centre_rad_s) * self.step_s))

    def columns(self, order: int) -> NDArray[np.intp]:
        """Indices of the coefficients of A up to ``order``."""
        return np.asarray((np.arange(self.inputs)[:, None] * (self.order + 1) + np.arange(order + 1)).ravel())


@dataclass(frozen=True, slots=True, eq=False)
class Fraction:
    """One model: coefficients (n+1, I, I) of A, poles (N,) in rad/s and in z, right vectors (N, I), shapes (N, R).

    A(z) v = 0 at a pole; the shape is B(z) v.
    """

    order: int
    coefficients: NDArray[np.complex128]
    poles_rad_s: NDArray[np.complex128]
    poles_z: NDArray[np.complex128]
    vectors: NDArray[np.complex128]
    shapes: NDArray[np.complex128]


def reduced_equations(rows: FractionRows, order: int, noise_removed: float = 0.95) -> ReducedEquations:
    """Normal equations of sum |H A - B - leakage|^2 / variance for numerators and denominators up to ``order``.

    All matrices are block Toeplitz, so that one product of the data with the
    powers of z fills them. Noise adds its own covariance to them, which biases
    poles by far more than it scatters them; ``noise_removed`` of what can be taken off while the
    equations stay definite is. All of it would be generalised total least squares, which
    gives up the clear diagram: Verboven, Guillaume, Cauberghe, Vanlanduit and
    Parloo, J. Sound Vib. 278, 2004. ValueError when there are fewer lines than unknowns of a row.
    """
    unknowns = (order + 1) * (1 + rows.leakage.shape[1])
    if rows.frequency_hz.size < unknowns + order:
        raise ValueError(f"{rows.frequency_hz.size} lines cannot hold a model of order {order}")
    omega = 2 * np.pi * rows.frequency_hz
    centre, span = float(omega[0] + omega[-1]) / 2, float(omega[-1] - omega[0])
    step = _CIRCLE * 2 * np.pi / span
    z = np.exp(1j * (omega - centre) * step)
    grams = Grams(rows, z, order)
    left, mixed, right = grams.blocks(rows.weight)
    size = left.shape[1]
    ridge = _RIDGE * np.trace(left, axis1=1, axis2=2).real / size
    numerators = np.linalg.solve(left + ridge[:, None, None] * np.eye(size), mixed)
    matrix = right - np.einsum("rpa,rpb->ab", mixed.conj(), numerators, optimize=True)
    matrix = _without_noise((matrix + matrix.conj().T) / 2, grams.noise(rows.weight), noise_removed)
    return ReducedEquations(order, rows.values.shape[1], matrix, np.asarray(numerators), centre, step)


def _without_noise(
    matrix: NDArray[np.complex128], noise: NDArray[np.complex128], removed: float
) -> NDArray[np.complex128]:
    from scipy.linalg import eigh

    largest = float(eigh(matrix, noise, eigvals_only=True, subset_by_index=[0, 0])[0])
    return np.asarray(matrix - removed * max(largest, 0.0) * noise)


class Grams:
    """Products of the columns of the equation error under any real weight of the lines."""

    __slots__ = ("_index", "_powers", "_rows")

    def __init__(self, rows: FractionRows, z: NDArray[np.complex128], order: int) -> None:
        self._rows = rows
        self._powers = z[:, None] ** np.arange(-order, order + 1)
        self._index = order + np.arange(order + 1) - np.arange(order + 1)[:, None]

    def blocks(
        self, weight: NDArray[np.float64]
    ) -> tuple[NDArray[np.complex128], NDArray[np.complex128], NDArray[np.complex128]]:
        """X^H W X (R, P, P), X^H W Y (R, P, Q) and the sum over rows of Y^H W Y (Q, Q), for weights (R, K)."""
        rows, inputs = self._rows, self._rows.values.shape[1]
        columns = [np.ones_like(rows.values[:, 0]), *rows.leakage.transpose(1, 0, 2)]
        left = self._block([[weight * a.conj() * b for b in columns] for a in columns])
        mixed = self._block([[weight * a.conj() * rows.values[:, i] for i in range(inputs)] for a in columns])
        values = rows.values
        total = [
            [(weight * values[:, i].conj() * values[:, j]).sum(axis=0)[None] for j in range(inputs)]
            for i in range(inputs)
        ]
        return left, mixed, self._block(total)[0]

    def noise(self, weight: NDArray[np.float64]) -> NDArray[np.complex128]:
        """What the noise of the responses adds to Y^H W Y (Q, Q)."""
        inputs = self._rows.values.shape[1]
        density = (weight[:, None] * self._rows.variance).sum(axis=0).astype(complex)
        empty = np.zeros(density.shape[1], dtype=complex)
        table = [[(density[i] if i == j else empty)[None] for j in range(inputs)] for i in range(inputs)]
        return np.asarray(self._block(table)[0])

    def _block(self, densities: list[list[NDArray[np.complex128]]]) -> NDArray[np.complex128]:
        """Block Toeplitz matrices from densities (rows, K) over the lines."""
        return np.asarray(np.block([[(d @ self._powers)[:, self._index] for d in line] for line in densities]))


def fraction_at(equations: ReducedEquations, order: int) -> Fraction:
    """The model of one order up to the largest, from a part of the same equations."""
    inputs, columns = equations.inputs, equations.columns(order)
    matrix = equations.matrix[np.ix_(columns, columns)]
    fixed = np.arange(columns.size) % (order + 1) == 0
    free = ~fixed
    stacked = np.zeros((columns.size, inputs), dtype=complex)
    stacked[fixed] = np.eye(inputs)
    stacked[free] = -np.linalg.solve(matrix[np.ix_(free, free)], matrix[np.ix_(free, fixed)])
    coefficients = np.asarray(stacked.reshape(inputs, order + 1, inputs).transpose(1, 0, 2))
    z, vectors = _roots(coefficients)
    numerators = -np.einsum("rpq,qi->rpi", equations.numerators[:, : equations.order + 1, columns], stacked)
    powers = z[:, None] ** np.arange(equations.order + 1)
    shapes = np.einsum("np,rpi,ni->nr", powers, numerators, vectors, optimize=True)
    poles = np.log(z) / equations.step_s + 1j * equations.centre_rad_s
    return Fraction(order, coefficients, np.asarray(poles), z, vectors, np.asarray(shapes))


def _roots(
    coefficients: NDArray[np.complex128],
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """z (N,) and v (N, I) with A(z) v = 0, from the companion matrix of 1/z."""
    order, inputs = coefficients.shape[0] - 1, coefficients.shape[1]
    companion = np.eye(order * inputs, k=-inputs, dtype=complex)
    companion[:inputs] = -coefficients[1:].transpose(1, 0, 2).reshape(inputs, order * inputs)
    if inputs == 1:
        inverse = np.linalg.eigvals(companion).astype(complex)
        vectors = np.ones((inverse.size, 1), dtype=complex)
    else:
        inverse, wide = np.linalg.eig(companion)
        # The block with the largest power of 1/z: for |1/z| > 1 the last one would be lost in round-off.
        vectors = wide[:inputs].T / np.linalg.norm(wide[:inputs], axis=0)[:, None]
    alive = np.abs(inverse) > 1e-8
    return np.asarray(1 / inverse[alive]), np.asarray(vectors[alive])
