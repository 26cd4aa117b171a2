"""Responses that depend on level: what nonlinear joints turn the accelerances of a structure into, run by run.

Runs share the linear structure. What the level changes is the complex stiffness κ(ω) = reaction / motion that each
joint shows over the whole record of a run, found from the run's own measured force.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.mechanics.joints import Joints, joints_of, missed
from vgvt.reconcile.mechanics.response import Matrices, Poles, loaded_by, poles_of
from vgvt.reconcile.mechanics.run_march import Push, flexibility, marched_run
from vgvt.reconcile.prediction.grouping import Group
from vgvt.reconcile.question.data import Measured

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, eq=False)
class Levels:
    """Nonlinear joints of a group of runs, and the stiffness ``shown`` (R, J, L) that they show at each run's level.

    ``left_out`` (C, L) is what the ends of records add to accelerances because of what the joints have set ringing.
    ``slopes`` (effects, R, J, L) and ``left_out_slopes`` (effects, C, L) are changes with the scores of the effects,
    ``follows`` the same pair with the amounts of the unknowns; None where both are held as these change.
    """

    joints: Joints
    shown: ComplexArray
    left_out: ComplexArray
    slopes: ComplexArray
    left_out_slopes: ComplexArray
    follows: tuple[ComplexArray, ComplexArray] | None = None

    def moved(self, scores: Array) -> tuple[ComplexArray, ComplexArray]:
        """The stiffness shown (R, J, L) and what is left out (C, L), the effects' scores moved by (effects,)."""
        if not scores.any():
            return self.shown, self.left_out
        shown = self.shown + np.tensordot(scores, self.slopes, axes=1)
        return shown, np.asarray(self.left_out + np.tensordot(scores, self.left_out_slopes, axes=1))

    def with_unknowns(self, rate: Array) -> tuple[ComplexArray, ComplexArray]:
        """What is shown (k, R, J, L) and left out (k, C, L) a score of k unknowns with rates (k,); zeros where held."""
        if self.follows is None:
            shown, rung = (np.zeros((rate.size, *of.shape), dtype=complex) for of in (self.shown, self.left_out))
        else:
            shown, rung = self.follows
        by: ComplexArray = rate.astype(complex)
        return by[:, None, None, None] * shown, by[:, None, None] * rung

    def sloped(self, sides: list[tuple[Levels, Levels, float] | None]) -> Levels:
        """The same with its slopes, from what it is on either side (and how far apart) in every effect's score."""

        def slopes(name: str) -> ComplexArray:
            here: ComplexArray = getattr(self, name)
            changes = [
                np.zeros_like(here) if side is None else (getattr(side[1], name) - getattr(side[0], name)) / side[2]
                for side in sides
            ]
            return np.array(changes).reshape(len(sides), *here.shape)

        return replace(self, slopes=slopes("shown"), left_out_slopes=slopes("left_out"))


def levels_of(measured: Measured, group: Group, basis: Array, matrices: Matrices, *, roving: bool) -> Levels | None:
    """What the nonlinear joints of a group show in its runs; None where it has none.

    ``basis`` (n, m) has the reduced ``matrices``; sensors that are ``roving`` are in these but for their axes.
    """
    run_of = np.array([measured.channels[i].run for i in group.channels])
    runs = np.unique(run_of)
    rows = tuple(np.flatnonzero(run_of == r) for r in runs)
    joints = joints_of(group.plan, group.structure, basis, group.rows, rows, group.masses_kg)
    if joints is None:
        return None
    shown, left_out = marched_runs(measured, runs, rows, joints, group.masses_kg * roving, matrices)
    none, none_left_out = (np.zeros((0, *of.shape), dtype=complex) for of in (shown, left_out))
    return Levels(joints, shown, left_out, none, none_left_out)


def marched_runs(
    measured: Measured,
    runs: NDArray[np.intp],
    rows: tuple[NDArray[np.intp], ...],
    joints: Joints,
    masses_kg: Array,
    matrices: Matrices,
) -> tuple[ComplexArray, ComplexArray]:
    """Stiffness (R, J, L) that joints show in ``runs`` of a structure, and what the records' ends leave out (C, L).

    ``rows`` are the rows of ``matrices`` in each run, ``masses_kg`` (C,) what these do not hold of their sensors.
    """
    top = float(measured.frequency_hz[-1])
    shown, left_out = [], np.zeros((matrices.axis.shape[0], measured.lines.size), dtype=complex)
    for run, own, laws in zip(runs, rows, joints.laws, strict=True):
        ending = measured.endings[run] if measured.endings else None
        push = Push(measured.pushed[run], measured.sample_rate_hz, measured.lines, top, ending)
        heavy = loaded_by(matrices, own, masses_kg[own])
        there = replace(heavy, axis=matrices.axis[own], tilt=matrices.tilt[own], spare=matrices.spare[own])
        stiffness, left_out[own] = marched_run(there, joints, laws, push)
        shown.append(stiffness)
    return np.array(shown), left_out


def level_accelerances(
    matrices: Matrices,
    joints: Joints,
    stiffness: ComplexArray,
    omega: Array,
    runs: tuple[NDArray[np.intp], ...],
    masses_kg: tuple[Array, ...],
    known: Poles | None = None,
) -> ComplexArray:
    """Accelerance (C, L) of every row where joints have an extra complex stiffness (R, J, L), run by run.

    ``runs`` give the rows of each run, ``masses_kg`` the point masses that move with them beyond the mass matrix.
    ``known`` are the poles of the matrices at these lines.
    """
    poles = poles_of(matrices, omega) if known is None else known
    square, count = omega**2, joints.rows.shape[0]
    pushed = poles.modal(matrices.drive[None])[0]
    moved = pushed @ (matrices.axis @ poles.vectors).T + matrices.spare
    tilted = pushed @ (matrices.tilt @ poles.vectors).T
    turned = pushed @ (joints.rows @ poles.vectors).T + joints.to_drive
    out = np.empty((matrices.axis.shape[0], omega.size), dtype=complex)
    for run, (rows, mass) in enumerate(zip(runs, masses_kg, strict=True)):
        carried = rows if mass.any() else rows[:0]
        held = mass[: carried.size]
        acting = np.vstack([matrices.axis[carried], joints.rows])
        spare, corner = missed(joints, rows, carried)
        flexible = flexibility(poles, matrices.axis[rows], acting, spare)
        reading = flexibility(poles, matrices.tilt[rows], acting, 0.0) - square[:, None, None] * flexible
        between = flexibility(poles, acting, acting, corner)
        # What mass and joint act with on the structure per motion of theirs, (L, points).
        acts = np.concatenate([square[:, None] * held, -stiffness[run].T], axis=1)
        plain = np.concatenate([moved[:, carried], turned], axis=1)
        system = np.eye(carried.size + count) - between * acts[:, None, :]
        loaded = np.linalg.solve(system, plain[:, :, None])[:, :, 0]
        free = tilted[:, rows] - square[:, None] * moved[:, rows]
        out[rows] = (free + np.einsum("lab,lb->la", reading, acts * loaded)).T
    return out
