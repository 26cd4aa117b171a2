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


@dataclass(frozen=True, slots=True, eq=False)
class Slopes:
    """Derivatives of :class:`Matrices` and of the runs' masses in some parameters, each with a leading axis (k,).

    ``masses_kg`` (k, C) are those of the point masses, by row.
    """

    mass: Array
    damping: Array
    stiffness: Array
    drive: Array
    axis: Array
    tilt: Array
    masses_kg: Array


def accelerance_slopes(
    matrices: Matrices,
    omega: Array,
    runs: tuple[NDArray[np.intp], ...],
    masses_kg: tuple[Array, ...],
    slopes: Slopes,
) -> ComplexArray:
    """Derivatives (k, C, L) of :func:`accelerances` by the adjoint: one more solution a row, whatever k is.

    With Z q = h + Aᵀ f the change of a reading b q is p (dh + dAᵀ f + … - dZ q) + db q, where p Z = b.
    """
    poles = poles_of(matrices, omega)
    square = (omega**2)[:, None]
    inverse = (poles.vectors[None] * poles.reciprocal[:, None, :]) @ poles.left
    count, m = slopes.mass.shape[0], matrices.drive.size
    out = np.zeros((count, matrices.axis.shape[0], omega.size), dtype=complex)
    pushed = inverse @ matrices.drive
    stacked = np.concatenate([slopes.stiffness, slopes.damping, slopes.mass])
    # Most parameters change one of the three matrices.
    active = np.abs(stacked).max(axis=(1, 2)) > 0
    flat = stacked[active].reshape(-1, m)
    for rows, mass in zip(runs, masses_kg, strict=True):
        axis, tilt = matrices.axis[rows], matrices.tilt[rows]
        towards = -square[:, :, None] * axis + tilt
        adjoint = towards @ inverse
        inertia = square * mass
        answered = inverse @ axis.T
        flexible = axis @ answered
        loading = np.linalg.inv(np.eye(rows.size) - flexible * inertia[:, None, :])
        displaced = np.einsum("lab,lb->la", loading, pushed @ axis.T + matrices.spare[rows])
        force = inertia * displaced
        q = pushed + np.einsum("lma,la->lm", answered, force)
        if mass.any():
            adjoint = adjoint + (towards @ answered) @ (inertia[:, :, None] * loading) @ (axis @ inverse)
        # dZ q of every parameter at once, real matrices times real and imaginary part.
        parts = (flat @ np.concatenate([q.real.T, q.imag.T], axis=1)).reshape(-1, m, 2 * omega.size)
        moved_by = np.zeros((3 * count, m, omega.size), dtype=complex)
        moved_by[active] = parts[..., : omega.size] + 1j * parts[..., omega.size :]
        stiff, damped, heavy = moved_by.reshape(3, count, m, omega.size)
        right = -(stiff + 1j * omega * damped - omega**2 * heavy)
        right += slopes.drive[:, :, None]
        moved = slopes.axis[:, rows] @ q.T
        if mass.any():
            right += np.einsum("krm,lr->kml", slopes.axis[:, rows], force)
            changed = inertia.T * moved + (omega**2 * slopes.masses_kg[:, rows, None]) * displaced.T
            right += np.einsum("rm,krl->kml", axis, changed)
        # (lines, k, m) times (lines, m, rows)
        read = right.transpose(2, 0, 1) @ adjoint.transpose(0, 2, 1)
        out[:, rows] = read.transpose(1, 2, 0) - omega**2 * moved + slopes.tilt[:, rows] @ q.T
    return out


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
