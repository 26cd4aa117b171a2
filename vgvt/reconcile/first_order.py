"""What a changed structure does to A/F, to first order: the difference of its matrices between two known motions.

With Z q = h + Aᵀ f, f the force of the roving accelerometers' inertia, and p Z = b of a reading b, a change of the
structure moves the reading by p (dh + dAᵀ f + … - dZ q) + db q. Coordinates that a change adds are condensed onto the
old ones first, line by line, which is exact to the same order: so a swinging mass needs no modes of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.grouping import Group
from vgvt.reconcile.response import poles_of
from vgvt.reconcile.surrogate import Anchor
from vgvt.simulation.reduced import Structure

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
_ROUND_OFF = 1e-10


@dataclass(frozen=True, slots=True, eq=False)
class _Run:
    """One run's motions, over its R sensors, L lines and the structure's n coordinates.

    ``rows`` (R,) index the group's channels, ``axis`` (R, n) reads along the sensors. ``q`` (L, n) is the motion,
    ``adjoint`` (L, R, n) p of every reading, ``force`` (L, R) the accelerometers' inertia force, ``displaced`` (L, R)
    their displacement, ``loading`` (L, R) what multiplies it.
    """

    rows: NDArray[np.intp]
    axis: Array
    q: ComplexArray
    adjoint: ComplexArray
    force: ComplexArray
    displaced: ComplexArray
    loading: Array


@dataclass(frozen=True, slots=True, eq=False)
class _Known:
    """A group with the motions of its runs; the sensors' inertia along their axes loads each run where they rove."""

    group: Group
    roving: bool
    runs: tuple[_Run, ...]


@dataclass(frozen=True, slots=True, eq=False)
class FirstOrder:
    """The motions of every run of a campaign at an anchor; what small changes do to A/F follows from them."""

    omega: Array
    shape: tuple[int, int]
    known: tuple[_Known, ...]

    @classmethod
    def of(cls, here: Anchor) -> FirstOrder | None:
        """The motions at an anchor; None where a joint depends on level."""
        if any(reduced.levels is not None for reduced in here.groups):
            return None
        omega = 2 * np.pi * here.problem.measured.frequency_hz
        known = tuple(_motions(here, k, omega) for k in range(len(here.groups)))
        return cls(omega, here.problem.measured.values.shape, known)

    def change(self, there: Sequence[Group]) -> ComplexArray | None:
        """Change (C, L) of the accelerance by other groups of the same runs, to first order.

        None where they are no small change: fewer coordinates, or new ones that nothing holds.
        """
        out = np.zeros(self.shape, dtype=complex)
        for group in there:
            for known in self.known:
                shared = np.isin(known.group.channels, group.channels)
                if not shared.any():
                    continue
                if not set(known.group.structure.joints) <= set(group.structure.joints):
                    return None
                try:
                    change = _Change.between(known, group, self.omega)
                    for run in known.runs:
                        if shared[run.rows].all():
                            out[known.group.channels[run.rows]] = change.moved(run, self.omega)
                except np.linalg.LinAlgError:
                    return None
        return out


def _motions(here: Anchor, index: int, omega: Array) -> _Known:
    group, reduced = here.assembled[index], here.groups[index]
    s, m = group.structure, reduced.matrices
    basis = reduced.basis
    poles = poles_of(m, omega)
    inverse = (poles.vectors[None] * poles.reciprocal[:, None, :]) @ poles.left
    square = (omega**2)[:, None]
    # What the modes left out do is static: a motion of the push, and one of every reading.
    flexibility = np.linalg.inv(s.stiffness)
    rest = flexibility - basis @ np.linalg.solve(m.stiffness, basis.T)
    pushed = inverse @ m.drive
    runs = []
    for rows in reduced.runs:
        axis, tilt = m.axis[rows], m.tilt[rows]
        loading = square * (group.masses_kg[rows] * reduced.roving)
        towards = -square[:, :, None] * axis + tilt
        answered = inverse @ axis.T
        loaded = np.linalg.inv(np.eye(rows.size) - (axis @ answered) * loading[:, None, :])
        displaced = np.einsum("lab,lb->la", loaded, pushed @ axis.T + m.spare[rows])
        force = loading * displaced
        adjoint = towards @ inverse
        adjoint = adjoint + (towards @ answered) @ (loading[:, :, None] * loaded) @ (axis @ inverse)
        q = (pushed + np.einsum("lma,la->lm", answered, force)) @ basis.T + rest @ s.drive
        sensed = s.axis[group.rows[rows]]
        static = square[:, :, None] * (sensed @ rest)
        runs.append(_Run(rows, sensed, q, adjoint @ basis.T - static, force, displaced, loading))
    return _Known(group, reduced.roving, tuple(runs))


@dataclass(frozen=True, slots=True, eq=False)
class _Change:
    """Differences of a changed group's arrays from a known one's; the ``old`` coordinates come first.

    ``factors`` are what stiffness, damping and mass make of the old motions, as (L,) by (n', r) by (r, n): what is
    added moves with few of their combinations. ``coupled`` (L, n', n' - n) is the impedance to the new coordinates.
    ``axis``, ``tilt`` (C_g, n') and ``masses_kg`` (C_g,) are over the known group's channels, zero for those that the
    changed one lacks.
    """

    old: int
    factors: tuple[tuple[ComplexArray, Array, Array], ...]
    coupled: ComplexArray
    drive: Array
    axis: Array
    tilt: Array
    masses_kg: Array

    @classmethod
    def between(cls, known: _Known, there: Group, omega: Array) -> _Change:
        """The difference of two groups, the changed one's sensors included."""
        before = known.group
        joints = before.structure.joints
        joints = (*joints, *(j for j in there.structure.joints if j not in set(joints)))
        s, t = before.structure.onto(joints), there.structure.onto(joints)
        _, here, other = np.intersect1d(before.channels, there.channels, return_indices=True)
        shape = (before.rows.size, len(joints))
        axis, tilt, masses = np.zeros(shape), np.zeros(shape), np.zeros(before.rows.size)
        axis[here] = t.axis[there.rows[other]] - s.axis[before.rows[here]]
        tilt[here] = t.tilt[there.rows[other]] - s.tilt[before.rows[here]]
        masses[here] = there.masses_kg[other] - before.masses_kg[here]
        mass = t.mass - s.mass
        moved = t.jacobian[there.rows[other]] - s.jacobian[before.rows[here]]
        if masses.any() or moved.any():
            # As the anchor has it: the mean of what moves across their axes where they rove, else all of one run's.
            runs = [run for run in known.runs if np.isin(run.rows, here).all()][: None if known.roving else 1]
            chosen = np.isin(here, np.concatenate([run.rows for run in runs]))
            heavy = _weight(t, there.rows[other[chosen]], there.masses_kg[other[chosen]], known.roving)
            light = _weight(s, before.rows[here[chosen]], before.masses_kg[here[chosen]], known.roving)
            mass = mass + (heavy - light) / len(runs)
        old, factors = len(before.structure.joints), []
        coupled = np.zeros((omega.size, len(joints), len(joints) - old), dtype=complex)
        by_line = (np.ones(omega.size, complex), 1j * omega, -(omega**2) + 0j)
        for line, matrix in zip(by_line, (t.stiffness - s.stiffness, t.damping - s.damping, mass), strict=True):
            if matrix.any():
                factors.append((line, *_few(matrix[:, :old])))
                coupled += line[:, None, None] * matrix[:, old:]
        loads = masses if known.roving else np.zeros_like(masses)
        return cls(old, tuple(factors), coupled, t.drive - s.drive, axis, tilt, loads)

    def moved(self, run: _Run, omega: Array) -> ComplexArray:
        """What it adds to the readings (R, L) of a run."""
        old, rows, square = self.old, run.rows, omega**2
        axis, tilt = self.axis[rows], self.tilt[rows]
        right = self.drive[:, None] + axis.T @ run.force.T - self._resisted(run.q)
        moved, felt = axis[:, :old] @ run.q.T, tilt[:, :old] @ run.q.T
        if self.drive.size > old:
            # Z_aa q_a = h_a + A_aᵀ f - Z_ar q, all at the old motion.
            stiff = self.coupled[:, old:] - np.einsum("la,ai,aj->lij", run.loading, axis[:, old:], axis[:, old:])
            own = np.linalg.solve(stiff, right[old:].T[:, :, None])
            right = right - (self.coupled @ own)[:, :, 0].T
            own = own[:, :, 0]
            moved, felt = moved + axis[:, old:] @ own.T, felt + tilt[:, old:] @ own.T
        # What the sensors weigh, and where they sit, loads the structure along their axes.
        load = run.loading.T * moved + square * self.masses_kg[rows, None] * run.displaced.T
        read = (run.adjoint @ (right[:old] + run.axis.T @ load).T[:, :, None])[:, :, 0].T
        return np.asarray(read - square * moved + felt)

    def _resisted(self, q: ComplexArray) -> ComplexArray:
        """What the changed matrices make of the old motions (L, n): forces (n', L)."""
        out = np.zeros((self.drive.size, q.shape[0]), dtype=complex)
        for line, left, right in self.factors:
            out += left @ (line * (right @ q.T))
        return out


def _few(matrix: Array) -> tuple[Array, Array]:
    """A matrix as a product of as few columns and rows as it takes."""
    left, size, right = np.linalg.svd(matrix, full_matrices=False)
    count = max(1, int((size > _ROUND_OFF * size[0]).sum()))
    return np.asarray(left[:, :count] * size[:count]), np.asarray(right[:count])


def _weight(s: Structure, rows: NDArray[np.intp], masses_kg: Array, roving: bool) -> Array:
    """Inertia (n, n) of sensors at some rows; only across their axes where they rove."""
    moved = s.jacobian[rows]
    total = np.einsum("r,rai,raj->ij", masses_kg, moved, moved, optimize=True)
    return np.asarray(total - (s.axis[rows].T * masses_kg) @ s.axis[rows] * roving)
