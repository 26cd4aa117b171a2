"""Responses that depend on level: what nonlinear joints turn the accelerances of a structure into, run by run.

Runs share the linear structure. What the level changes is the complex stiffness κ(ω) = reaction / motion that each
joint shows over the whole record of a run, found from the run's own measured force.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from vgvt.effects.elements import JointLaw
from vgvt.reconcile.data import Measured
from vgvt.reconcile.describing import Law
from vgvt.reconcile.grouping import Group
from vgvt.reconcile.march import Memory, marched
from vgvt.reconcile.response import Matrices, Poles, poles_of
from vgvt.scenario.mirror import part_name
from vgvt.simulation.assembly import Plan
from vgvt.simulation.reduced import Structure
from vgvt.simulation.rig import GRAVITY_M_PER_S2

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# Steps a period of the band's top (a joint that sticks is stopped at their ends, and no sooner), and how far above
# the band modes answer by more than their flexibility.
_STEPS_PER_PERIOD, _STEPS_OF_FRICTION = 16.0, 40.0
_MARCHED_BANDS = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class Joints:
    """Joints with a force law of their own, in reduced coordinates: ``rows`` (J, m) of their motions.

    ``laws`` are those of every run and joint: the run's sensors rest on them too. ``to_drive`` (J,), ``to_axis``
    (C, J) and ``between`` (J, J) are static flexibilities that the coordinates miss.
    """

    laws: tuple[tuple[Law, ...], ...]
    rows: Array
    to_drive: Array
    to_axis: Array
    between: Array


@dataclass(frozen=True, slots=True, eq=False)
class Pushes:
    """Measured forces (R, N) in N at ``rate_hz``, and the ``lines`` (L,) of the whole record that are looked at."""

    samples: Array
    rate_hz: float
    lines: NDArray[np.intp]
    top_hz: float


@dataclass(frozen=True, slots=True, eq=False)
class Levels:
    """Nonlinear joints of a group of runs, and the stiffness ``shown`` (R, J, L) that they show at each run's level.

    ``slopes`` (effects, R, J, L) are its changes with the scores of the effects in play.
    """

    joints: Joints
    shown: ComplexArray
    slopes: ComplexArray

    def moved(self, scores: Array) -> ComplexArray:
        """The stiffness shown (R, J, L) where the effects' scores have moved by (effects,)."""
        return np.asarray(self.shown + np.tensordot(scores, self.slopes, axes=1)) if scores.any() else self.shown

    def sloped(self, slopes: list[ComplexArray]) -> Levels:
        """The same with the slopes known."""
        return replace(self, slopes=np.array(slopes).reshape(len(slopes), *self.shown.shape))


def levels_of(measured: Measured, group: Group, basis: Array, matrices: Matrices) -> Levels | None:
    """What the nonlinear joints of a group show in its runs; None where it has none.

    ``basis`` (n, m) has the reduced ``matrices``, sensors included.
    """
    run_of = np.array([measured.channels[i].run for i in group.channels])
    runs = np.unique(run_of)
    rows = tuple(np.flatnonzero(run_of == r) for r in runs)
    joints = joints_of(group.plan, group.structure, basis, group.rows, rows, group.masses_kg)
    if joints is None:
        return None
    pushes = Pushes(measured.pushed[runs], measured.sample_rate_hz, measured.lines, float(measured.frequency_hz[-1]))
    shown = shown_stiffness(matrices, joints, pushes)
    return Levels(joints, shown, np.zeros((0, *shown.shape), dtype=complex))


def joint_laws(layout: Plan, s: Structure) -> dict[int, Law]:
    """Force laws by the coordinate of the structure that they act on, each about where the weight holds it."""
    found = {}
    for _, element in layout.elements:
        if isinstance(element, JointLaw):
            name = f"{part_name(layout.parts.airframe, element.beam, 1.0)}-root/{element.kind}"
            index = s.joints.index(name)
            law = Law.of(element, float(s.equilibrium[index]))
            if law.cubic or law.friction or law.play:
                found[index] = law
    return found


def joints_of(
    layout: Plan,
    s: Structure,
    basis: Array,
    rows: NDArray[np.intp],
    runs: tuple[NDArray[np.intp], ...],
    masses_kg: Array,
) -> Joints | None:
    """The nonlinear joints of a structure in a ``basis`` (n, m); None where it has none.

    The channels are at its ``rows`` (C,) of places, those of each run are ``runs``; each carries a sensor of
    ``masses_kg`` (C,), whose weight the structure has not settled under.
    """
    laws = joint_laws(layout, s)
    if not laws:
        return None
    index = np.array(list(laws))
    unit = np.zeros((s.drive.size, index.size))
    unit[index, np.arange(index.size)] = 1.0
    stiffness = basis.T @ s.stiffness @ basis
    reduced = basis[index]
    moved, pushed = np.linalg.solve(s.stiffness, unit), np.linalg.solve(s.stiffness, s.drive)
    near, near_pushed = np.linalg.solve(stiffness, reduced.T), np.linalg.solve(stiffness, basis.T @ s.drive)
    axis = s.axis[rows]
    weight = -GRAVITY_M_PER_S2 * masses_kg[:, None] * s.jacobian[rows, 2][:, index]
    loaded = tuple(
        tuple(law.loaded(float(weight[run, k].sum())) for k, law in enumerate(laws.values())) for run in runs
    )
    return Joints(
        loaded, reduced, pushed[index] - reduced @ near_pushed, axis @ moved - axis @ basis @ near,
        moved[index] - reduced @ near,
    )  # fmt: skip


def shown_stiffness(matrices: Matrices, joints: Joints, pushes: Pushes) -> ComplexArray:
    """Complex stiffness κ (R, J, L) that joints show beyond their tangent, in the runs with ``pushes``."""
    count, rate = pushes.samples.shape[1], pushes.rate_hz
    duration = count / rate
    rubs = any(law.friction > 0 for row in joints.laws for law in row)
    per_period = _STEPS_OF_FRICTION if rubs else _STEPS_PER_PERIOD
    steps = scipy.fft.next_fast_len(int(np.ceil(duration * per_period * pushes.top_hz)), real=True)
    # Twice the record: what rings on must not come round to its beginning.
    top = int(_MARCHED_BANDS * pushes.top_hz * 2 * duration)
    spectrum = scipy.fft.rfft(pushes.samples, 2 * count, axis=1)[:, : min(top, count)]
    omega = 2 * np.pi * np.arange(spectrum.shape[1]) / (2 * duration)
    poles = poles_of(matrices, omega)
    answered = poles.modal(matrices.drive[None])[0] @ (joints.rows @ poles.vectors).T + joints.to_drive
    moved = scipy.fft.irfft(spectrum[:, None, :] * answered.T, 2 * steps, axis=2)[:, :, :steps] * (steps / count)
    limit = 2 * np.pi * _MARCHED_BANDS * pushes.top_hz
    reaction = marched(moved, _memory(poles, joints, limit), joints.laws, duration / steps)
    force = scipy.fft.rfft(reaction, axis=2)[:, :, pushes.lines] * (count / steps)
    here = poles_of(matrices, 2 * np.pi * pushes.lines / duration)
    linear = here.modal(matrices.drive[None])[0] @ (joints.rows @ here.vectors).T + joints.to_drive
    flexible = _flexible(here, joints.rows, joints.rows, joints.between)
    pushed = scipy.fft.rfft(pushes.samples, axis=1)[:, pushes.lines]
    motion = pushed[:, None, :] * linear.T - np.einsum("lij,rjl->ril", flexible, force)
    # Not finite where a march ran away.
    with np.errstate(invalid="ignore", over="ignore"):
        return np.asarray(force / np.where(motion == 0, 1.0, motion))


def level_accelerances(
    matrices: Matrices,
    joints: Joints,
    stiffness: ComplexArray,
    omega: Array,
    runs: tuple[NDArray[np.intp], ...],
    masses_kg: tuple[Array, ...],
) -> ComplexArray:
    """Accelerance (C, L) of every row where joints have an extra complex stiffness (R, J, L), run by run.

    ``runs`` give the rows of each run, ``masses_kg`` the point masses that move with them beyond the mass matrix.
    """
    poles = poles_of(matrices, omega)
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
        flexible = _flexible(poles, matrices.axis[rows], acting, spare)
        reading = _flexible(poles, matrices.tilt[rows], acting, 0.0) - square[:, None, None] * flexible
        between = _flexible(poles, acting, acting, corner)
        # What mass and joint act with on the structure per motion of theirs, (L, points).
        acts = np.concatenate([square[:, None] * held, -stiffness[run].T], axis=1)
        plain = np.concatenate([moved[:, carried], turned], axis=1)
        system = np.eye(carried.size + count) - between * acts[:, None, :]
        loaded = np.linalg.solve(system, plain[:, :, None])[:, :, 0]
        free = tilted[:, rows] - square[:, None] * moved[:, rows]
        out[rows] = (free + np.einsum("lab,lb->la", reading, acts * loaded)).T
    return out


def missed(joints: Joints, rows: NDArray[np.intp], carried: NDArray[np.intp]) -> tuple[Array, Array]:
    """Static flexibilities that the coordinates miss, where sensors ``carried`` and joints act: b points in all.

    The first (a, b) is from these to the rows (a,), the second (b, b) between them.
    """
    loads = carried.size
    to_rows, between = np.zeros((rows.size, loads + len(joints.rows))), np.zeros((loads + len(joints.rows),) * 2)
    to_rows[:, loads:] = joints.to_axis[rows]
    between[:loads, loads:] = joints.to_axis[carried]
    between[loads:, :loads] = joints.to_axis[carried].T
    between[loads:, loads:] = joints.between
    return to_rows, between


def _flexible(poles: Poles, seen: Array, acting: Array, spare: Array | float) -> ComplexArray:
    """Motion at rows (a, m) for unit forces at rows (b, m), (L, a, b), with static flexibility missed by the modes."""
    answered = poles.modal(acting) @ (seen @ poles.vectors).T
    return np.asarray(answered.transpose(1, 2, 0) + spare)


def _memory(poles: Poles, joints: Joints, limit: float) -> Memory:
    """The joints' answer to their own reactions, modes beyond a limit in rad/s as flexibility."""
    out, into = joints.rows @ poles.vectors, poles.left @ joints.rows.T
    slow = (np.abs(poles.poles) < limit) & (poles.poles.imag >= 0)
    fast = np.abs(poles.poles) >= limit
    pair = np.where(poles.poles[slow].imag > 0, 2.0, 1.0)
    at_once = joints.between - ((out[:, fast] / poles.poles[fast]) @ into[fast]).real
    return Memory(poles.poles[slow], out[:, slow] * pair, into[slow], at_once)
