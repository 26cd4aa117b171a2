"""How the static flexibility of the modes that are left out changes: with the place of the push, with stiffness, cells.

Between drive d and rows a the coordinates Φ that are kept miss a G d, G = K⁻¹ - Φ (Φᵀ K Φ)⁻¹ Φᵀ. It changes by

    δa G d + a G δd - a G δK G d.

What couples kept modes with those left out is at rest no small thing, K⁻¹ holding how a soft suspension gives way, and
turns its sign at every kept resonance: no static flexibility stands for that, and so it has no part in this.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.mechanics.response import unfelt
from vgvt.reconcile.prediction.grouping import Group, spare_by_cells
from vgvt.reconcile.prediction.local_slopes import LocalSlopes
from vgvt.reconcile.prediction.sides import Side
from vgvt.reconcile.question.problem import CELLS, Problem
from vgvt.simulation.reduced import Structure

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class LeftOut:
    """What a structure's answer at rest lacks: ``pushed`` (n,), m/N, by its drive, and ``seen`` (C, n) by rows.

    ``drive`` (n,) where a gauge reads more than the force there, else None.
    """

    pushed: Array
    seen: Array
    drive: Array | None

    @classmethod
    def of(cls, s: Structure, rows: NDArray[np.intp], basis: Array) -> LeftOut:
        """Of a structure without what basis (n, m) keeps of it, between its drive and ``rows`` (C,) of its places."""
        whole, axis = unfelt(s.stiffness, s.drive), s.axis[rows]
        inside = basis.T @ whole @ basis
        pushed = np.linalg.solve(whole, s.drive) - basis @ np.linalg.solve(inside, basis.T @ s.drive)
        kept = np.linalg.solve(inside.T, basis.T @ axis.T)
        seen = np.linalg.solve(whole.T, axis.T).T - (basis @ kept).T
        felt = (s.stiffness - s.stiffness.T) @ s.drive
        return cls(
            np.asarray(pushed, dtype=np.float64), np.asarray(seen, dtype=np.float64), s.drive if felt.any() else None
        )

    def changes(self, stiffness: Array, drive: Array, axis: Array, at: NDArray[np.intp] | slice = slice(None)) -> Array:
        """Changes (k, C), m/N, by those of stiffness (k, j, j), drive (k, j), rows (k, C, j) over coordinates."""
        pushed, seen = self.pushed[at], self.seen[:, at]
        pull = stiffness @ pushed
        if self.drive is not None:
            # The aircraft is as stiff as without what the gauge reads of it.
            own = self.drive[at]
            felt = stiffness @ own - own @ stiffness
            pull = pull + np.outer(felt @ pushed / (self.drive @ self.drive), own)
        return np.asarray(axis @ pushed + (drive - pull) @ seen.T)


def spare_slopes(
    problem: Problem, group: Group, index: int, basis: Array, local: LocalSlopes, grid_rows: list[int],
    sides: Sequence[Side], pulled: list[tuple[int, Side]],
) -> Array:  # fmt: skip
    """Changes (parameters, C), m/N, of what the modes left out give at rest, per amount of an unknown, score of e."""
    s, values = group.structure, local.values
    left = LeftOut.of(s, group.rows, basis)
    at = np.array([s.joints.index(j) for j in local.joints])
    found = np.zeros((len(problem.unknowns) + len(sides), group.rows.size))
    found[: len(problem.unknowns)] = left.changes(
        values["stiffness"], values["drive"], values["axis"][:, grid_rows], at
    )
    found[problem.unknowns.index(CELLS)] += spare_by_cells(problem, s, group.rows)
    for k, side in (*pulled, *((len(problem.unknowns) + j, side) for j, side in enumerate(sides))):
        here, there = side.here[index], side.there[index]
        if here is not there:
            a, b = here.structure, there.structure
            moved = b.stiffness - a.stiffness, b.drive - a.drive, b.axis[there.rows] - a.axis[here.rows]
            found[k] += left.changes(moved[0][None], moved[1][None], moved[2][None])[0] / side.step
    return found
