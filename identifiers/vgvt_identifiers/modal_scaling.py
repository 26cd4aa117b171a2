"""Shapes, modal masses and complete residues from the residues that were measured.

R_dr = psi_d psi_r / (2 i w_d m): a mode is one shape times one participation
per reference, so the drive point gives the modal mass and several references
complete each other; Ewins, Modal Testing, 2nd ed., 2000, section 2.7.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Dof
from vgvt_identifiers.named_dofs import places

_ROUNDS = 50


def scaled_shapes(
    residues: NDArray[np.complex128],
    measured: NDArray[np.float64],
    damped_rad_s: NDArray[np.float64],
    dofs: tuple[Dof, ...],
    references: tuple[Dof, ...],
) -> tuple[NDArray[np.complex128], NDArray[np.float64], NDArray[np.complex128], NDArray[np.bool_]]:
    """Shapes (M, D) with the largest entry 1, modal masses (M,) kg, residues (M, D, R), and which lack DOFs (M,).

    ``residues`` (M, D, R) in m/(N s) count where ``measured`` (M, D, R) is above zero; ``damped_rad_s`` is (M,).
    Modal masses are NaN without a drive-point response. Residues that were not measured follow from
    the others where references share DOFs; the rest, and the shape there, is zero and marked unknown.
    """
    modes, points, _ = residues.shape
    shapes = np.zeros((modes, points), complex)
    masses = np.full(modes, np.nan)
    complete = residues.copy()
    partial = np.zeros(modes, bool)
    for mode in range(modes):
        shape, share = _rank_one(residues[mode], measured[mode] > 0)
        known = (measured[mode] > 0) | ((shape != 0)[:, None] & (share != 0))
        complete[mode] = np.where(measured[mode] > 0, residues[mode], np.outer(shape, share))
        partial[mode] = not known.all()
        largest = shape[np.argmax(np.abs(shape))]
        shapes[mode] = shape / (largest if largest != 0 else 1)
        masses[mode] = modal_mass(shapes[mode], share * largest, damped_rad_s[mode], dofs, references)
    return shapes, masses, complete, partial


def _rank_one(
    residues: NDArray[np.complex128], measured: NDArray[np.bool_]
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Shape (D,) and participations (R,) whose product fits the measured residues (D, R), by alternating least squares.

    It starts from the reference that moves the mode most; references that share no DOF with it stay out.
    """
    table = np.where(measured, residues, 0)
    best = int(np.argmax((np.abs(table) ** 2).sum(axis=0)))
    shape, share = table[:, best].copy(), np.zeros(residues.shape[1], complex)
    share[best] = 1.0
    if residues.shape[1] == 1:
        return shape, share
    for _ in range(_ROUNDS):
        above = (shape.conj()[:, None] * table).sum(axis=0)
        share = _divided(above, ((np.abs(shape) ** 2)[:, None] * measured).sum(axis=0))
        above = (share.conj() * table).sum(axis=1)
        shape = _divided(above, (np.abs(share) ** 2 * measured).sum(axis=1))
        largest = share[np.argmax(np.abs(share))]
        if largest == 0:
            break
        shape, share = shape * largest, share / largest
    return shape, share


def _divided(above: NDArray[np.complex128], below: NDArray[np.float64]) -> NDArray[np.complex128]:
    return np.asarray(np.divide(above, below, out=np.zeros_like(above), where=below > 0))


def modal_mass(
    shape: NDArray[np.complex128],
    participation: NDArray[np.complex128],
    damped_rad_s: float,
    dofs: tuple[Dof, ...],
    references: tuple[Dof, ...],
) -> float:
    """Modal mass in kg of a shape (D,) with participations (R,) at its scale, R_dr = shape_d participation_r.

    It comes from the drive point that moves most; NaN without one.
    """
    place = places(dofs)
    drives = [
        (shape[place[r.unsigned][0]] * place[r.unsigned][1] * r.direction.sign, participation[k])
        for k, r in enumerate(references)
        if r.unsigned in place
    ]
    if not drives:
        return float("nan")
    moved, residue = max(drives, key=lambda d: abs(d[0]))
    if moved == 0 or residue == 0:
        return float("nan")
    # participation = psi_r / (2 i w_d m) for the shape at this scale
    return float((moved / (2j * damped_rad_s * residue)).real)
