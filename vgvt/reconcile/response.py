"""Frequency responses of a reduced structure by complex modal superposition, roving masses by Woodbury's identity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, eq=False)
class Matrices:
    """Z = K + iωC - ω²M over m coordinates with the push ``drive`` (m,) and rows ``axis``, ``tilt`` (C, m).

    Accelerations are (-ω² axis + tilt) q. ``spare`` (C,) is the static flexibility, m/N, that the coordinates
    miss between drive and rows.
    """

    mass: Array
    damping: Array
    stiffness: Array
    drive: Array
    axis: Array
    tilt: Array
    spare: Array


@dataclass(frozen=True, slots=True, eq=False)
class Poles:
    """Poles and vectors of a reduced structure: q(ω) of an input h is vectors ((left h) / (iω - poles))."""

    poles: ComplexArray
    vectors: ComplexArray
    left: ComplexArray
    reciprocal: ComplexArray

    def modal(self, inputs: Array) -> ComplexArray:
        """Modal coordinates (inputs, L, 2m) answering to inputs (inputs, m)."""
        return np.asarray((inputs @ self.left.T)[:, None, :] * self.reciprocal)


def poles_of(matrices: Matrices, omega: Array) -> Poles:
    """Diagonalise a reduced structure for the lines ``omega`` (L,), rad/s."""
    m = matrices.drive.size
    inverse = np.linalg.inv(matrices.mass)
    system = np.zeros((2 * m, 2 * m))
    system[:m, m:] = np.eye(m)
    system[m:, :m] = -inverse @ matrices.stiffness
    system[m:, m:] = -inverse @ matrices.damping
    poles, vectors = np.linalg.eig(system)
    left = np.linalg.inv(vectors)[:, m:] @ inverse
    return Poles(poles, vectors[:m], left, 1.0 / (1j * omega[:, None] - poles))


def accelerances(
    matrices: Matrices,
    omega: Array,
    runs: tuple[NDArray[np.intp], ...],
    masses_kg: tuple[Array, ...],
) -> ComplexArray:
    """Accelerance (C, L) of every row, those of one run loaded by the run's point masses.

    ``runs`` give the rows of each run, ``masses_kg`` (rows of the run,) the masses that move with them
    beyond what is in the mass matrix (zeros: none).
    """
    poles = poles_of(matrices, omega)
    square = omega**2
    to_axis = matrices.axis @ poles.vectors
    to_tilt = matrices.tilt @ poles.vectors
    pushed = poles.modal(matrices.drive[None])[0]
    moved = to_axis @ pushed.T + matrices.spare[:, None]
    out = -square * moved + to_tilt @ pushed.T
    for rows, mass in zip(runs, masses_kg, strict=True):
        if not mass.any():
            continue
        answered = poles.modal(matrices.axis[rows])
        # Displacement and reading at row a for a unit force at row b, (L, a, b).
        flexible = (answered @ to_axis[rows].T).transpose(1, 2, 0)
        reading = (answered @ to_tilt[rows].T).transpose(1, 2, 0) - square[:, None, None] * flexible
        inertia = square[:, None] * mass
        system = np.eye(rows.size) - flexible * inertia[:, None, :]
        loaded = np.linalg.solve(system, moved[rows].T[:, :, None])[:, :, 0]
        out[rows] += np.einsum("lab,lb->al", reading, inertia * loaded)
    return np.asarray(out)


def reduction(mass: Array, stiffness: Array, limit_rad_per_s: float, always: Array) -> Array:
    """Basis (n, m): undamped modes up to a limit, and the ``always`` coordinates' (n,) bool static shapes are in them.

    Modes are those of the symmetric parts; at least twelve are kept.
    """
    squares, shapes = scipy.linalg.eigh((stiffness + stiffness.T) / 2, (mass + mass.T) / 2)
    count = max(12, int(np.searchsorted(squares, limit_rad_per_s**2)))
    basis = shapes[:, :count]
    if always.any() and count < mass.shape[0]:
        basis = np.hstack([basis, np.eye(mass.shape[0])[:, always]])
        basis, _ = np.linalg.qr(basis)
    return np.asarray(basis)
