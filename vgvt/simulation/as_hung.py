"""What is set up by how the aircraft hangs, which is not known before it is at rest: directions and lengths.

Elements are given in aircraft axes of the unloaded shape, and an aircraft may hang nose down. What pushes along a part,
or turns about an axis of the body, goes with these.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from copy import copy

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.effects.elements import Element, GroundSpring, HingedFlap, PointPair, RotationSpring, SuspensionCubic
from vgvt.simulation.contact_elements import Drive
from vgvt.simulation.coupled_elements import linkage_rad
from vgvt.simulation.linear import stiffness_matrix
from vgvt.simulation.rig import GRAVITY_M_PER_S2
from vgvt.simulation.seated_tendon import FAR_M

Array = NDArray[np.float64]
TRIMMED = (GroundSpring, RotationSpring, PointPair, SuspensionCubic)
"""Springs that are laid, or moved along, to where the aircraft hangs: at rest they carry nothing."""
AXES = {"roll": 0, "pitch": 1, "yaw": 2}
"""The axes of the body about which a rotation spring holds."""
# Of a rotation, what is none.
_NOTHING = 1e-12
# What a flap's weight turns it by while rest is looked for, rad: as good as nothing, and no spring too stiff to solve.
_GIVES_RAD = 1e-6


def rest_as_hung(
    model: mujoco.MjModel, elements: Sequence[tuple[str, Element]], find: Callable[[mujoco.MjModel], Array]
) -> Array:
    """The equilibrium (nq,) that ``find`` finds of a model, with whatever is trimmed to it: that leaves it there.

    Springs that are put on last hold nothing, and flaps are held where they are. RuntimeError where ``find`` raises
    it, and where a flap would fall over its hinge.
    """
    loose, flaps = copy(model), _flaps(elements)
    for name in trimmed(elements):
        loose.tendon_stiffness[loose.tendon(name).id] = 0.0
    if not flaps:
        return find(loose)
    qpos = find(_holding(loose, flaps))
    stiffness = stiffness_matrix(loose, trim(loose, flaps, qpos), qpos)
    if np.linalg.eigvalsh((stiffness + stiffness.T) / 2)[0] <= 0:
        raise RuntimeError("a control surface would fall over its hinge")
    return qpos


def _holding(model: mujoco.MjModel, flaps: Iterable[tuple[str, HingedFlap]]) -> mujoco.MjModel:
    """A copy of a model in which flaps give way to their weight by next to nothing."""
    held = copy(model)
    for name, flap in flaps:
        hinge, arm_m = held.joint(f"{name}/flap").id, np.subtract(flap.centre_of_gravity_m, flap.hinge_m)
        heavy_n_m = flap.mass_kg * GRAVITY_M_PER_S2 * float(np.linalg.norm(arm_m))
        held.jnt_stiffness[hinge] = heavy_n_m / _GIVES_RAD
        held.qpos_spring[held.jnt_qposadr[hinge]] = 0.0
        if flap.gap_rad > 0:
            held.tendon_stiffness[held.tendon(name).id] = 0.0
    return held


def turned_as_hung(
    spec: mujoco.MjSpec,
    elements: Iterable[tuple[str, Element]],
    drives: Sequence[Drive],
    model: mujoco.MjModel,
    qpos: Array,
) -> mujoco.MjModel:
    """Turn in ``spec`` what follows from the attitude at rest, ``qpos`` (nq,) of its ``model``; the model of it then.

    That model itself where nothing does. All of it is trimmed to that rest, and leaves it where it is.
    """
    following = [
        (name, element)
        for name, element in elements
        if isinstance(element, RotationSpring) or (isinstance(element, GroundSpring) and element.turns_with_part)
    ]
    if not following:
        return model
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_forward(model, data)
    for name, element in following:
        if isinstance(element, GroundSpring):
            _turn_far_ends(spec, data, name, element)
        else:
            _hold_rotation(spec, model, data, name, element, drives[element.exciter].carrier)
    return spec.compile()


def laid_as_hung(
    spec: mujoco.MjSpec, elements: Sequence[tuple[str, Element]], drives: Sequence[Drive], qpos: Array
) -> None:
    """Turn what follows from the equilibrium ``qpos`` (nq,), and give springs the rest length that they have there."""
    springs, flaps = trimmed(elements), _flaps(elements)
    if not (springs or flaps):
        return
    model = turned_as_hung(spec, elements, drives, spec.compile(), qpos)
    trim(model, elements, qpos)
    for name, flap in flaps:
        hinge = f"{name}/flap"
        spec.joint(hinge).springref = float(model.qpos_spring[model.joint(hinge).qposadr[0]])
        springs += [name] if flap.gap_rad > 0 else []
    for name in springs:
        spec.tendon(name).springlength = model.tendon_lengthspring[model.tendon(name).id].tolist()


def trim(model: mujoco.MjModel, elements: Iterable[tuple[str, Element]], qpos: Array) -> mujoco.MjData:
    """The state at rest at ``qpos`` (nq,), after the model's springs were given what they hold there, which is nothing.

    And flaps' what carries their weight.
    """
    named, data = list(elements), mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_forward(model, data)
    for name in trimmed(named):
        rod = model.tendon(name).id
        model.tendon_lengthspring[rod] = data.ten_length[rod]
    for name, flap in _flaps(named):
        hinge = model.joint(f"{name}/flap").id
        weight_n_m = -float(data.qfrc_bias[model.jnt_dofadr[hinge]])
        place = model.jnt_qposadr[hinge]
        reference, ends = linkage_rad(flap, weight_n_m, float(qpos[place]))
        model.qpos_spring[place] = reference
        if flap.gap_rad > 0:
            model.tendon_lengthspring[model.tendon(name).id] = ends
    return data


def trimmed(elements: Iterable[tuple[str, Element]]) -> list[str]:
    """The names of tendons to trim once the aircraft is at rest."""
    return [name for name, element in elements if isinstance(element, TRIMMED)]


def _flaps(elements: Iterable[tuple[str, Element]]) -> list[tuple[str, HingedFlap]]:
    return [(name, element) for name, element in elements if isinstance(element, HingedFlap)]


def _turn_far_ends(spec: mujoco.MjSpec, data: mujoco.MjData, name: str, element: GroundSpring) -> None:
    """Move the far ends of a tendon to where they are along a direction of the part."""
    direction = np.array(element.direction) / np.linalg.norm(element.direction)
    k = 0
    while (far := spec.site(f"{name}/far-{k}")) is not None:
        near = data.site(f"{name}/near-{k}")
        far.pos = near.xpos + FAR_M * near.xmat.reshape(3, 3) @ direction
        k += 1


def _hold_rotation(
    spec: mujoco.MjSpec, model: mujoco.MjModel, data: mujoco.MjData, name: str, element: RotationSpring, carrier: str
) -> None:
    """Lay a tendon over the joints that turn a rigid body about its axis, each by how much it does.

    Of an aircraft that hangs nose down yaw, which is about the vertical, is a part of roll.
    """
    turned = np.zeros((3, model.nv))
    body = model.body(carrier)
    mujoco.mj_jacBody(model, data, None, turned, body.id)
    row = (data.body(carrier).xmat.reshape(3, 3).T @ turned)[AXES[element.axis]]
    old = spec.tendon(name)
    rod_stiffness, rod_damping = list(old.stiffness), list(old.damping)
    spec.delete(old)
    rod = spec.add_tendon(name=name, stiffness=rod_stiffness, damping=rod_damping)
    for dof in np.flatnonzero(np.abs(row) > _NOTHING):
        rod.wrap_joint(model.joint(int(model.dof_jntid[dof])).name, float(row[dof]))
