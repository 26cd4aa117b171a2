"""The eigensystem realization algorithm on data correlations, ERA/DC.

Juang, Cooper and Wright, An eigensystem realization algorithm using data
correlations (ERA/DC) for modal parameter identification, Control Theory and
Advanced Technology 4(1), 1988. Correlations R(q) = H(q)' H(0) of the shifted
Hankel matrix obey the same recursion as the impulse response, and noise that is
white from row to row averages out of them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt_identifiers.hankel import Roots, convolved, differenced, upper_roots
from vgvt_identifiers.too_few import TooFewError

_SMALLEST = 1e-10


@dataclass(frozen=True, slots=True, eq=False)
class CorrelatedRealisation:
    """A balanced model of the correlations of impulse responses (R, N): state matrix and singular vectors.

    ``u`` (block rows x columns, n) and ``v`` (block columns x columns, n) belong to the
    matrix of the correlations R(lag (i + j)); ``rows`` is the number of products that each sums over.
    """

    a: NDArray[np.float64]
    u: NDArray[np.float64]
    v: NDArray[np.float64]
    singular_values: NDArray[np.float64]
    columns: int
    rows: int
    lag: int
    impulse: NDArray[np.float64]

    def truncated(self, order: int) -> CorrelatedRealisation:
        """The model of a lower order: the leading block, as it is balanced."""
        n = min(order, self.a.shape[0])
        return replace(self, a=self.a[:n, :n], u=self.u[:, :n], v=self.v[:, :n])

    def roots(self) -> Roots:
        """Its roots."""
        return upper_roots(self.a)

    def shapes(self, roots: Roots) -> NDArray[np.complex128]:
        """The first block (n, columns) of the observability of every mode; it tells modes apart as shapes do."""
        return np.asarray((self.u[: self.columns] * self._scale() @ roots.right).T)

    def sensitivity(self, roots: Roots) -> NDArray[np.complex128]:
        """How roots follow the impulse responses (n, R, N), to first order, as for the plain Hankel matrix."""
        p = ((self.u / self._scale()) @ roots.left.T).T.reshape(roots.values.size, -1, self.columns)
        q = ((self.v / self._scale()) @ roots.right).T.reshape(roots.values.size, -1, self.columns)
        size = self.impulse.shape[1]
        total = np.zeros((roots.values.size, *self.impulse.shape), complex)
        driven = self._times(q, 0)
        for i in range(p.shape[1]):
            for j in range(q.shape[1]):
                shift = self.lag * (i + j)
                moved = differenced(convolved(p[:, None, i], driven[:, :, j]), roots.values, size - shift)
                total[:, :, shift:] += moved
                ahead = self._times(p[:, i : i + 1], shift + 1) - roots.values[:, None, None, None] * self._times(
                    p[:, i : i + 1], shift
                )
                fixed = convolved(ahead[:, :, 0], q[:, None, j])
                total[:, :, : fixed.shape[2]] += fixed
        return total

    def _times(self, vectors: NDArray[np.complex128], shift: int) -> NDArray[np.complex128]:
        """H(shift) times vectors (n, m, columns), for every response: (n, R, m, rows)."""
        window = np.lib.stride_tricks.sliding_window_view(self.impulse, self.columns, axis=1)
        flat = vectors.reshape(-1, self.columns).T
        rows = np.stack([w @ flat for w in window[:, shift : shift + self.rows]])
        return np.asarray(rows.reshape(rows.shape[0], self.rows, *vectors.shape[:2]).transpose(2, 0, 3, 1))

    def _scale(self) -> NDArray[np.float64]:
        return np.asarray(np.sqrt(self.singular_values[: self.a.shape[0]]))


def realise_correlated(
    impulse: NDArray[np.float64], rows: int, columns: int, order: int, block_rows: int = 4, block_columns: int = 2,
    lag: int = 10,
) -> CorrelatedRealisation:  # fmt: skip
    """Balanced realisation of the correlations of impulse responses (R, N), ``block_rows`` x ``block_columns`` of them.

    Each is (columns, columns) and sums over ``rows`` rows of the Hankel matrix,
    fewer if the samples do not fill it. TooFewError when not even two rows are left.
    """
    last = lag * (block_rows + block_columns - 2) + 1
    rows = min(rows, impulse.shape[1] - columns - last)
    if rows < 2:
        what = f"correlations of {columns} columns and lag {last}"
        raise TooFewError(f"impulse responses of {impulse.shape[1]} samples cannot fill {what}: measure longer")
    window = np.lib.stride_tricks.sliding_window_view(impulse, columns, axis=1)
    first = [np.ascontiguousarray(w[:rows]) for w in window]

    def correlation(shift: int) -> NDArray[np.float64]:
        return np.asarray(sum(w[shift : shift + rows].T @ f for w, f in zip(window, first, strict=True)))

    blocks = range(block_rows + block_columns - 1)
    now, ahead = [correlation(lag * m) for m in blocks], [correlation(lag * m + 1) for m in blocks]
    table = [[i + j for j in range(block_columns)] for i in range(block_rows)]
    u, singular, vt = np.linalg.svd(np.block([[now[m] for m in row] for row in table]), full_matrices=False)
    n = min(order, int((singular > _SMALLEST * singular[0]).sum()))
    root = np.sqrt(singular[:n])
    shifted = np.block([[ahead[m] for m in row] for row in table])
    a = (u[:, :n].T @ shifted @ vt[:n].T) / root[:, None] / root
    return CorrelatedRealisation(a, u[:, :n], vt[:n].T, singular, columns, rows, lag, impulse)
