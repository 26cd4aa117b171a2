"""The linearised model: M, C, K and the maps of sensors and actuators at an equilibrium.

Mass comes from MuJoCo's composite inertia, stiffness in closed form from gravity, the springs and the tendons' tension;
what is not known so, and damping of more than joints and tendons, are central differences of the joint forces. Sensor
rows are analytic Jacobians of their sites.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.simulation.tangent import tangent_stiffness

# Forces here are linear up to geometry: this step leaves truncation and round-off near 1e-9 of the spring.
_STEP = 1e-5
# Of the largest stiffness, what lets the weight move a joint that nothing holds.
_HARDLY_HELD = 1e-10
# Newton's method is through in so many steps, but where it rests so near a stop that a difference reaches past it.
_THROUGH, _BESIDE_A_STOP = 10, 1e-8
# Steps downhill at most, three times what the slowest of the bundled aircraft with play takes; how often one is halved.
_DOWNHILL, _HALVINGS = 100, 40
# What a balanced aircraft is pushed by, m or rad.
_PUSHED_OVER = 1e-4
# Of what the weight does to the joints: the sums that should cancel leave up to 5e-16 of it.
_ROUNDING = 1e-14
# Of what a spring would push if it felt one coordinate alone: what is left where several cancel.
_CANCELLED = 1e-15


@dataclass(frozen=True, slots=True, eq=False)
class LinearModel:
    """M q'' + C q' + K q = B u about an equilibrium; all square arrays (nv, nv), SI.

    ``displacement`` (P, nv) are rows of point displacements: w = displacement q.
    """

    mass: NDArray[np.float64]
    damping: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    displacement: NDArray[np.float64]
    equilibrium: NDArray[np.float64]

    @property
    def freedoms(self) -> int:
        """Number of coordinates."""
        return int(self.mass.shape[0])


def joint_force(model: mujoco.MjModel, data: mujoco.MjData) -> NDArray[np.float64]:
    """The force (nv,) that accelerates the joints: passive and actuator minus bias, at the state in ``data``."""
    # Not mj_forward: the acceleration of a bad guess is of no use, and MuJoCo would log a warning about it. Nor all of
    # mj_fwdPosition: forces need no inertia matrix, whose factors are half of its work, and nothing here touches.
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_tendon(model, data)
    mujoco.mj_transmission(model, data)
    return _force_here(model, data)


def _force_here(model: mujoco.MjModel, data: mujoco.MjData) -> NDArray[np.float64]:
    """:func:`joint_force` at a position whose kinematics are in ``data`` already, at the velocity in ``data``."""
    mujoco.mj_fwdVelocity(model, data)
    mujoco.mj_fwdActuation(model, data)
    return np.asarray(data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias)


def mass_matrix(model: mujoco.MjModel, data: mujoco.MjData) -> NDArray[np.float64]:
    """Full joint-space inertia (nv, nv) at the position in ``data``."""
    mujoco.mj_fwdPosition(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full


def linearise(
    model: mujoco.MjModel, qpos: NDArray[np.float64], points: tuple[tuple[str, NDArray[np.float64]], ...] = ()
) -> LinearModel:
    """Linearise at rest at ``qpos`` (nq,), with displacement rows for ``points``: (site name, direction (3,))."""
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mass = mass_matrix(model, data)
    rows = np.array([site_row(model, data, site, direction) for site, direction in points]).reshape(-1, model.nv)

    stiffness = stiffness_matrix(model, data, qpos)

    return LinearModel(mass, damping_matrix(model, data), stiffness, rows, qpos.copy())


def damping_matrix(model: mujoco.MjModel, data: mujoco.MjData) -> NDArray[np.float64]:
    """Change of the joint forces with velocity, sign turned, (nv, nv), at rest at the position in ``data``.

    Where nothing is damped but joints and tendons, each by a constant, that is their dampers: what bodies do to each
    other by turning grows with the square. Anything else is asked by differences of forces.
    """
    data.qvel[:] = 0.0
    joint_force(model, data)
    plain = not (model.nu or model.opt.viscosity or model.opt.density)
    if plain and not (model.dof_dampingpoly.any() or model.tendon_dampingpoly.any()):
        row = np.zeros((model.ntendon, model.nv))
        if model.ntendon:
            mujoco.mju_sparse2dense(row, data.ten_J, model.ten_J_rownnz, model.ten_J_rowadr, model.ten_J_colind)
        return np.asarray(np.diag(model.dof_damping) + row.T @ (model.tendon_damping[:, None] * row))

    def force_at_velocity(change: NDArray[np.float64]) -> NDArray[np.float64]:
        data.qvel[:] = change
        return _force_here(model, data)

    damping = -_central_differences(force_at_velocity, model.nv)
    data.qvel[:] = 0.0
    return damping


def stiffness_matrix(
    model: mujoco.MjModel, data: mujoco.MjData, qpos: NDArray[np.float64], step: float = _STEP
) -> NDArray[np.float64]:
    """Change of the joint forces with position, sign turned, (nv, nv), at ``qpos`` (nq,), where it leaves ``data``.

    In closed form where that is known (:mod:`vgvt.simulation.tangent`), else by differences of a ``step`` to either
    side, m or rad.
    """
    data.qpos[:] = qpos
    closed = tangent_stiffness(model, data)
    if closed is not None:
        return closed
    resting = _without_modal_dampers(model)

    def force_at(change: NDArray[np.float64]) -> NDArray[np.float64]:
        data.qpos[:] = qpos + change
        return joint_force(resting, data)

    stiffness = -_central_differences(force_at, model.nv, step)
    data.qpos[:] = qpos
    return stiffness


def _without_modal_dampers(model: mujoco.MjModel) -> mujoco.MjModel:
    """The model, or a copy in which tendons over joints that only damp reach nothing: for forces at rest.

    MuJoCo adds such a tendon's joints to its row one by one, past all that are there: with 60 cells a wing the dampers
    of six modes are nine tenths of the work of a force, and at rest they do nothing.
    """
    over_joints = np.zeros(model.ntendon, dtype=bool)
    over_joints[model.tendon_num > 0] = (
        model.wrap_type[model.tendon_adr[model.tendon_num > 0]] == mujoco.mjtWrap.mjWRAP_JOINT
    )
    pushing = (model.tendon_stiffness != 0) | model.tendon_stiffnesspoly.any(axis=1)
    pushing[model.actuator_trnid[model.actuator_trntype == mujoco.mjtTrn.mjTRN_TENDON, 0]] = True
    idle = over_joints & ~pushing
    if not idle.any():
        return model
    resting = copy(model)
    resting.tendon_num[idle] = 0
    return resting


def site_row(
    model: mujoco.MjModel, data: mujoco.MjData, site: str, direction: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Row (nv,) of a site's displacement along a direction (3,) fixed to the site, at the position in ``data``."""
    site_id = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, site)
    jacobian = np.zeros((3, model.nv))
    mujoco.mj_jacSite(model, data, jacobian, None, site_id)
    turned: NDArray[np.float64] = data.site_xmat[site_id].reshape(3, 3) @ direction
    return turned @ jacobian


def at_rest_n(model: mujoco.MjModel, data: mujoco.MjData, least_n: float) -> float:
    """The force, N or N m, that may be left on a joint at rest: ``least_n``, or more where rounding leaves more.

    Of the weight, or of what the stiffest tendon makes of the coordinates. ``data`` is as :func:`joint_force` leaves
    it, without velocity.
    """
    weight = float(np.abs(data.qfrc_bias).max())
    apart = float(model.tendon_stiffness.max(initial=0.0) * np.abs(data.qpos).max())
    return max(least_n, _ROUNDING * weight, _CANCELLED * apart)


def settle(model: mujoco.MjModel, tolerance_n: float = 1e-9, iterations: int = 50) -> NDArray[np.float64]:
    """The stable static equilibrium (nq,) by Newton's method from the unloaded shape, or downhill from there.

    ``tolerance_n`` is left on the joints of an aircraft of 10 t or less; rounding leaves more on heavier ones.
    Raises RuntimeError, with the reason, where there is none nearby or the one
    found would turn over.
    """
    qpos = np.zeros(model.nq)
    data = mujoco.MjData(model)
    for k in range(iterations):
        force, rests, stiffness = _pushed(model, data, qpos, tolerance_n, k)
        if rests:
            if np.linalg.eigvalsh((stiffness + stiffness.T) / 2)[0] <= 0:
                break
            return qpos
        try:
            step = np.linalg.solve(stiffness, force)
        except np.linalg.LinAlgError:
            # A joint with play, within its gap: the weight moves it to one of its stops.
            held = _HARDLY_HELD * float(np.abs(np.diag(stiffness)).max())
            step = np.linalg.solve(stiffness + held * np.eye(model.nv), force)
        qpos = qpos + _cut(np.asarray(step, dtype=np.float64))
    return _settle_downhill(model, data, tolerance_n)


def _settle_downhill(model: mujoco.MjModel, data: mujoco.MjData, tolerance_n: float) -> NDArray[np.float64]:
    """What :func:`settle` gives, by steps that lose energy, each no longer than the forces push along it.

    Newton's own step leads to a balance, stable or not, and may lead over a gap and back for ever: what holds a joint
    at one of its stops is no measure of what the weight does between them.
    """
    qpos = np.zeros(model.nq)
    hinges = model.jnt_qposadr[model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE]
    for k in range(_DOWNHILL):
        force, rests, stiffness = _pushed(model, data, qpos, tolerance_n, k)
        values, shapes = np.linalg.eigh((stiffness + stiffness.T) / 2)
        if rests:
            if values[0] > 0:
                return qpos
            # Balanced: the least push to either side shows where it leads.
            step = shapes[:, 0] * (_PUSHED_OVER / np.abs(shapes[:, 0]).max())
        else:
            held = np.maximum(np.abs(values), _HARDLY_HELD * np.abs(values).max())
            step = _no_further(model, data, qpos, _cut(shapes @ ((shapes.T @ force) / held)))
        qpos = qpos + step
        if np.abs(qpos[hinges]).max(initial=0.0) > np.pi / 2:
            rests = True
            break
    if rests:
        raise RuntimeError("the hung aircraft would turn over")
    furthest = model.joint(model.dof_jntid[int(np.abs(qpos).argmax())]).name
    left = np.abs(force).max()
    raise RuntimeError(f"the hung aircraft finds no rest (force of {left:.2g} N left; {furthest!r} gives way furthest)")


def _pushed(
    model: mujoco.MjModel, data: mujoco.MjData, qpos: NDArray[np.float64], tolerance_n: float, k: int
) -> tuple[NDArray[np.float64], bool, NDArray[np.float64]]:
    """The force on the joints (nv,) at a position (nq,), whether they rest, and the stiffness there, in step ``k``."""
    data.qpos[:], data.qvel[:] = qpos, 0.0
    force = joint_force(model, data)
    rests = bool(np.abs(force).max() < at_rest_n(model, data, tolerance_n))
    return force, rests, stiffness_matrix(model, data, qpos, _STEP if k < _THROUGH else _BESIDE_A_STOP)


def _cut(step: NDArray[np.float64]) -> NDArray[np.float64]:
    """A step (nv,) of 0.2 m or rad at most: far from equilibrium the spring's geometry bends the path."""
    return step * min(1.0, 0.2 / max(float(np.abs(step).max()), 1e-300))


def _no_further(
    model: mujoco.MjModel, data: mujoco.MjData, qpos: NDArray[np.float64], step: NDArray[np.float64]
) -> NDArray[np.float64]:
    """A step (nv,) downhill from a position (nq,), no further than where the forces push back along it."""

    def pushes(share: float) -> bool:
        data.qpos[:] = qpos + share * step
        return bool(joint_force(model, data) @ step >= 0)

    if pushes(1.0):
        return step
    near, far = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = (near + far) / 2
        near, far = (middle, far) if pushes(middle) else (near, middle)
    return (near + far) / 2 * step


def _central_differences(
    function: Callable[[NDArray[np.float64]], NDArray[np.float64]], size: int, step: float = _STEP
) -> NDArray[np.float64]:
    changes = np.eye(size) * step
    return np.array([(function(change) - function(-change)) / (2 * step) for change in changes]).T
