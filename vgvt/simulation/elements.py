"""Builds the mechanical elements that effects add to the rig's MuJoCo model."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.effects.elements import (
    Absorber,
    BendTwist,
    Element,
    GroundSpring,
    HingedFlap,
    JointLaw,
    ModalDrag,
    MountCompliance,
    PointMass,
    PointPair,
    RattlingMass,
    Relaxation,
    RotationSpring,
    SuspensionCubic,
    SuspensionFrame,
    WarmUp,
)
from vgvt.effects.root_joint import one_law
from vgvt.scenario.mirror import part_name
from vgvt.simulation.airframe import AirframeParts
from vgvt.simulation.contact_elements import (
    Drive,
    add_mounts,
    add_point_pair,
    add_rattling_mass,
    add_suspension_cubic,
)
from vgvt.simulation.coupled_elements import (
    add_bend_twist,
    add_hinged_flap,
    add_suspension_frame,
    drive_by_frame,
    load_frame,
)
from vgvt.simulation.damping import MODAL_DAMPING
from vgvt.simulation.halves import pitched_by
from vgvt.simulation.relaxation_elements import add_relaxations, add_warm_up, warm_springs
from vgvt.simulation.rig import add_point_mass
from vgvt.simulation.seated_tendon import FAR_M, WORLD, reach

# MuJoCo's default friction sticks with a time constant of 20 ms and creeps: 14 % too little loss in a 10 Hz cycle.
# As fast as the step allows (it raises this to two steps) and as hard as it can be, it is Coulomb's to 1e-4.
_AT_ONCE_S, _RIGID = 1e-9, 0.9999


def add_elements(
    spec: mujoco.MjSpec, parts: AirframeParts, elements: Iterable[tuple[str, Element]], drives: Sequence[Drive] = ()
) -> None:
    """Add elements to ``spec``, each under a unique name; in which order they come changes nothing.

    ``drives`` is where each exciter pushes: what is between one and the aircraft asks for it. What several say of a
    joint is one law; what relaxes beside the airframe's modes asks for these when all that is elastic is there, and
    nothing yet that relaxes; what softens springs takes in those that others bring. InputError for a joint that is
    not there.
    """
    named = list(elements)
    for name, element in named:
        if not isinstance(element, Relaxation | MountCompliance | JointLaw):
            _add(spec, parts, drives, name, element)
    for name, law in _joint_laws(parts, named):
        _add_joint_law(spec, name, law)
    add_mounts(spec, drives, [(name, element) for name, element in named if isinstance(element, MountCompliance)])
    add_relaxations(spec, parts, [(name, element) for name, element in named if isinstance(element, Relaxation)])
    if any(element.owner == "airframe" for _, element in named):
        warm_springs(spec, parts)


def sharing(parts: AirframeParts, mass: PointMass) -> tuple[tuple[str, float], ...]:
    """The rigid bodies that share a mass, and their fractions: an airframe's as its items do, the rig's by one."""
    position = np.array(mass.position_m)
    if mass.owner == "airframe":
        return parts.shares(mass.part, position)
    return ((parts.carrier(mass.part, position), 1.0),)


def _add(spec: mujoco.MjSpec, parts: AirframeParts, drives: Sequence[Drive], name: str, element: Element) -> None:
    """Add one element."""
    adders: dict[type, Callable[..., None]] = {
        PointMass: _add_mass,
        GroundSpring: _add_ground_spring,
        RotationSpring: partial(_add_rotation_spring, drives),
        Absorber: _add_absorber,
        ModalDrag: _add_modal_drag,
        SuspensionFrame: add_suspension_frame,
        SuspensionCubic: add_suspension_cubic,
        BendTwist: add_bend_twist,
        HingedFlap: add_hinged_flap,
        PointPair: add_point_pair,
        RattlingMass: add_rattling_mass,
        WarmUp: add_warm_up,
    }
    adders[type(element)](spec, parts, name, element)


def _add_mass(spec: mujoco.MjSpec, parts: AirframeParts, name: str, element: PointMass) -> None:
    position = np.array(element.position_m)
    for k, (carrier, share) in enumerate(sharing(parts, element)):
        shared = name if k == 0 else f"{name}-{k + 1}"
        add_point_mass(spec, parts, shared, carrier, position, share * element.mass_kg)
    if element.frame_kg > 0:
        load_frame(spec, spec.body(name), element.frame_kg)


def _add_ground_spring(spec: mujoco.MjSpec, parts: AirframeParts, name: str, element: GroundSpring) -> None:
    direction = np.array(element.direction) / np.linalg.norm(element.direction)
    rod = spec.add_tendon(
        name=name,
        stiffness=[element.stiffness_n_per_m, 0.0, 0.0],
        damping=[element.damping_n_s_per_m, 0.0, 0.0],
    )
    reach(rod, spec, parts, name, (element.part, element.position_m), (WORLD, FAR_M * direction))


def _add_rotation_spring(
    drives: Sequence[Drive], spec: mujoco.MjSpec, parts: AirframeParts, name: str, element: RotationSpring
) -> None:
    del parts
    rod = spec.add_tendon(
        name=name,
        stiffness=[element.stiffness_n_m_per_rad, 0.0, 0.0],
        damping=[element.damping_n_m_s_per_rad, 0.0, 0.0],
    )
    # As the aircraft hangs others turn the body, too: that is known when it does.
    for joint in (element.axis, *(pitched_by(drives[element.exciter].carrier) if element.axis == "pitch" else ())):
        rod.wrap_joint(joint, 1.0)


def _add_absorber(spec: mujoco.MjSpec, parts: AirframeParts, name: str, element: Absorber) -> None:
    position = np.array(element.position_m)
    carrier = parts.carrier(element.part, position)
    add_point_mass(spec, parts, name, carrier, position, element.mass_kg)
    _slide(
        spec.body(name),
        f"{name}/{element.kind}",
        np.array(element.direction),
        element.stiffness_n_per_m,
        element.damping_n_s_per_m,
    )
    if element.frame_share != 0:
        drive_by_frame(spec, spec.joint(f"{name}/{element.kind}"), element.frame_share)


def _slide(
    body: mujoco.MjsBody, name: str, direction: NDArray[np.float64], stiffness_n_per_m: float, damping_n_s_per_m: float
) -> None:
    body.add_joint(
        name=name,
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=direction,
        stiffness=[stiffness_n_per_m, 0.0, 0.0],
        damping=[damping_n_s_per_m, 0.0, 0.0],
    )


def _add_modal_drag(spec: mujoco.MjSpec, parts: AirframeParts, name: str, element: ModalDrag) -> None:
    del parts, name
    for tendon in spec.tendons:
        if tendon.name.startswith(MODAL_DAMPING):
            tendon.damping = [tendon.damping[0], tendon.damping[1] + element.drag_per_rtkg_m, 0.0]


def _joint_laws(parts: AirframeParts, elements: Iterable[tuple[str, Element]]) -> list[tuple[str, JointLaw]]:
    """The law of every joint that has one, for a beam as it is called in the model, by the first of its names."""
    said: dict[tuple[str, str], list[tuple[str, JointLaw]]] = {}
    for name, law in elements:
        if isinstance(law, JointLaw):
            law = replace(law, beam=part_name(parts.airframe, law.beam, 1.0))
            said.setdefault((law.beam, law.kind), []).append((name, law))
    return [(laws[0][0], one_law([law for _, law in laws])) for laws in said.values()]


def _add_joint_law(spec: mujoco.MjSpec, name: str, element: JointLaw) -> None:
    joint: Any = spec.joint(f"{element.beam}-root/{element.kind}")
    if joint is None:
        raise InputError(
            f"effect on beam {element.beam}",
            f"the beam has no {element.kind} spring at its root",
            f"Give the beam a root_{element.kind}_stiffness_n_m_per_rad (torsion: root_torsional_…).",
        )
    joint.stiffness = [element.stiffness_n_m_per_rad, 0.0, element.cubic_n_m_per_rad3]
    if element.friction_n_m > 0:
        joint.frictionloss = element.friction_n_m
        joint.solref_friction = [_AT_ONCE_S, 1.0]
        joint.solimp_friction = [_RIGID, _RIGID, 1e-3, 0.5, 2.0]
        spec.option.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    if element.play_rad > 0:
        joint.stiffness = [0.0, 0.0, 0.0]
        tendon = spec.add_tendon(
            name=name,
            stiffness=[element.stiffness_n_m_per_rad, 0.0, element.cubic_n_m_per_rad3],
            springlength=[-element.play_rad, element.play_rad],
        )
        tendon.wrap_joint(joint.name, 1.0)
