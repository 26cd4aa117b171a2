"""Shapes over the points that were hit, where a few sensors stay and the hammer roves.

A structure answers at r to a force at d as it does at d to one at r (Maxwell's reciprocity), so
R_dr = psi_d psi_r / (2 i w_d m) holds the shape at the points driven as well as at the sensors;
Ewins, Modal Testing, 2nd ed., 2000, section 2.7. With more points driven than DOFs measured
they are the better part of the shape. A point that is driven and measured ties the two parts together.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Dof, ModalModel
from vgvt_identifiers.modal_scaling import modal_mass
from vgvt_identifiers.named_dofs import places

BY_RECIPROCITY = "more points were driven than measured: the shape over them follows by reciprocity"
SENSORS_LEFT_OUT = (
    "no sensor sits at a point that was driven, so the shape is given over the points driven alone and without modal "
    "mass: drive the point of a sensor too"
)


def driven_outnumber(references: tuple[Dof, ...], responses: tuple[Dof, ...]) -> bool:
    """True where more DOFs were driven than measured, whatever the sign of their labels."""
    return len({r.unsigned for r in references}) > len({d.unsigned for d in responses})


def with_driven_points(model: ModalModel) -> ModalModel:
    """The claim with shapes over the references too where these outnumber its DOFs, else the claim itself.

    Shapes have their largest entry at 1 again, with modal masses and residues (M, D, R) for that scale and those DOFs.
    Without a drive point the two parts of a shape have no common scale: the references become the DOFs, and the
    sensors the references, which they are by reciprocity.
    """
    if model.residues is None or not len(model) or not driven_outnumber(model.references, model.dofs):
        return model
    drives = _drive_points(model.dofs, model.references)
    share = _participations(model)
    if not drives:
        return replace(
            model,
            shapes=_largest_one(share)[0],
            dofs=model.references,
            references=model.dofs,
            residues=model.residues.transpose(0, 2, 1),
            modal_mass_kg=None,
            advice=(*model.advice, BY_RECIPROCITY, SENSORS_LEFT_OUT),
        )
    known = places(model.dofs)
    added = [k for k, r in enumerate(model.references) if r.unsigned not in known]
    rows, columns, signs = (np.array(x) for x in zip(*drives, strict=True))
    # Least squares over the drive points: there shape and participation are the same up to one factor a mode.
    moved, felt = model.shapes[:, rows] * signs, share[:, columns]
    above, below = (felt.conj() * moved).sum(axis=1), (np.abs(felt) ** 2).sum(axis=1)
    factor = np.divide(above, below, out=np.zeros_like(above), where=below > 0)
    shapes, largest = _largest_one(np.hstack([model.shapes, factor[:, None] * share[:, added]]))
    dofs = (*model.dofs, *(model.references[k] for k in added))
    share = share * largest[:, None]
    extra = shapes[:, len(model.dofs) :, None] * share[:, None]
    damped = model.poles.imag
    mass = [modal_mass(*parts, dofs, model.references) for parts in zip(shapes, share, damped, strict=True)]
    return replace(
        model,
        shapes=shapes,
        dofs=dofs,
        residues=np.concatenate([model.residues, extra], axis=1),
        modal_mass_kg=np.array(mass) if np.isfinite(mass).any() else None,
        advice=(*model.advice, BY_RECIPROCITY),
    )


def _drive_points(dofs: tuple[Dof, ...], references: tuple[Dof, ...]) -> list[tuple[int, int, int]]:
    """Place among the DOFs, place among the references, and relative sign of what was driven and measured."""
    place = places(dofs)
    return [
        (place[r.unsigned][0], k, place[r.unsigned][1] * r.direction.sign)
        for k, r in enumerate(references)
        if r.unsigned in place
    ]


def _participations(model: ModalModel) -> NDArray[np.complex128]:
    """What every reference moves of every mode (M, R): residues are shape times participation."""
    assert model.residues is not None  # the caller has looked
    above = np.einsum("md,mdr->mr", model.shapes.conj(), model.residues)
    below = (np.abs(model.shapes) ** 2).sum(axis=1, keepdims=True)
    return np.asarray(above / np.where(below > 0, below, 1))


def _largest_one(shapes: NDArray[np.complex128]) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Shapes (M, D) over their largest entries, and these (M,)."""
    largest = shapes[np.arange(len(shapes)), np.argmax(np.abs(shapes), axis=1)]
    largest = np.where(largest == 0, 1, largest)
    return shapes / largest[:, None], largest
