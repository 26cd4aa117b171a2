"""Nonlinear joints of a structure: their force laws, loaded by what rests on them, in reduced coordinates."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.elements import JointLaw
from vgvt.effects.root_joint import one_law
from vgvt.reconcile.mechanics.law import Law
from vgvt.scenario.mirror import part_name
from vgvt.simulation.assembly import Plan
from vgvt.simulation.reduced import Structure, mean_sensors_kg
from vgvt.simulation.rig import GRAVITY_M_PER_S2

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Hanging:
    """Nonlinear joints where a structure has settled: their coordinates ``index`` (J,) in it, and their ``laws`` there.

    ``weights`` (R, J) are what rests on them in every run beyond that, N m.
    """

    index: NDArray[np.intp]
    laws: tuple[Law, ...]
    weights: Array

    def in_runs(self) -> tuple[tuple[Law, ...], ...]:
        """The laws of every run and joint."""
        return tuple(tuple(law.loaded(float(w)) for law, w in zip(self.laws, run, strict=True)) for run in self.weights)

    def turned(self, by_rad: Array) -> Hanging:
        """The same where the structure has settled with its joints turned by some angles (J,) more."""
        laws = tuple(law.resting(law.rest + float(a)) for law, a in zip(self.laws, by_rad, strict=True))
        return replace(self, laws=laws)


@dataclass(frozen=True, slots=True, eq=False)
class Joints:
    """Joints with a force law of their own, in reduced coordinates: ``rows`` (J, m) of their motions.

    ``laws`` are those of every run and joint: the run's sensors rest on them too. ``to_drive`` (J,), ``to_axis``
    (C, J) and ``between`` (J, J) are static flexibilities that the coordinates miss. ``hanging`` is what the laws come
    from; None where that is not known.
    """

    laws: tuple[tuple[Law, ...], ...]
    rows: Array
    to_drive: Array
    to_axis: Array
    between: Array
    hanging: Hanging | None = None

    @property
    def index(self) -> NDArray[np.intp]:
        """The joints' coordinates (J,) in the structure that they come from; none where that is not known."""
        return np.zeros(0, dtype=np.intp) if self.hanging is None else self.hanging.index

    def turned(self, by_rad: Array) -> Joints:
        """The same joints of a structure that has settled with them turned by some angles (J,) more.

        One with play opens the later the more rests on it.
        """
        if self.hanging is None or not by_rad.any():
            return self
        hanging = self.hanging.turned(by_rad)
        return replace(self, laws=hanging.in_runs(), hanging=hanging)


def joint_laws(layout: Plan, s: Structure) -> dict[int, Law]:
    """Force laws by the coordinate of the structure that they act on, each about where the weight holds it.

    What several effects say of one joint is one law.
    """
    said: dict[int, list[JointLaw]] = {}
    for _, element in layout.elements:
        if isinstance(element, JointLaw):
            name = f"{part_name(layout.parts.airframe, element.beam, 1.0)}-root/{element.kind}"
            said.setdefault(s.joints.index(name), []).append(element)
    laws = {index: Law.of(one_law(together), float(s.equilibrium[index])) for index, together in said.items()}
    return {index: law for index, law in laws.items() if law.cubic or law.friction or law.play}


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
    ``masses_kg`` (C,). The structure has settled under what sensors weigh in the mean of all runs.
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
    homes = {p.dof.node: s.places.index(p.site) for p in layout.grid}
    weight = -GRAVITY_M_PER_S2 * masses_kg[:, None] * s.jacobian[rows, 2][:, index]
    settled = np.zeros(index.size)
    for node, mean_kg in mean_sensors_kg(layout.scenario).items():
        settled -= GRAVITY_M_PER_S2 * mean_kg * s.jacobian[homes[node], 2][index]
    weights = np.array([weight[run].sum(axis=0) - settled for run in runs])
    hanging = Hanging(index, tuple(laws.values()), weights)
    return Joints(
        hanging.in_runs(), reduced, pushed[index] - reduced @ near_pushed, axis @ moved - axis @ basis @ near,
        moved[index] - reduced @ near, hanging,
    )  # fmt: skip


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
