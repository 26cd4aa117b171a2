"""What is set up by how the aircraft hangs, which is not known before it is at rest: directions and lengths.

Elements are given in aircraft axes of the unloaded shape, and an aircraft may hang nose down. What pushes along a part,
or turns about an axis of the body, goes with these.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.effects.elements import Element, GroundSpring, PointPair, RotationSpring, SuspensionCubic
from vgvt.simulation.contact_elements import Drive
from vgvt.simulation.seated_tendon import FAR_M

Array = NDArray[np.float64]
TRIMMED = (GroundSpring, RotationSpring, PointPair, SuspensionCubic)
"""Springs that are laid, or moved along, to where the aircraft hangs: at rest they carry nothing."""
AXES = {"roll": 0, "pitch": 1, "yaw": 2}
"""The axes of the body about which a rotation spring holds."""
# Of a rotation, what is none.
_NOTHING = 1e-12


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
    springs = trimmed(elements)
    if not springs:
        return
    model = turned_as_hung(spec, elements, drives, spec.compile(), qpos)
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_forward(model, data)
    for name in springs:
        length = float(data.ten_length[model.tendon(name).id])
        spec.tendon(name).springlength = [length, length]


def trimmed(elements: Iterable[tuple[str, Element]]) -> list[str]:
    """The names of tendons to trim once the aircraft is at rest."""
    return [name for name, element in elements if isinstance(element, TRIMMED)]


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
