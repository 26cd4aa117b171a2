"""Derivatives of responses that depend on level, by the adjoint: one more solution a row, whatever is varied."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.mechanics.joints import Joints, missed
from vgvt.reconcile.mechanics.response import Matrices, Slopes, poles_of

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


def level_accelerance_slopes(
    matrices: Matrices,
    joints: Joints,
    stiffness: ComplexArray,
    stiffness_slopes: ComplexArray,
    omega: Array,
    runs: tuple[NDArray[np.intp], ...],
    masses_kg: tuple[Array, ...],
    slopes: Slopes,
) -> ComplexArray:
    """Derivatives (k, C, L) of :func:`vgvt.reconcile.prediction.levels.level_accelerances` in k parameters.

    ``stiffness`` (R, J, L) is what the joints show and ``stiffness_slopes`` (k, R, J, L) its derivatives. Where masses
    and joints act on the structure with f = D u, u = a q + S f, the change of a reading b q is
    p (dh + daᵀ f - dZ q) + E (dD u + D da q) + db q, with p the adjoint of the loaded structure. What the coordinates
    miss between drive and joints is held.
    """
    poles = poles_of(matrices, omega)
    square = (omega**2)[:, None]
    inverse = (poles.vectors[None] * poles.reciprocal[:, None, :]) @ poles.left
    count, m = slopes.mass.shape[0], matrices.drive.size
    number = joints.rows.shape[0]
    out = np.zeros((count, matrices.axis.shape[0], omega.size), dtype=complex)
    pushed = inverse @ matrices.drive
    joined = np.concatenate([slopes.stiffness, slopes.damping, slopes.mass], axis=2)
    changes = np.ascontiguousarray(joined.reshape(count * m, 3 * m).T)
    for run, (rows, mass) in enumerate(zip(runs, masses_kg, strict=True)):
        carried = rows if mass.any() or slopes.masses_kg[:, rows].any() else rows[:0]
        loads, own = carried.size, slice(0, carried.size)
        acting = np.vstack([matrices.axis[carried], joints.rows])
        to_rows, corner = missed(joints, rows, carried)
        acts = np.concatenate([square * mass[:loads], -stiffness[run].T], axis=1)
        towards = -square[:, :, None] * matrices.axis[rows] + matrices.tilt[rows]
        answered = inverse @ acting.T
        between = acting @ answered + corner
        loading = np.linalg.inv(np.eye(loads + number) - between * acts[:, None, :])
        plain = pushed @ acting.T + np.concatenate([matrices.spare[carried], joints.to_drive])
        displaced = np.einsum("lab,lb->la", loading, plain)
        force = acts * displaced
        q = pushed + np.einsum("lma,la->lm", answered, force)
        adjoint = towards @ inverse
        reading = towards @ answered - square[:, :, None] * to_rows
        felt = acts[:, :, None] * loading
        eased = reading + reading @ felt @ between
        adjoint = adjoint + reading @ felt @ (acting @ inverse)
        right = _by_real(np.concatenate([-q, -1j * omega[:, None] * q, square * q], axis=1), changes)
        right = right.reshape(omega.size, count, m) + slopes.drive
        axis_slopes, tilt_slopes = slopes.axis[:, rows], slopes.tilt[:, rows]
        moved = np.einsum("lm,kam->lka", q, axis_slopes, optimize=True)
        changed = np.empty((omega.size, count, loads + number), dtype=complex)
        changed[:, :, loads:] = -(stiffness_slopes[:, run].transpose(2, 0, 1) * displaced[:, None, loads:])
        if loads:
            right += np.einsum("la,kam->lkm", force[:, own], axis_slopes, optimize=True)
            changed[:, :, own] = acts[:, None, own] * moved
            changed[:, :, own] += square[:, :, None] * slopes.masses_kg[:, rows] * displaced[:, None, own]
        read = right @ adjoint.transpose(0, 2, 1) + changed @ eased.transpose(0, 2, 1)
        read += np.einsum("lm,kam->lka", q, tilt_slopes, optimize=True) - square[:, :, None] * moved
        if slopes.spare is not None:
            read -= square[:, :, None] * slopes.spare[:, rows]
            read += slopes.spare[:, carried] @ (reading @ felt)[:, :, own].transpose(0, 2, 1)
        out[:, rows] = read.transpose(1, 2, 0)
    return out


def _by_real(values: ComplexArray, matrix: Array) -> ComplexArray:
    """Complex values (n, m) times a real matrix (m, k), in half the time that the matrix as a complex one takes."""
    out = np.empty((values.shape[0], matrix.shape[1]), dtype=complex)
    out.real, out.imag = values.real @ matrix, values.imag @ matrix
    return out
