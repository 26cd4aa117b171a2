"""A group of runs in coordinates of its own, without slopes: its modes, and what its joints show in every run.

A step of a fit is judged without slopes, and where it is taken they are asked for at the same structures: what modes
and marches these have is known by then.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.mechanics.joints import joint_laws
from vgvt.reconcile.mechanics.response import Matrices, reduction, unfelt
from vgvt.reconcile.prediction.grouping import Group, spare_flexibility
from vgvt.reconcile.prediction.levels import Levels, levels_of
from vgvt.reconcile.prediction.riding import Riders
from vgvt.reconcile.question.problem import Problem
from vgvt.simulation.reduced import Structure

Array = NDArray[np.float64]
# Modes up to this many times the top of the band; the rest is a static flexibility.
_MODES_PER_BAND = 6.0
# As many as two campaigns of runs that all differ have.
_KEPT = 16


@dataclass(frozen=True, slots=True, eq=False)
class Plain:
    """A group's reduced coordinates, ``basis`` (n, m), its matrices and ``levels`` in them, and the rows of its runs.

    ``riders`` are the sensors that the matrices hold, where they rove but for their axes.
    """

    basis: Array
    matrices: Matrices
    runs: tuple[NDArray[np.intp], ...]
    riders: Riders
    levels: Levels | None


@lru_cache(maxsize=_KEPT)
def plain_of(problem: Problem, cells: float, group: Group) -> Plain:
    """A group reduced, its chain being ``cells`` of the way from a continuum to the one stated. To be read only."""
    s = group.structure
    run_of = np.array([problem.measured.channels[i].run for i in group.channels])
    runs = tuple(np.flatnonzero(run_of == r) for r in np.unique(run_of))
    riders = Riders.of(problem.measured.channels, group)
    full = replace(s, mass=s.mass + riders.inertia(s))
    limit = 2 * np.pi * _MODES_PER_BAND * problem.measured.frequency_hz[-1]
    # What an effect adds keeps its motion, however stiff it is held: its inertia, not its own mode, is what is felt. So
    # does a joint that it gives a law: what sticks is held by modes whose damping is felt far below them.
    laws = joint_laws(group.plan, s)
    added = np.array([k in laws or joint not in problem.nominal.joints for k, joint in enumerate(s.joints)])
    basis = reduction(full.mass, full.stiffness, s.drive, limit, added)
    matrices = _project(full, basis, group.rows)
    missing = spare_flexibility(problem, cells, s, group.rows)
    matrices = replace(matrices, spare=matrices.spare + missing)
    levels = levels_of(problem.measured, group, basis, matrices, roving=riders.roving)
    return Plain(basis, matrices, runs, riders, levels)


def loaded(problem: Problem, group: Group, basis: Array, spare: bool = True) -> Matrices:
    """A group in given reduced coordinates (n, m), with what its sensors weigh; its ``spare`` flexibility if asked."""
    s, riders = group.structure, Riders.of(problem.measured.channels, group)
    return _project(replace(s, mass=s.mass + riders.inertia(s)), basis, group.rows, spare)


def _project(s: Structure, basis: Array, rows: NDArray[np.intp], spare: bool = True) -> Matrices:
    stiffness = basis.T @ s.stiffness @ basis
    drive, axis = basis.T @ s.drive, s.axis[rows] @ basis
    missed, whole = np.zeros(rows.size), unfelt(s.stiffness, s.drive)
    if spare:
        # At rest a gauge may feel as much as it is pushed with: then what is missed there is missed nowhere else.
        inside = axis @ np.linalg.solve(basis.T @ whole @ basis, drive)
        missed = s.axis[rows] @ np.linalg.solve(whole, s.drive) - inside
    return Matrices(
        basis.T @ s.mass @ basis, basis.T @ s.damping @ basis, stiffness, drive, axis, s.tilt[rows] @ basis, missed
    )
