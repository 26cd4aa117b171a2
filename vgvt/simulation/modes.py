"""Modes of a linearised model, with general viscous damping.

The quadratic eigenproblem in state-space form; residues follow from
a_r = ψᵀ(2 λ M + C)ψ, R = ψ ψᵀ / a_r for symmetric M, C and K
(Ewins, Modal Testing, 2nd ed., chapter 2).
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from vgvt.data import Dof, ModalModel
from vgvt.simulation.linear import LinearModel

# Slower than any suspension: what lies below is a free rigid-body motion.
_SLOWEST_HZ = 0.002
# How far beside a pole its matrix is taken, which is singular at it, and how often inverted: a pole that is further off
# by a hundred thousand times that is left behind by 1e-15.
_BESIDE, _STEPS = 1e-11, 3


def eigenpairs(model: LinearModel) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Oscillating poles λ (R,) with positive imaginary part, by frequency, and vectors ψ (nv, R).

    ψ is scaled so that ψᵀ(2 λ M + C)ψ = 1: residues are then plain products.
    """
    n = model.freedoms
    lower = -np.linalg.solve(model.mass, np.hstack([model.stiffness, model.damping]))
    system = np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), lower])
    poles, vectors = scipy.linalg.eig(system)
    keep = np.flatnonzero(poles.imag > 2 * np.pi * _SLOWEST_HZ)
    keep = keep[np.argsort(np.abs(poles[keep]))]
    poles, shapes = poles[keep], vectors[:n, keep]
    scale = np.sum(shapes * (2 * (model.mass @ shapes) * poles + model.damping @ shapes), axis=0)
    return poles, shapes / np.sqrt(scale)


def driven_vectors(
    model: LinearModel, poles: NDArray[np.complex128], vectors: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """Vectors φ (nv, R) of the transposed problem, φᵀ(2 λ M + C)ψ = 1: a residue is ψ φᵀ; φ = ψ for symmetric matrices.

    What the transposed λ² M + λ C + K makes nothing of, at each pole: by inverse iteration from ψ, a little beside it.
    """
    driven = np.empty_like(vectors)
    for r, (pole, vector) in enumerate(zip(poles, vectors.T, strict=True)):
        beside = pole * (1 + _BESIDE)
        dynamic = beside**2 * model.mass + beside * model.damping + model.stiffness
        factors, left = scipy.linalg.lu_factor(dynamic.T), vector
        for _ in range(_STEPS):
            left = scipy.linalg.lu_solve(factors, left)
            left = left / np.abs(left).max()
        driven[:, r] = left / (left @ (2 * pole * model.mass + model.damping) @ vector)
    return driven


def modal_model(
    model: LinearModel,
    dofs: tuple[Dof, ...],
    reference: int | tuple[int, ...],
    limit_hz: float,
    labels: tuple[str, ...] = (),
    tilt: NDArray[np.float64] | None = None,
    pairs: tuple[NDArray[np.complex128], NDArray[np.complex128]] | None = None,
    felt_from_hz: float = 0.0,
) -> ModalModel:
    """The modes up to ``limit_hz`` seen at ``dofs``, the rows of the model's displacement map.

    ``reference`` is the index of the drive point among them, or those of several. Shapes are real-normalised:
    the largest displacement is +1, and ``modal_mass_kg`` belongs to that scale. With ``tilt`` (D, nv),
    what a unit of each coordinate lets the sensors feel of gravity, m/s², shapes and the responses of
    residues are those that accelerometers feel, displacement + tilt/λ², in that same scale; the forces of residues,
    the scale and the modal mass stay those of the displacement. With all modes A/F is then
    Σ s² R/(s − λ) + conj plus what gravity makes of the static deflection, tilt K⁻¹ (1 − s C K⁻¹) force.
    Where a mode is seen by its tail, far above it, tilt/s² is next to nothing and tilt/λ² is not: modes below
    ``felt_from_hz`` keep the residues of the displacement, and that static rest is one of the others only.
    ``pairs`` are the model's :func:`eigenpairs` where they are known already.
    """
    poles, vectors = eigenpairs(model) if pairs is None else pairs
    below = np.abs(poles) <= 2 * np.pi * limit_hz
    poles, vectors = poles[below], vectors[:, below]
    moved = (model.displacement @ vectors).T
    symmetric = np.allclose(model.stiffness, model.stiffness.T, rtol=0, atol=1e-9 * np.abs(model.stiffness).max())
    pushed = moved if symmetric else (model.displacement @ driven_vectors(model, poles, vectors)).T
    seen = moved if tilt is None else moved + (tilt @ vectors).T / poles[:, None] ** 2
    reference = (reference,) if isinstance(reference, int) else reference
    tails = np.abs(poles) < 2 * np.pi * felt_from_hz
    residues = np.where(tails[:, None], moved, seen)[:, :, None] * pushed[:, None, list(reference)]
    # By the displacement: of a swing, in which gravity and acceleration cancel, accelerometers feel next to nothing.
    largest = moved[np.arange(poles.size), np.argmax(np.abs(moved), axis=1)]
    # A motion that no DOF can see keeps the scale of its own coordinates.
    largest = np.where(np.abs(largest) > 0, largest, 1.0)
    return ModalModel(
        natural_frequency_hz=np.abs(poles) / (2 * np.pi),
        damping_ratio=-poles.real / np.abs(poles),
        shapes=seen / largest[:, None],
        dofs=dofs,
        modal_mass_kg=np.real(1 / (largest**2 * 2j * poles.imag)),
        references=tuple(dofs[i] for i in reference),
        residues=residues,
        labels=labels[: poles.size],
        method="truth",
    )
