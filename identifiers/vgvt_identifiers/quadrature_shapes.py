"""Shapes from imaginary parts at resonance: over repeats averaged, over drive points by the best of them.

The imaginary part of the accelerance at d for a force at r goes with psi_d psi_r, so amplitudes of different
drive points do not compare, and where more points were driven than measured it is the sensors that do not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Dof
from vgvt_identifiers.named_dofs import named_once, places
from vgvt_identifiers.reciprocity import BY_RECIPROCITY, driven_outnumber
from vgvt_identifiers.spectra import RunSpectra


@dataclass(frozen=True, slots=True, eq=False)
class QuadratureShapes:
    """Shapes (M, D), largest component 1, their DOFs, which modes lack DOFs (M,), which are zero, and remarks."""

    shapes: NDArray[np.float64]
    dofs: tuple[Dof, ...]
    incomplete: NDArray[np.bool_]
    remarks: tuple[str, ...]


def quadrature_shapes(runs: tuple[RunSpectra, ...], rows: NDArray[np.float64]) -> QuadratureShapes:
    """The shapes that the rows (M, all responses of all runs) make, a DOF named as first seen whatever its sign.

    A mode takes the drive point that excites it best. Where more points were driven than measured, the shapes are over
    the points driven, by reciprocity, and a mode takes the sensor that shows it best.
    """
    where = [(d, r.reference) for r in runs for d in r.responses]
    dofs, references = named_once(d for d, _ in where), named_once(r for _, r in where)
    measured, driven = places(dofs), places(references)
    table = np.zeros((len(references), rows.shape[0], len(dofs)))
    count = np.zeros((len(references), 1, len(dofs)))
    for column, (dof, reference) in enumerate(where):
        (i, sign), (k, turned) = measured[dof.unsigned], driven[reference.unsigned]
        sign *= turned * dof.direction.sign * reference.direction.sign
        table[k, :, i] += sign * rows[:, column]
        count[k, :, i] += 1
    table = table / np.maximum(count, 1)
    swapped = driven_outnumber(references, dofs)
    if swapped:
        table, count, dofs = table.transpose(2, 1, 0), count.transpose(2, 1, 0), references
    best = np.argmax((table**2).sum(axis=2), axis=0)
    shapes = table[best, np.arange(rows.shape[0])]
    largest = shapes[np.arange(rows.shape[0]), np.argmax(np.abs(shapes), axis=1)]
    scaled = shapes / np.where(largest == 0, 1, largest)[:, None]
    incomplete = np.asarray((count[best, 0] == 0).any(axis=1))
    return QuadratureShapes(np.asarray(scaled), dofs, incomplete, (BY_RECIPROCITY,) if swapped else ())
