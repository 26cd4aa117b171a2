"""The eigensystem realization algorithm on a Hankel matrix, and what noise of the impulse response does to its roots.

Juang and Pappa, An eigensystem realization algorithm for modal parameter
identification and model reduction, J. Guidance 8(5), 1985. The singular values
come from the small side: the Gram matrix of a Hankel matrix obeys
G[i+1, j+1] = G[i, j] + (last row) - (first row), so it costs one row of
products instead of all of them. That squares the range of singular values,
so those below about 1e-7 of the largest are lost; no measured response is that clean.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.too_few import TooFewError

_SMALLEST = 1e-7


@dataclass(frozen=True, slots=True, eq=False)
class Roots:
    """The n roots z of a model in the upper half plane, and the eigenvectors of its state matrix that belong to them.

    ``right`` (order, n) and ``left`` (n, order), scaled so that left @ right is the identity.
    """

    values: NDArray[np.complex128]
    right: NDArray[np.complex128]
    left: NDArray[np.complex128]


class HankelModel(Protocol):
    """What the realisation algorithms have in common: a balanced model of impulse responses (R, N)."""

    def truncated(self, order: int) -> HankelModel:
        """The model of a lower order: the leading block, as it is balanced."""
        ...

    def roots(self) -> Roots:
        """Its roots."""
        ...

    def shapes(self, roots: Roots) -> NDArray[np.complex128]:
        """Shapes (n, R), or another vector of each mode that does not depend on the order."""
        ...

    def sensitivity(self, roots: Roots) -> NDArray[np.complex128]:
        """How roots follow the impulse responses (n, R, N): dz = sum over responses and samples of it times dh."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Realisation:
    """A discrete model x(k+1) = A x(k), y(k) = C x(k), x(0) = B of one impulse, balanced, order n.

    ``a`` (n, n), ``b`` (n,), ``c`` (R, n), ``singular_values`` of the Hankel
    matrix (columns,), its first n right singular vectors ``right`` (columns, n)
    and its ``rows`` for one response; ``impulse`` (R, N) is what it was made from.
    """

    a: NDArray[np.float64]
    b: NDArray[np.float64]
    c: NDArray[np.float64]
    singular_values: NDArray[np.float64]
    right: NDArray[np.float64]
    rows: int
    impulse: NDArray[np.float64]

    @property
    def columns(self) -> int:
        """Columns of the Hankel matrix."""
        return int(self.right.shape[0])

    @property
    def scale(self) -> NDArray[np.float64]:
        """Roots (n,) of the singular values that the model keeps."""
        return np.asarray(np.sqrt(self.singular_values[: self.b.size]))

    def truncated(self, order: int) -> Realisation:
        """The model of a lower order: the leading block, as it is balanced."""
        n = min(order, self.b.size)
        return replace(self, a=self.a[:n, :n], b=self.b[:n], c=self.c[:, :n], right=self.right[:, :n])

    def roots(self) -> Roots:
        """Its roots."""
        return upper_roots(self.a)

    def shapes(self, roots: Roots) -> NDArray[np.complex128]:
        """Shapes (n, R), C times the right eigenvectors."""
        return np.asarray((self.c @ roots.right).T)

    def sensitivity(self, roots: Roots) -> NDArray[np.complex128]:
        """How roots follow the impulse responses (n, R, N), to first order.

        dz = p (dH1 - z dH0) q with p = left S^-1/2 U', q = V S^-1/2 right; Hua and Sarkar, Matrix
        pencil method for estimating parameters of exponentially damped sinusoids in noise, IEEE
        Trans. Acoustics, Speech, and Signal Processing 38(5), 1990.
        """
        q = (self.right / self.scale) @ roots.right
        ahead = (self.right / self.scale**3) @ roots.left.T
        window = np.lib.stride_tricks.sliding_window_view(self.impulse, self.columns, axis=1)[:, : self.rows]
        p = np.stack([w @ ahead for w in window]).transpose(2, 0, 1)
        return differenced(convolved(p, q.T[:, None, :]), roots.values, self.impulse.shape[1])


def realise(impulse: NDArray[np.float64], rows: int, columns: int, order: int) -> Realisation:
    """Balanced realisation of impulse responses (R, N) from their (R rows) x columns Hankel matrix.

    The first sample is the first Markov parameter C B. Samples that do not
    fill the matrix are not used; too few make fewer rows. TooFewError when N < columns + 2.
    """
    rows = min(rows, impulse.shape[1] - columns)
    if rows < 2:
        what = f"a Hankel matrix of {columns} columns and two rows"
        raise TooFewError(f"impulse responses of {impulse.shape[1]} samples cannot fill {what}: measure longer")
    gram = hankel_gram(impulse, rows, columns + 1)
    power, vectors = np.linalg.eigh(gram[:columns, :columns])
    singular = np.sqrt(np.maximum(power[::-1], 0))
    n = min(order, int((singular > _SMALLEST * singular[0]).sum()))
    right = vectors[:, ::-1][:, :n]
    root = np.sqrt(singular[:n])
    # A = S^-1/2 U' H1 V S^-1/2 with U' = S^-1 V' H0', so that the Gram matrix is all it takes.
    a = (right.T @ gram[:columns, 1:] @ right) / (root**3)[:, None] / root
    return Realisation(a, root * right[0], impulse[:, :columns] @ right / root, singular, right, rows, impulse)


def upper_roots(a: NDArray[np.float64]) -> Roots:
    """Eigenvalues of ``a`` (n, n) with positive imaginary part, in order of their angle, with their eigenvectors."""
    values, right = np.linalg.eig(a)
    left = np.linalg.inv(right)
    upper = np.flatnonzero(values.imag > 0)
    upper = upper[np.argsort(np.angle(values[upper]), kind="stable")]
    return Roots(values[upper], right[:, upper], left[upper])


def hankel_gram(impulse: NDArray[np.float64], rows: int, columns: int) -> NDArray[np.float64]:
    """H' H (columns, columns) of the Hankel matrix with entries impulse[:, i + j], summed over responses (R, N)."""
    # One row leaves the sum and another enters from a column to the next; the last column hands nothing on.
    first, last = impulse[:, : columns - 1], impulse[:, rows : rows + columns - 1]
    change = last.T @ last - first.T @ first
    gram = np.empty((columns, columns))
    gram[0] = sum(h[:rows] @ np.lib.stride_tricks.sliding_window_view(h, columns)[:rows] for h in impulse)
    for i in range(1, columns):
        gram[i, i:] = gram[i - 1, i - 1 : -1] + change[i - 1, i - 1 :]
    lower = np.tril_indices(columns, -1)
    gram[lower] = gram.T[lower]
    return gram


def convolved(first: NDArray[np.complex128], second: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Convolution (n, R, A + B - 1) of arrays (n, R, A) and (n, R, B) along the last axis; leading axes broadcast."""
    size = first.shape[-1] + second.shape[-1] - 1
    return np.asarray(np.fft.ifft(np.fft.fft(first, size) * np.fft.fft(second, size)))


def differenced(spread: NDArray[np.complex128], roots: NDArray[np.complex128], size: int) -> NDArray[np.complex128]:
    """Coefficients (n, R, size) of p (dH1 - z dH0) q from those ``spread`` (n, R, L) of p dH0 q, L < size."""
    out = np.zeros((*spread.shape[:2], size), complex)
    out[:, :, 1 : spread.shape[2] + 1] = spread
    out[:, :, : spread.shape[2]] -= roots[:, None, None] * spread
    return out
