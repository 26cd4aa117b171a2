"""Elements that touch or tie: one-sided springs as tendons with a dead band, and a spring between two points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.effects.elements import MountCompliance, PointPair, RattlingMass, SuspensionCubic
from vgvt.simulation.airframe import ROOT, AirframeParts
from vgvt.simulation.rig import FRAME_SITE, GRAVITY_M_PER_S2, HOOK_SITE, TRANSDUCER, add_point_mass, numbered
from vgvt.simulation.seated_tendon import reach

# Far enough that a spring along a line keeps its direction; longer than any stretch for an open side.
_FAR_M = 1000.0
_UP = np.array([0.0, 0.0, 1.0])
# By this what gives in series with others gives late: 0.3 degrees at 35 Hz, and no motion faster than 40 000 rad/s.
_LATE_S = 2.5e-5


class Drive(Protocol):
    """Where an exciter pushes: on which rigid body, and along which axis (3,) of it."""

    @property
    def carrier(self) -> str:
        """Name of the rigid body."""

    @property
    def axis(self) -> NDArray[np.float64]:
        """The axis (3,), of unit length."""


def add_mounts(spec: mujoco.MjSpec, drives: Sequence[Drive], mounts: Sequence[tuple[str, MountCompliance]]) -> None:
    """Let every transducer slide along its push on what it is mounted by, one joint for each thing that gives.

    Joints of one transducer are in series and have nothing between them to accelerate: a motion of one against
    another would have no inertia, and the model no inverse. Each is given some that counts for that motion alone, and
    weighs nothing: with T (c + T k) the law k + c s errs by ωT of itself, and nothing is faster than 1/T.
    """
    for name, element in mounts:
        axis = drives[element.exciter].axis
        joint = (
            _add_mount_with_play(spec, name, element, axis) if element.gap_m else _add_mount(spec, name, element, axis)
        )
        if sum(other.exciter == element.exciter for _, other in mounts) > 1:
            joint.armature = _LATE_S * (element.damping_n_s_per_m + _LATE_S * element.stiffness_n_per_m)


def _add_mount(spec: mujoco.MjSpec, name: str, element: MountCompliance, axis: NDArray[np.float64]) -> mujoco.MjsJoint:
    """A mount without play; up is compression.

    The law k x, with the slope ratio · k where the pull exceeds the preload, is a plain spring of that slope and
    a one-sided one for the rest; the plain one's rest length takes the offset of the latter's corner.
    """
    stiffness, ratio = element.stiffness_n_per_m, element.tension_ratio
    corner = -element.preload_n / stiffness
    joint = spec.body(numbered(TRANSDUCER, element.exciter)).add_joint(
        name=name,
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=axis,
        stiffness=[ratio * stiffness, 0.0, 0.0],
        springref=(ratio - 1) * corner / ratio,
        damping=[element.damping_n_s_per_m, 0.0, 0.0],
    )
    if ratio != 1.0:
        one_sided = spec.add_tendon(
            name=name, stiffness=[(1 - ratio) * stiffness, 0.0, 0.0], springlength=[-_FAR_M, corner]
        )
        one_sided.wrap_joint(name, 1.0)
    return joint


def _add_mount_with_play(
    spec: mujoco.MjSpec, name: str, element: MountCompliance, axis: NDArray[np.float64]
) -> mujoco.MjsJoint:
    """A spring with a dead band below the corner, and the preload as the pull of one too soft to change on the way."""
    corner = -element.preload_n / element.stiffness_n_per_m
    joint = spec.body(numbered(TRANSDUCER, element.exciter)).add_joint(
        name=name,
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=axis,
        stiffness=[element.preload_n / _FAR_M, 0.0, 0.0],
        springref=_FAR_M,
        damping=[element.damping_n_s_per_m, 0.0, 0.0],
    )
    play = spec.add_tendon(
        name=name, stiffness=[element.stiffness_n_per_m, 0.0, 0.0], springlength=[corner - element.gap_m, corner]
    )
    play.wrap_joint(name, 1.0)
    return joint


def add_rattling_mass(spec: mujoco.MjSpec, parts: AirframeParts, name: str, element: RattlingMass) -> None:
    """A mass on a vertical slide between two stops; at zero it lies on the lower one with its weight."""
    position = np.array(element.position_m)
    add_point_mass(spec, parts, name, parts.carrier(element.part, position), position, element.mass_kg)
    spec.body(name).add_joint(
        name=f"{name}/rattle",
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=_UP,
        damping=[element.damping_n_s_per_m, 0.0, 0.0],
    )
    pressed_in = element.mass_kg * GRAVITY_M_PER_S2 / element.stiffness_n_per_m
    stops = spec.add_tendon(
        name=name,
        stiffness=[element.stiffness_n_per_m, 0.0, 0.0],
        springlength=[pressed_in, pressed_in + element.gap_m],
    )
    stops.wrap_joint(f"{name}/rattle", 1.0)


def add_point_pair(spec: mujoco.MjSpec, parts: AirframeParts, name: str, element: PointPair) -> None:
    """A tendon as long as the difference of two points' heights above the centre body, plus a constant.

    Each end's height is its distance from a site of the body far above, or below, so that the
    forces balance within the aircraft and no rigid motion stretches anything.
    """
    rod = spec.add_tendon(
        name=name,
        stiffness=[element.stiffness_n_per_m, 0.0, 0.0],
        damping=[element.damping_n_s_per_m, 0.0, 0.0],
    )
    ends = ((element.part, element.position_m, _FAR_M), (element.other_part, element.other_position_m, -_FAR_M))
    for k, (part, place, away_m) in enumerate(ends):
        reach(rod, spec, parts, f"{name}/end-{k}", (part, place), (ROOT, away_m * _UP))


def add_suspension_cubic(spec: mujoco.MjSpec, parts: AirframeParts, name: str, element: SuspensionCubic) -> None:
    """A tendon along the suspension's spring, slack by its dead band until it is trimmed to the length as hung."""
    del parts
    rod = spec.add_tendon(name=name, stiffness=[0.0, 0.0, element.cubic_n_per_m3], springlength=[-_FAR_M, _FAR_M])
    rod.wrap_site(FRAME_SITE)
    rod.wrap_site(HOOK_SITE)
