"""The driven rig as a linear state-space model: command in volts to measured force and accelerations.

State x = [q, q']: joint coordinates about the equilibrium and their rates; the
coil's current is in there as the spring of its mechanical equivalent.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.simulation.assembly import Plan, Rig
from vgvt.simulation.linear import LinearModel, site_row
from vgvt.simulation.rig import COIL, HAMMER, STINGER, numbered
from vgvt.simulation.seats import MeasurementPoint
from vgvt.simulation.sensed import at_rest, displacement_rows, linearised_at, tilt_rows


@dataclass(frozen=True, slots=True, eq=False)
class StateSpace:
    """x' = A x + B u, y = C x + D u with u in volts of command, or newtons of a hammer.

    ``state_matrix`` (n, n), ``input_matrix`` (n,), ``output_matrix`` (outputs, n),
    ``feedthrough`` (outputs,); with several shakers (n, inputs) and (outputs, inputs). Outputs:
    accelerations of the points asked for, m/s^2 as an accelerometer feels them (with its tilt in
    gravity), then the force at every transducer's sensing element, N. ``linear`` are the matrices behind it.
    """

    linear: LinearModel
    state_matrix: NDArray[np.float64]
    input_matrix: NDArray[np.float64]
    output_matrix: NDArray[np.float64]
    feedthrough: NDArray[np.float64]

    @property
    def inputs(self) -> NDArray[np.float64]:
        """The input matrix as columns (n, inputs)."""
        return self.input_matrix.reshape(self.state_matrix.shape[0], -1)

    @property
    def feedthrough_rows(self) -> NDArray[np.float64]:
        """The feedthrough as rows (outputs, inputs)."""
        return self.feedthrough.reshape(self.output_matrix.shape[0], -1)

    def outputs(self, index: list[int]) -> StateSpace:
        """The same model with some of its outputs, in that order."""
        return replace(self, output_matrix=self.output_matrix[index], feedthrough=self.feedthrough[index])


def mass_above_element_kg(layout: Plan) -> float:
    """Mass between the sensing element and the stinger: it is shaken, but its force is not measured."""
    scenario = layout.scenario
    return scenario.transducer.mass_kg - scenario.transducer.end_mass_kg + 0.5 * scenario.stinger.mass_kg


def state_space(layout: Plan, rig: Rig, points: tuple[MeasurementPoint, ...]) -> StateSpace:
    """The linear model of a driven rig, with the accelerations of ``points`` as outputs."""
    linear = linearised_at(rig, points)
    n = linear.freedoms
    inverse_mass = np.linalg.inv(linear.mass)
    a, b = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, len(layout.forces)))
    a[:n, n:] = np.eye(n)
    a[n:, :n] = -inverse_mass @ linear.stiffness
    a[n:, n:] = -inverse_mass @ linear.damping
    for k, names in enumerate(exciter_names(layout)):
        b[n:, k] = inverse_mass @ _pushed_by(rig, layout, names[0])
    tilt = tilt_rows(rig, points)
    acceleration = linear.displacement @ a[n:]
    acceleration[:, :n] += tilt
    force, force_feedthrough = _force_rows(layout, rig, a[n:], b[n:])
    feedthrough = np.vstack([linear.displacement @ b[n:], force_feedthrough])
    one = len(layout.forces) == 1
    return StateSpace(
        linear,
        a,
        b[:, 0] if one else b,
        np.vstack([acceleration, force]),
        feedthrough[:, 0] if one else feedthrough,
    )


def exciter_names(layout: Plan) -> tuple[tuple[str, ...], ...]:
    """The names of the actuators that each input drives: all of the hammer, or the coil of every shaker."""
    if layout.strike is not None:
        return (tuple(numbered(HAMMER, k) for k in range(len(layout.strike.weighted_sites))),)
    return tuple((numbered(COIL, k),) for k in range(len(layout.drives)))


def _pushed_by(rig: Rig, layout: Plan, name: str) -> NDArray[np.float64]:
    """Generalised force (nv,) of an exciter for a unit of its input."""
    model = rig.model
    if layout.strike is not None:
        row: NDArray[np.float64] = displacement_rows(rig, (layout.strike,))[0]
        return row
    actuator, force = model.actuator(name).id, np.zeros(model.nv)
    force[model.jnt_dofadr[model.actuator_trnid[actuator, 0]]] = model.actuator_gainprm[actuator, 0]
    return force


def _force_rows(
    layout: Plan, rig: Rig, rate_rows: NDArray[np.float64], rate_input: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Rows (forces, 2 nv) of the measured forces and what of each input they feel at once, (forces, inputs)."""
    if layout.strike is not None:
        hammer = layout.scenario.hammer
        assert hammer is not None, "only a hammer strikes"
        return np.zeros((1, 2 * rig.model.nv)), np.array([[hammer.reading]])
    rows, feedthrough = zip(
        *(_force_row(layout, rig, rate_rows, rate_input, k) for k in range(len(layout.drives))), strict=True
    )
    return np.array(rows), np.array(feedthrough)


def _force_row(
    layout: Plan, rig: Rig, rate_rows: NDArray[np.float64], rate_input: NDArray[np.float64], exciter: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Row of the force at the sensing element: the stinger's push less the inertia of what lies between."""
    model, stinger, drive = rig.model, layout.scenario.stinger, layout.drives[exciter]
    n = model.nv
    length_row = _length_row(rig, numbered(STINGER, exciter))
    drive_row = site_row(model, at_rest(rig), drive.site, drive.axis)
    inertia = mass_above_element_kg(layout)
    row = -inertia * (drive_row @ rate_rows)
    row[:n] -= stinger.axial_stiffness_n_per_m * length_row + inertia * tilt_rows(rig, (drive,))[0]
    row[n:] -= stinger.axial_damping_n_s_per_m * length_row
    for name, spring in layout.gauged_springs(exciter):
        turn_row = _length_row(rig, name)
        row[:n] -= spring.gauge_per_m * spring.stiffness_n_m_per_rad * turn_row
        row[n:] -= spring.gauge_per_m * spring.damping_n_m_s_per_rad * turn_row
    return row, -inertia * drive_row @ rate_input


def _length_row(rig: Rig, tendon: str) -> NDArray[np.float64]:
    """What a unit of each coordinate does to the length of a tendon, or to the sum of joints that it is, (nv,)."""
    data, rod = at_rest(rig), rig.model.tendon(tendon).id
    row = np.zeros(rig.model.nv)
    for j in range(row.size):
        data.qvel[:] = 0.0
        data.qvel[j] = 1.0
        mujoco.mj_fwdVelocity(rig.model, data)
        row[j] = data.ten_velocity[rod]
    return row
