"""The equilibrium of a rig next to one that is known: Newton's method whose stiffness is kept while it leads there."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.simulation.linear import at_rest_n, joint_force
from vgvt.simulation.tangent import tangent_stiffness

Array = NDArray[np.float64]
_AT_REST_N = 1e-8
# Of a coordinate at once: farther from the equilibrium the spring's geometry bends the path.
_LONGEST_STEP, _MOST_STEPS = 0.2, 60
# A stiffness, dear to find, serves for so many steps, and no longer than each leaves at most this share of the force.
_SERVES, _CONTRACTING = 8, 0.5
_STEP = 1e-5
# Of a coordinate, m or rad: an aircraft that would turn over finds a rest, too, beyond the vertical.
_NOT_NEAR = np.pi / 2


def settle_near(model: mujoco.MjModel, start: Array, softness: Array | None) -> Array | None:
    """The stable equilibrium (nq,) from a guess (nq,); None where no way leads from there to one nearby.

    ``softness`` (nv, nv) is the inverse stiffness of something stable near the guess, where it is known.
    """
    data = mujoco.MjData(model)
    qpos, inverse, used, before, own = start.copy(), softness, 0, np.inf, False
    for _ in range(_MOST_STEPS):
        data.qpos[:], data.qvel[:] = qpos, 0.0
        force = joint_force(model, data)
        left = float(np.abs(force).max())
        if left < at_rest_n(model, data, _AT_REST_N):
            # Steps of a stable neighbour's softness come to rest only where it is stable, too.
            stable = not own or inverse is None or _stable(inverse)
            return qpos if stable and np.abs(qpos - start).max() < _NOT_NEAR else None
        if not np.isfinite(left):
            return None
        if inverse is None or used >= _SERVES or left > _CONTRACTING * before:
            try:
                inverse, used, own = _softness(model, data, qpos, force), 0, True
            except np.linalg.LinAlgError:
                # A joint with play, within its gap: nothing holds it.
                return None
        move = inverse @ force
        share = min(1.0, _LONGEST_STEP / max(float(np.abs(move).max()), 1e-300))
        # A step that was cut short says nothing of where the whole one leads.
        before = left if share == 1.0 else np.inf
        qpos, used = qpos + share * move, used + 1
    return None


def _stable(softness: Array) -> bool:
    """Whether an inverse stiffness (nv, nv) gives way to any force in its own direction."""
    try:
        np.linalg.cholesky((softness + softness.T) / 2)
    except np.linalg.LinAlgError:
        return False
    return True


def _softness(model: mujoco.MjModel, data: mujoco.MjData, qpos: Array, force: Array) -> Array:
    """Inverse stiffness (nv, nv) at a position (nq,), where joints are pushed by a force (nv,)."""
    data.qpos[:] = qpos
    closed = tangent_stiffness(model, data)
    if closed is not None:
        return np.asarray(np.linalg.inv(closed))
    columns = []
    for change in np.eye(model.nv) * _STEP:
        data.qpos[:] = qpos + change
        columns.append((joint_force(model, data) - force) / _STEP)
    return np.asarray(np.linalg.inv(-np.array(columns).T))
