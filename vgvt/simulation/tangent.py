"""The tangent stiffness of a model at rest in closed form: what its springs, its tendons' tension and its weight hold.

Joints are slides and hinges. A coordinate that lies further in moves a point by v; a hinge a further out turns that by
a × v, and no slide does: of every pair of coordinates on one path to the root, that is the point's second derivative.
With it the weight's potential, and the length of a tendon between points, have second derivatives as exact as their
first ones, for the price of one of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_JOINT, _PULLEY, _SITE = (
    int(w) for w in (mujoco.mjtWrap.mjWRAP_JOINT, mujoco.mjtWrap.mjWRAP_PULLEY, mujoco.mjtWrap.mjWRAP_SITE)
)
_NEEDED = int(mujoco.mjtDisableBit.mjDSBL_SPRING) | int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
_SLIDE, _HINGE = int(mujoco.mjtJoint.mjJNT_SLIDE), int(mujoco.mjtJoint.mjJNT_HINGE)


def tangent_stiffness(model: mujoco.MjModel, data: mujoco.MjData) -> Array | None:
    """Change of the joint forces with position, sign turned, (nv, nv), at the position in ``data``, without velocity.

    ``data`` is brought up to date there, but for its forces. At the very end of a tendon's play it is that of the side
    on which it does nothing. None for what this does not know: ball joints, tendons around bodies or without length,
    actuators that push, wind, flexible bodies, springs or weight that are switched off, and anything that moves.
    """
    if not _known(model, data):
        return None
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_tendon(model, data)
    outer = _outer(model.dof_parentid.tobytes())
    turning = (model.jnt_type == _HINGE)[:, None] * data.xaxis
    found = _mirrored(_weight(model, data, outer, turning), outer)
    found[np.diag_indices_from(found)] += _of_spring(
        data.qpos - model.qpos_spring, model.jnt_stiffness, model.jnt_stiffnesspoly
    )[1]
    tension, rate = _pulls(model, data.ten_length)
    for tendon in np.flatnonzero((tension != 0) | (rate != 0)):
        first = model.tendon_adr[tendon]
        wraps = range(first, first + model.tendon_num[tendon])
        if model.wrap_type[first] == _JOINT:
            row = np.zeros(model.nv)
            np.add.at(row, model.jnt_dofadr[model.wrap_objid[wraps]], model.wrap_prm[wraps])
            found += rate[tendon] * np.outer(row, row)
        else:
            pull = float(tension[tendon]), float(rate[tendon])
            bent = _of_path(model, data, list(_segments(model, wraps)), pull, (outer, turning))
            if bent is None:
                return None
            found += bent
    return found


def _known(model: mujoco.MjModel, data: mujoco.MjData) -> bool:
    """Whether all that pushes joints at rest is what :func:`tangent_stiffness` asks about."""
    straight = model.jnt_type.min(initial=_SLIDE) >= _SLIDE and model.wrap_type.max(initial=_SITE) <= _SITE
    usual = not model.opt.disableflags & _NEEDED
    still = not data.qvel.any() and not (model.opt.wind.any() and (model.opt.density or model.opt.viscosity))
    stiff = not model.nflex and not model.nplugin
    return bool(straight and usual and still and stiff and not _pushed(model, data))


def _pushed(model: mujoco.MjModel, data: mujoco.MjData) -> bool:
    """Whether an actuator may push at rest: by what it is told, by its bias, or as no force is beyond its limits."""
    if data.act.any() or data.ctrl.any() or model.jnt_actgravcomp.any():
        return True
    if not model.nu:
        return False
    told = model.actuator_ctrllimited.astype(bool) & (model.actuator_actnum == 0)
    limits = (
        (told, model.actuator_ctrlrange), (model.actuator_forcelimited, model.actuator_forcerange),
        (model.jnt_actfrclimited, model.jnt_actfrcrange), (model.tendon_actfrclimited, model.tendon_actfrcrange),
    )  # fmt: skip
    beyond = any((on.astype(bool) & ((r[:, 0] > 0) | (r[:, 1] < 0))).any() for on, r in limits)
    return bool(beyond or (model.actuator_biastype != mujoco.mjtBias.mjBIAS_NONE).any())


@lru_cache(maxsize=64)
def _outer(parents: bytes) -> Array:
    """1 where the coordinate of a row moves what that of a column (nv, nv) moves, itself included, else 0.

    ``parents`` (nv,) are the coordinates next further out, -1 without any.
    """
    known = np.frombuffer(parents, dtype=np.int32)
    outer = np.eye(known.size)
    for k, parent in enumerate(known):
        if parent >= 0:
            outer[:, k] += outer[:, parent]
    outer.setflags(write=False)
    return outer


def _mirrored(half: Array, outer: Array) -> Array:
    """Second derivatives (nv, nv) of which ``half`` has those by an outer coordinate, then by an inner one."""
    half = half * outer
    return np.asarray(half + half.T - np.diag(np.diag(half)))


def _weight(model: mujoco.MjModel, data: mujoco.MjData, outer: Array, turning: Array) -> Array:
    """Second derivatives (nv, nv), by an outer coordinate and an inner one, of the weight's potential.

    ``turning`` (nv, 3) are the axes of hinges, zero for slides.
    """
    # Of all that a coordinate moves: its mass, and that times where it is.
    weld = model.body_weldid
    moved = model.body_dofnum[weld] > 0
    last = model.body_dofadr[weld[moved]] + model.body_dofnum[weld[moved]] - 1
    heavy = model.body_mass[moved] * (1 - model.body_gravcomp[moved])
    carried = outer[:, last] @ np.column_stack([heavy, heavy[:, None] * data.xipos[moved]])
    mass = carried[:, :1]
    inner = mass * (data.xaxis - turning) + _cross(turning, carried[:, 1:] - mass * data.xanchor)
    return np.asarray(_cross(turning, model.opt.gravity) @ inner.T)


def _cross(one: Array, other: Array) -> Array:
    """one × other (..., 3): NumPy's own takes longer over shapes than over a few dozen vectors."""
    (a, b, c), (x, y, z) = one.T, other.T
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=-1)


def _of_spring(stretch: Array, linear: Array, higher: Array) -> tuple[Array, Array]:
    """Force (n,) and its change with the ``stretch`` (n,), of springs with higher powers' coefficients (n, 2)."""
    square, cube = higher.T
    force = stretch * (linear + stretch * (square + stretch * cube))
    return force, linear + stretch * (2 * square + stretch * 3 * cube)


def _pulls(model: mujoco.MjModel, length: Array) -> tuple[Array, Array]:
    """The force (tendons,) by which each pulls at its ends, and its change with its length."""
    low, high = model.tendon_lengthspring.T
    slack = (low < high) & (low <= length) & (length <= high)
    stretch = np.minimum(length - low, 0.0) + np.maximum(length - high, 0.0)
    force, rate = _of_spring(stretch, model.tendon_stiffness, model.tendon_stiffnesspoly)
    return force, np.where(slack, 0.0, rate)


def _segments(model: mujoco.MjModel, wraps: range) -> Iterator[tuple[int, int, float]]:
    """Pairs of sites that a tendon runs straight between, each with its share of the length."""
    before, share = -1, 1.0
    for wrap in wraps:
        if model.wrap_type[wrap] == _PULLEY:
            before, share = -1, 1.0 / model.wrap_prm[wrap]
        else:
            site = int(model.wrap_objid[wrap])
            if before >= 0:
                yield before, site, share
            before = site


def _of_path(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    segments: list[tuple[int, int, float]],
    pull: tuple[float, float],
    chain: tuple[Array, Array],
) -> Array | None:
    """What a tendon along ``segments`` adds (nv, nv), by its ``pull`` (force, change with length).

    None where two sites lie in one point: it has no direction there. ``chain`` are the coordinates that are outer
    (nv, nv) and the axes (nv, 3) about which they turn.
    """
    (tension, rate), (outer, turning) = pull, chain
    whole, bent = np.zeros(model.nv), np.zeros((model.nv, model.nv))
    for one, other, share in segments:
        ends = np.zeros((2, 3, model.nv))
        for end, site in zip(ends, (one, other), strict=True):
            mujoco.mj_jacSite(model, data, end, None, site)
        apart, moved = data.site_xpos[other] - data.site_xpos[one], ends[1] - ends[0]
        length = float(np.linalg.norm(apart))
        if length < mujoco.mjMINVAL:
            return None
        along = apart / length
        stretched = along @ moved
        whole += share * stretched
        across = moved.T @ moved - np.outer(stretched, stretched)
        bent += share * (across / length + _mirrored(_cross(-turning, along) @ moved, outer))
    return np.asarray(rate * np.outer(whole, whole) + tension * bent)
