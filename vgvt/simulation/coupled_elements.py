"""Elements of more than one joint or with a body of their own: the suspension's frame, bend-twist coupling, flaps.

Their joints are named NAME/frame and NAME/flap, so that modes in which they hold
the energy carry that name.
"""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.effects.elements import BendTwist, HingedFlap, SuspensionFrame
from vgvt.simulation.airframe import AirframeParts
from vgvt.simulation.rig import FRAME_SITE, GRAVITY_M_PER_S2

# What couplings leave on the model for those of the same beam that come after them.
_COUPLED = "/bend-twist"
# Radius of gyration of a lump whose inertia is not stated: MuJoCo needs one.
_SMALL_M = 1e-3


def add_suspension_frame(spec: mujoco.MjSpec, parts: AirframeParts, name: str, element: SuspensionFrame) -> None:
    """Move the upper end of the hung aircraft's spring onto a mass that slides up and down.

    InputError where it is on one already.
    """
    del parts
    if _suspension_frame(spec) is not None:
        raise InputError(
            "effects on the suspension's frame",
            "two of them let it move, and the spring has one upper end",
            "Keep one frame-resonance.",
        )
    site = spec.site(FRAME_SITE)
    top = np.array(site.pos)
    # The spring refers to its end by name: give the name to a site on the frame.
    site.name = f"{name}/ground"
    body = spec.worldbody.add_body(name=name, pos=top, gravcomp=1.0)
    body.add_joint(
        name=f"{name}/frame",
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=(0.0, 0.0, 1.0),
        stiffness=[element.stiffness_n_per_m, 0.0, 0.0],
        damping=[element.damping_n_s_per_m, 0.0, 0.0],
    )
    _set_inertial(body, element.mass_kg, np.zeros(3), np.zeros(3))
    body.add_site(name=FRAME_SITE)
    for joint in [j for j in spec.joints if len(j.userdata)]:
        drive_by_frame(spec, joint, joint.userdata[0])
    for lump in [b for b in spec.bodies if len(b.userdata)]:
        load_frame(spec, lump, lump.userdata[0])


def drive_by_frame(spec: mujoco.MjSpec, joint: mujoco.MjsJoint, share: float) -> None:
    """Let spring and dashpot of a slide act on its motion less ``share`` of what the suspension's frame rises by.

    A frame that comes later finds the share on the joint.
    """
    joint.userdata = [share]
    frame = _suspension_frame(spec)
    if frame is not None:
        spring = spec.add_tendon(name=joint.name, stiffness=list(joint.stiffness), damping=list(joint.damping))
        spring.wrap_joint(joint.name, 1.0)
        spring.wrap_joint(frame.joints[0].name, -share)
        joint.stiffness = joint.damping = [0.0, 0.0, 0.0]


def load_frame(spec: mujoco.MjSpec, lump: mujoco.MjsBody, mass_kg: float) -> None:
    """Let mass ride on the suspension's frame. A frame that comes later finds it on the ``lump`` it belongs to."""
    lump.userdata = [mass_kg]
    frame = _suspension_frame(spec)
    if frame is not None:
        frame.mass += mass_kg


def _suspension_frame(spec: mujoco.MjSpec) -> mujoco.MjsBody | None:
    """What the hung aircraft's spring hangs from, where that moves."""
    holder = spec.site(FRAME_SITE).parent
    return holder if holder.joints else None


def add_bend_twist(spec: mujoco.MjSpec, parts: AirframeParts, name: str, element: BendTwist) -> None:
    """Couple each cell's bending and torsion hinge by a fixed tendon, at unchanged EI and GJ.

    A tendon of stiffness |κ| over sqrt(k_b) θ_b ± sqrt(k_t) θ_t adds κ sqrt(k_b k_t) off the
    diagonal and |κ| k_b, |κ| k_t on it; the hinges give those back. Several couplings of a beam add up, each
    by the hinges as the beam was cut; InputError where their sum leaves no positive strain energy.
    """
    chain = parts.chains[element.beam]
    size = abs(element.coupling)
    note = f"{element.beam}{_COUPLED}"
    coupled = spec.numeric(note) or spec.add_numeric(name=note, data=[0.0])
    coupled.data = [float(coupled.data[0]) + element.coupling]
    if abs(coupled.data[0]) >= 1:
        raise InputError(
            f"effects that couple bending and torsion of {element.beam}",
            f"their couplings are {coupled.data[0]:g} together, and the beam would be unstable",
            "Keep the sum between -1 and 1.",
        )
    for link in chain.links:
        own = {hinge.kind: hinge.stiffness_n_m_per_rad for hinge in link.hinges}
        if {"bending", "torsion"} > set(own) or link.name.endswith("-root"):
            continue
        tangent, normal, aft = chain.table.frame(link.start_arc_m)
        # Torsion turns about the outboard axis, which is leading edge up on one side and down on the other.
        up = -np.sign(np.cross(tangent, aft) @ normal)
        tendon = spec.add_tendon(name=f"{name}-{link.name}", stiffness=[size, 0.0, 0.0])
        for kind, way in (("bending", 1.0), ("torsion", float(-up * np.sign(element.coupling)))):
            joint = spec.joint(f"{link.name}/{kind}")
            tendon.wrap_joint(joint.name, way * float(np.sqrt(own[kind])))
            joint.stiffness = [float(joint.stiffness[0]) - size * own[kind], 0.0, 0.0]


def add_hinged_flap(spec: mujoco.MjSpec, parts: AirframeParts, name: str, element: HingedFlap) -> None:
    """A rigid flap on a hinge of the link that carries it, trimmed as of an aircraft that hangs level.

    With play the spring is a tendon with a dead band. What hangs otherwise is trimmed when it is known how
    (:mod:`vgvt.simulation.as_hung`).
    """
    hinge = np.array(element.hinge_m)
    carrier = parts.carrier(element.part, hinge)
    arm = np.array(element.centre_of_gravity_m) - hinge
    axis = np.array(element.hinge_axis) / np.linalg.norm(element.hinge_axis)
    weight = np.array([0.0, 0.0, -GRAVITY_M_PER_S2 * element.mass_kg])
    body = spec.body(carrier).add_body(name=name, pos=hinge - parts.origin_m[carrier])
    reference, ends = linkage_rad(element, float(axis @ np.cross(arm, weight)))
    body.add_joint(
        name=f"{name}/flap",
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=axis,
        stiffness=[0.0 if element.gap_rad > 0 else element.stiffness_n_m_per_rad, 0.0, 0.0],
        damping=[element.damping_n_m_s_per_rad, 0.0, 0.0],
        springref=reference,
    )
    if element.gap_rad > 0:
        linkage = spec.add_tendon(
            name=name, stiffness=[element.stiffness_n_m_per_rad, 0.0, 0.0], springlength=list(ends)
        )
        linkage.wrap_joint(f"{name}/flap", 1.0)
    _set_inertial(body, element.mass_kg, arm, np.array(element.inertia_kg_m2))


def linkage_rad(flap: HingedFlap, weight_n_m: float, at_rad: float = 0.0) -> tuple[float, tuple[float, float]]:
    """The angle at which a flap's spring is unloaded, rad, and between which two it gives no force where it has play.

    So that it carries ``weight_n_m`` about the hinge ``at_rad``. Leant on by the weight, so on its far side: the free
    way lies beyond the unloaded angle, seen from there.
    """
    turned = -weight_n_m / flap.stiffness_n_m_per_rad
    unloaded = at_rad + turned
    low, high = sorted((unloaded, unloaded + float(np.copysign(flap.gap_rad, turned))))
    return unloaded, (low, high)


def _set_inertial(
    body: mujoco.MjsBody, mass_kg: float, centre_m: NDArray[np.float64], inertia_kg_m2: NDArray[np.float64]
) -> None:
    body.explicitinertial = True
    body.mass = mass_kg
    body.ipos = centre_m
    body.inertia = np.maximum(inertia_kg_m2, mass_kg * _SMALL_M**2)
