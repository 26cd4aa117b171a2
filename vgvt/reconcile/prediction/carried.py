"""Structures for one fit: assembled, or carried along from one that was, where steps forgive more than that errs by.

Matrices are nearly straight in factors and shifts: a standard deviation and a half away from where the bare aircraft
was assembled, its accelerances are off by some tenths of a per cent, of a coarse step's allowance of five and more.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.prediction.adjacent import adjacent
from vgvt.reconcile.prediction.following import leaders
from vgvt.reconcile.prediction.grouping import Group, assembled, cells_at, effects_at, sensor_mass
from vgvt.reconcile.prediction.level_following import Following
from vgvt.reconcile.prediction.local_slopes import slopes_for
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import MATRICES, Problem

Array = NDArray[np.float64]
Groups = tuple[Group, ...]
# Scores' distance to which a bare aircraft is carried, and to which an effect's slopes may be those beside another one.
_CARRIED, _BESIDE = 1.5, 0.5


@dataclass(slots=True, eq=False)
class Structures:
    """What a fit asks for at its scores, keeping what it assembled last.

    ``coarse`` while steps forgive misplaced peaks: structures are then carried along. ``whole`` where slopes are those
    of the aircraft with all that acts on it, as it is there: dear, and for what is told. ``follows`` where what joints
    show follows the unknowns, with what is known of that: as dear, and for the last steps of a fit.
    """

    problem: Problem
    coarse: bool = False
    whole: bool = False
    follows: Following | None = None
    _bare: tuple[Array, Groups] | None = None
    _others: dict[tuple[Hypothesis, ...], tuple[Array, Groups]] = field(default_factory=dict)

    def at(self, u: Array, hypotheses: tuple[Hypothesis, ...], e: Array) -> Groups | None:
        """Groups at scores u and e; None where there is no such aircraft."""
        found = self._carried(u, hypotheses, e) if self.coarse else None
        return assembled(self.problem, u, hypotheses, e) if found is None else found

    def beside(self, u: Array, hypotheses: tuple[Hypothesis, ...], e: Array) -> Groups | None:
        """Groups at scores near u and e, next to which one more effect's slopes are taken: no small share of a step."""
        if self.coarse:
            return self.at(u, hypotheses, e)
        scores = np.concatenate([u, e])
        known = self._others.get(hypotheses)
        if known is not None and np.abs(scores - known[0]).max(initial=0.0) <= _BESIDE:
            return known[1]
        found = assembled(self.problem, u, hypotheses, e)
        if found is not None:
            self._others[hypotheses] = (scores, found)
        return found

    def _carried(self, u: Array, hypotheses: tuple[Hypothesis, ...], e: Array) -> Groups | None:
        """The bare aircraft carried to u, the effects added one by one; None where only assembling will do."""
        made = effects_at(self.problem, hypotheses, e)
        # What follows from the unknowns would stay behind.
        if made is None or any(leaders(self.problem, h) for h in hypotheses):
            return None
        count = len(self.problem.unknowns)
        if self._bare is None or np.abs(u - self._bare[0])[:count].max(initial=0.0) > _CARRIED:
            found = assembled(self.problem, u, (), np.zeros(0))
            if found is None:
                return None
            self._bare = (u.copy(), found)
        own = len(made) - len(hypotheses)
        groups = carried(self.problem, self._bare[1], self._bare[0], u)
        for k in range(own, len(made)):
            wider = adjacent(self.problem, groups, cells_at(self.problem, u), made[:k], made[k])
            if wider is None:
                return None
            groups = wider
        return groups


def carried(problem: Problem, groups: Groups, start: Array, u: Array) -> Groups:
    """Groups without hypotheses, assembled at scores ``start``, moved to u by the slopes of the stated values."""
    scores = zip(problem.unknowns, start, u, strict=False)
    moved = np.array([k.change(float(there)) - k.change(float(here)) for k, here, there in scores])
    heavier = sensor_mass(problem, u) - sensor_mass(problem, start)
    return tuple(_moved(problem, group, moved, heavier) for group in groups)


def _moved(problem: Problem, group: Group, moved: Array, heavier: float) -> Group:
    s, slopes = group.structure, slopes_for(problem, (), None, group)
    index, rows = np.array([s.joints.index(j) for j in slopes.joints]), slopes.rows(s.places)
    matrices = {}
    for name in MATRICES:
        change, matrix = np.tensordot(moved, slopes.values[name], axes=1), getattr(s, name).copy()
        if name in ("axis", "tilt"):
            matrix[:, index] += change[rows]
        elif name == "drive":
            matrix[index] += change
        else:
            matrix[np.ix_(index, index)] += change
        matrices[name] = matrix
    return replace(group, structure=replace(s, **matrices), masses_kg=group.masses_kg + heavier)
