"""What a changed structure does to A/F, to first order: the difference of its matrices between two known motions.

With Z q = h + Aᵀ f, f the force of the roving accelerometers' inertia, and p Z = b of a reading b, a change of the
structure moves the reading by p (dh + dAᵀ f + … - dZ q) + db q. Coordinates that a change adds are condensed onto the
old ones first, line by line, which is exact to the same order: so a swinging mass needs no modes of its own.

All motions are combinations of the anchor's modes and one static shape, all adjoints of those modes and one static
shape a reading: matrices are projected on them once, whatever the number of runs and lines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.mechanics.response import poles_of
from vgvt.reconcile.prediction.grouping import Group
from vgvt.reconcile.prediction.riding import Riders
from vgvt.reconcile.prediction.surrogate import Anchor
from vgvt.reconcile.question.data import MeasuredChannel

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, eq=False)
class _Run:
    """One run's motions, over its R sensors and L lines.

    ``rows`` (R,) index the group's channels. ``q`` (m + 1, L) are the shares of the group's motions, ``adjoint``
    (L, R, m) those of its modes in p of every reading; ``force`` (R, L) is the accelerometers' inertia force,
    ``displaced`` (R, L) their displacement, ``loading`` (R, L) what multiplies it.
    """

    rows: NDArray[np.intp]
    q: ComplexArray
    adjoint: ComplexArray
    force: ComplexArray
    displaced: ComplexArray
    loading: Array


@dataclass(frozen=True, slots=True, eq=False)
class _Known:
    """A group with the motions of its runs.

    ``motions`` (n, m + 1) are its modes and the static shape of the push that they miss; ``tests`` (m + C, n) its modes
    and what they miss of a static force along each channel. ``riders`` are the sensors it carries, of ``channels``;
    where they rove, their inertia along their axes loads each run by itself.
    """

    group: Group
    channels: tuple[MeasuredChannel, ...]
    riders: Riders
    motions: Array
    tests: Array
    runs: tuple[_Run, ...]


@dataclass(frozen=True, slots=True, eq=False)
class FirstOrder:
    """The motions of every run of a campaign at an anchor; what small changes do to A/F follows from them."""

    omega: Array
    shape: tuple[int, int]
    known: tuple[_Known, ...]
    last: dict[tuple[int, int, int], tuple[Array, ComplexArray]] = field(default_factory=dict)
    """By group, run and matrix: a block that was asked for last, and its product with the run's motions."""

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
            for k, known in enumerate(self.known):
                shared = np.isin(known.group.channels, group.channels)
                if not shared.any():
                    continue
                if not set(known.group.structure.joints) <= set(group.structure.joints):
                    return None
                change = _Change.between(known, group)
                try:
                    for r, run in enumerate(known.runs):
                        if shared[run.rows].all():
                            within = [self._product((k, r, i), m[0], run) for i, m in enumerate(change.matrices)]
                            out[known.group.channels[run.rows]] = change.moved(run, self.omega, within)
                except np.linalg.LinAlgError:
                    return None
        return out

    def _product(self, which: tuple[int, int, int], block: Array | None, run: _Run) -> ComplexArray | None:
        """A block (tests, motions) times a run's motions: the same for all of a scan that tunes what is added."""
        if block is None:
            return None
        known = self.last.get(which)
        if known is None or not np.array_equal(known[0], block):
            modes = run.adjoint.shape[2]
            here = np.concatenate([np.arange(modes), modes + run.rows])
            self.last[which] = known = (block, _times(block[here], run.q))
        return known[1]


def _motions(here: Anchor, index: int, omega: Array) -> _Known:
    group, reduced = here.assembled[index], here.groups[index]
    s, m = group.structure, reduced.matrices
    basis = reduced.basis
    poles = poles_of(m, omega)
    inverse = (poles.vectors[None] * poles.reciprocal[:, None, :]) @ poles.left
    square = (omega**2)[:, None]
    # What the modes left out do is static.
    rest = np.linalg.inv(s.stiffness) - basis @ np.linalg.solve(m.stiffness, basis.T)
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
        shares = pushed + np.einsum("lma,la->lm", answered, force)
        q = np.concatenate([shares.T, np.ones((1, omega.size))])
        runs.append(_Run(rows, q, adjoint, force.T.copy(), displaced.T.copy(), loading.T.copy()))
    motions = np.column_stack([basis, rest @ s.drive])
    tests = np.concatenate([basis.T, s.axis[group.rows] @ rest])
    channels = here.problem.measured.channels
    return _Known(group, channels, Riders.of(channels, group), motions, tests, tuple(runs))


@dataclass(frozen=True, slots=True, eq=False)
class _Change:
    """Differences of a changed group's arrays from a known one's, between its t tests and its m + 1 motions.

    ``matrices`` are stiffness, damping and mass, each as ``(tests by motions, new by motions, tests by new, new by
    new)`` of a new coordinates, None where a block changes nothing; ``drive`` (t,) and ``own_drive`` (a,) the push.
    ``axis``, ``tilt`` (C, m + 1) and ``own_axis``, ``own_tilt`` (C, a) are what sensors read of motions and of new
    coordinates, ``pulled`` (t, C) where a force along a sensor now acts besides, ``sensed`` (t, C) where it did, and
    ``masses_kg`` (C,) what sensors weigh besides: over the known group's channels, zero where the changed one has none.
    """

    matrices: tuple[tuple[Array | None, Array | None, Array | None, Array | None], ...]
    drive: Array
    own_drive: Array
    axis: Array
    tilt: Array
    own_axis: Array
    own_tilt: Array
    pulled: Array
    sensed: Array
    masses_kg: Array

    @classmethod
    def between(cls, known: _Known, there: Group) -> _Change:
        """The difference of two groups, the changed one's sensors included."""
        before = known.group
        old = len(before.structure.joints)
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
            mass = mass + Riders.of(known.channels, there).inertia(t) - known.riders.inertia(s)
        tests, motions, drive = known.tests, known.motions, t.drive - s.drive

        def projected(d: Array) -> tuple[Array | None, Array | None, Array | None, Array | None]:
            within, below, beside, own = d[:old, :old], d[old:, :old], d[:old, old:], d[old:, old:]
            return (
                tests @ within @ motions if within.any() else None, below @ motions if below.any() else None,
                tests @ beside if beside.any() else None, own if own.any() else None,
            )  # fmt: skip

        return cls(
            tuple(projected(d) for d in (t.stiffness - s.stiffness, t.damping - s.damping, mass)),
            tests @ drive[:old], drive[old:],
            axis[:, :old] @ motions, tilt[:, :old] @ motions, axis[:, old:], tilt[:, old:],
            tests @ axis[:, :old].T, tests @ before.structure.axis[before.rows].T,
            masses if known.riders.roving else np.zeros_like(masses),
        )  # fmt: skip

    @property
    def reseated(self) -> bool:
        """Whether sensors read the old coordinates otherwise."""
        return bool(self.axis.any() or self.tilt.any())

    def moved(self, run: _Run, omega: Array, within: Sequence[ComplexArray | None]) -> ComplexArray:
        """What it adds to the readings (R, L) of a run; ``within``: old coordinates' blocks times its motions."""
        rows, square = run.rows, omega**2
        modes = run.adjoint.shape[2]
        here = np.concatenate([np.arange(modes), modes + rows])
        by_line = ((1.0 + 0j) * np.ones(omega.size), 1j * omega, -(1.0 + 0j) * square)
        right: ComplexArray = np.zeros((here.size, omega.size), dtype=np.complex128) + self.drive[here, None]
        moved: ComplexArray = np.zeros((rows.size, omega.size), dtype=np.complex128)
        felt = moved
        for line, product in zip(by_line, within, strict=True):
            if product is not None:
                right -= line * product
        if self.reseated:
            right += _times(self.pulled[np.ix_(here, rows)], run.force)
            moved, felt = _times(self.axis[rows], run.q), _times(self.tilt[rows], run.q)
        if self.own_drive.size:
            own = self._own(run, by_line)
            for line, (_, _, beside, _) in zip(by_line, self.matrices, strict=True):
                if beside is not None:
                    right -= line * _times(beside[here], own)
            moved, felt = moved + _times(self.own_axis[rows], own), felt + _times(self.own_tilt[rows], own)
        # What the sensors weigh, and where they sit, loads the structure along their axes.
        if self.reseated or self.own_drive.size or self.masses_kg.any():
            load = run.loading * moved + square * self.masses_kg[rows, None] * run.displaced
            right += _times(self.sensed[np.ix_(here, rows)], load)
        read = (run.adjoint @ right[:modes].T[:, :, None])[:, :, 0].T - square * right[modes:]
        return np.asarray(read - square * moved + felt)

    def _own(self, run: _Run, by_line: Sequence[NDArray[Any]]) -> ComplexArray:
        """New coordinates (a, L) at the old motion: Z_aa q_a = h_a + A_aᵀ f - Z_ar q."""
        axis = self.own_axis[run.rows]
        right = self.own_drive[:, None] + _times(axis.T, run.force)
        pairs = axis[:, :, None] * axis[:, None, :]
        stiff = -(pairs.reshape(axis.shape[0], -1).T @ run.loading).reshape(*pairs.shape[1:], -1).astype(complex)
        for line, (_, below, _, own) in zip(by_line, self.matrices, strict=True):
            if below is not None:
                right -= line * _times(below, run.q)
            if own is not None:
                stiff += own[:, :, None] * line
        if right.shape[0] == 1:
            return np.asarray(right / stiff[0])
        return np.asarray(np.linalg.solve(stiff.transpose(2, 0, 1), right.T[:, :, None])[:, :, 0].T)


def _times(matrix: Array, values: ComplexArray) -> ComplexArray:
    """A real matrix times a complex one, without making that complex."""
    return (matrix @ np.ascontiguousarray(values).view(np.float64)).view(np.complex128)
