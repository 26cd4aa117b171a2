"""The airframe as a MuJoCo model: a centre body free in six directions, and chains for its beams.

The centre body hangs on three slide and three hinge joints instead of a free
joint: the same six freedoms without quaternions, so that the suspension's small
yaw stiffness has a joint to act on and mass and stiffness matrices refer to
plain coordinates. (At a pitch of 90 degrees roll and yaw turn about one axis, and
the coordinates lock. What hangs by a hook above its centre of gravity stays short of
that: within a few degrees of level as a rule, BFF hung aft at 66 nose down.)

Air that a surface moves with it has inertia and no weight: a body of its own on
each link, without a joint, whose weight MuJoCo takes back.

A centre body with a carry-through spring is two halves that pitch against each
other about the line through the roots of its beams, each with half of the mass and
inertia at the common centre of gravity; the middle between them has the six joints.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.airframe import Airframe
from vgvt.scenario.mirror import expanded_beams, expanded_items, part_name
from vgvt.simulation.chain import Chain, Hinge, Link, cut
from vgvt.simulation.halves import (
    CARRY_THROUGH,
    LEFT_HALF,
    MIDDLE_SHARE,
    RIGHT_HALF,
    RIGHT_OF_MIDDLE,
    add_halves,
    gear_middle,
)
from vgvt.simulation.inertia import NOTHING, MassMoments, lump

Pushed = tuple[tuple[str, float], ...]
"""Where shakers push beams, by the name of a beam as built and the arc length, m."""
ROOT = "body"
_AIR = "air-"
ROOT_JOINTS = ("slide-x", "slide-y", "slide-z", "yaw", "pitch", "roll")
# In the plane of symmetry: to a hundredth of the way to the roots, where the twist between the middle and these is that
# small, too; and to rounding.
_OF_THE_WAY, _IN_THE_PLANE_M = 0.01, 1e-6
_ROOT_AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 1), (0, 1, 0), (1, 0, 0))


@dataclass(frozen=True, slots=True, eq=False)
class AirframeParts:
    """Where things are on the airframe: chains by beam name and the origin (3,) of every body frame.

    Body frames are parallel to the aircraft axes in the unloaded shape. ``pushed`` is where cells had to end.
    """

    airframe: Airframe
    chains: dict[str, Chain]
    origin_m: dict[str, NDArray[np.float64]]
    pushed: Pushed = ()

    @property
    def halved(self) -> bool:
        """Whether the centre body is two halves on a carry-through spring; the root is the middle between them."""
        return self.airframe.body.carry_through_stiffness_n_m_per_rad is not None

    @property
    def locked(self) -> AirframeParts:
        """The parts with whatever hangs on hinges of its own fixed where it is."""
        airframe = self.airframe
        if not airframe.hinged:
            return self
        return replace(
            self, airframe=airframe.model_copy(update={"item": (*airframe.item, *airframe.hinged), "hinged": ()})
        )

    def carrier(self, part: str, position_m: NDArray[np.float64]) -> str:
        """Name of the rigid body that carries a point (3,) of a part ('body' or a beam)."""
        part = part_name(self.airframe, part, float(position_m[1]))
        if part == ROOT:
            return self._of_body(float(position_m[1]))
        chain = self.chains[part]
        return self._body(chain, chain.link_at(chain.table.nearest_arc_m(position_m)), position_m)

    def shares(self, part: str, position_m: NDArray[np.float64]) -> tuple[tuple[str, float], ...]:
        """The rigid bodies that share a lump at a point (3,) of a part, and their fractions."""
        part = part_name(self.airframe, part, float(position_m[1]))
        if part == ROOT:
            return ((self._of_body(float(position_m[1])), 1.0),)
        chain = self.chains[part]
        arc = chain.table.nearest_arc_m(position_m)
        return tuple((self._body(chain, link, position_m), share) for link, share in chain.shares(arc))

    def holder(self, chain: Chain) -> str:
        """Name of the rigid body that holds the root of a chain: of two halves, the one on the side of its tip."""
        root, tip = (chain.table.point_m(arc) for arc in (0.0, chain.table.length_m))
        return self.carrier(chain.parent, tip if chain.parent == ROOT else root)

    def _of_body(self, y_m: float) -> str:
        """What of the centre body carries a point that is so far to the right of the plane of symmetry."""
        if not self.halved or self._in_the_plane(y_m):
            return ROOT
        return RIGHT_HALF if y_m > 0 else LEFT_HALF

    def _in_the_plane(self, y_m: float) -> bool:
        roots = [abs(float(chain.table.point_m(0.0)[1])) for chain in self.chains.values() if chain.parent == ROOT]
        return abs(y_m) <= max(_IN_THE_PLANE_M, _OF_THE_WAY * max(roots, default=0.0))

    def _body(self, chain: Chain, link: Link | None, position_m: NDArray[np.float64]) -> str:
        if link is not None:
            return link.name
        in_the_plane = self.halved and chain.parent == ROOT and self._in_the_plane(float(position_m[1]))
        return ROOT if in_the_plane else self.holder(chain)


def cut_airframe(airframe: Airframe, pushed: Pushed = ()) -> AirframeParts:
    """Cut all beams into chains, so that cells end where they are ``pushed``, and lay down the body frames."""
    arcs = {name: tuple(arc for part, arc in pushed if part == name) for name, _ in pushed}
    chains = {beam.name: cut(beam, arcs.get(beam.name, ())) for beam in expanded_beams(airframe)}
    origin = {ROOT: np.array(airframe.body.centre_of_gravity_m)}
    roots = [chain.table.point_m(0.0) for chain in chains.values() if chain.parent == ROOT] or [origin[ROOT]]
    origin[RIGHT_HALF] = origin[LEFT_HALF] = np.mean(roots, axis=0) * np.array([1.0, 0.0, 1.0])
    for chain in chains.values():
        origin |= {link.name: link.position_m for link in chain.links}
    return AirframeParts(airframe, chains, origin, pushed)


def elastic_joints(parts: AirframeParts) -> tuple[str, ...]:
    """Names of the bare airframe's joints but those of the root."""
    links = (link for chain in parts.chains.values() for link in chain.links)
    hinges = tuple(hinge_name(link, hinge) for link in links for hinge in link.hinges)
    return (*((RIGHT_OF_MIDDLE, CARRY_THROUGH) if parts.halved else ()), *hinges)


def hinge_name(link: Link, hinge: Hinge) -> str:
    """The name of a hinge's joint."""
    return f"{link.name}/{hinge.kind}"


def airframe_spec(parts: AirframeParts) -> mujoco.MjSpec:
    """The bare airframe, without gravity, springs to the ground or damping."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.gravity = np.zeros(3)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    # Nothing touches anything in a ground vibration test: skip the constraint stages of every step.
    # And a run that diverges must be seen to, not be reset to rest behind our back.
    flag = mujoco.mjtDisableBit
    spec.option.disableflags = flag.mjDSBL_CONTACT | flag.mjDSBL_CONSTRAINT | flag.mjDSBL_AUTORESET
    moments = _moments(parts)
    root = spec.worldbody.add_body(name=ROOT, pos=parts.origin_m[ROOT])
    for name, axis in zip(ROOT_JOINTS, _ROOT_AXES, strict=True):
        kind = mujoco.mjtJoint.mjJNT_SLIDE if name.startswith("slide") else mujoco.mjtJoint.mjJNT_HINGE
        root.add_joint(name=name, type=kind, axis=axis)
    bodies = {ROOT: root}
    carry_through = parts.airframe.body.carry_through_stiffness_n_m_per_rad
    if carry_through is not None:
        bodies |= add_halves(root, parts.origin_m[RIGHT_HALF] - parts.origin_m[ROOT], carry_through)
        gear_middle(spec, sum(moments.values(), NOTHING), parts.origin_m[RIGHT_HALF])
    for chain in _parents_first(parts):
        parent = parts.holder(chain)
        for link in chain.links:
            body = bodies[parent].add_body(name=link.name, pos=link.position_m - parts.origin_m[parent])
            _add_hinges(body, link)
            bodies[link.name], parent = body, link.name
    _set_inertials({body: (moments[name], parts.origin_m[name]) for name, body in bodies.items()})
    _add_air(bodies, parts)
    return spec


def _moments(parts: AirframeParts) -> dict[str, MassMoments]:
    body = parts.airframe.body
    cg = np.array(body.centre_of_gravity_m)
    whole_body = lump(body.mass_kg, cg, np.diag(body.inertia_kg_m2))
    moments = {ROOT: whole_body}
    if parts.halved:
        half = whole_body.scaled((1 - MIDDLE_SHARE) / 2)
        moments = {ROOT: whole_body.scaled(MIDDLE_SHARE), RIGHT_HALF: half, LEFT_HALF: half}
    for chain in parts.chains.values():
        moments |= {link.name: link.moments for link in chain.links}
    for chain in parts.chains.values():
        moments[parts.holder(chain)] += chain.stub
    for item in expanded_items(parts.airframe):
        position = np.array(item.position_m)
        whole = lump(item.mass_kg, position, np.diag(item.inertia_kg_m2))
        for name, share in parts.shares(item.attached_to, position):
            moments[name] += whole.scaled(share)
    return moments


def _add_air(bodies: dict[str, mujoco.MjsBody], parts: AirframeParts) -> None:
    """Fix to every body the air that it moves."""
    moved = {link.name: link.air for chain in parts.chains.values() for link in chain.links}
    for chain in parts.chains.values():
        holder = parts.holder(chain)
        moved[holder] = moved.get(holder, NOTHING) + chain.stub_air
    carried = {name: air for name, air in moved.items() if air.mass_kg > 0}
    if carried:
        added = {name: bodies[name].add_body(name=f"{_AIR}{name}", gravcomp=1.0) for name in carried}
        _set_inertials({added[name]: (air, parts.origin_m[name]) for name, air in carried.items()})


def _parents_first(parts: AirframeParts) -> list[Chain]:
    """Chains in an order in which the parent's bodies exist before the child's; ValueError for a loop."""
    waiting, placed = list(parts.chains.values()), [ROOT]
    order: list[Chain] = []
    while waiting:
        ready = [c for c in waiting if c.parent in placed]
        if not ready:
            raise ValueError(f"beams hang on each other in a loop: {', '.join(c.name for c in waiting)}")
        order += ready
        placed += [c.name for c in ready]
        waiting = [c for c in waiting if c not in ready]
    return order


def _add_hinges(body: mujoco.MjsBody, link: Link) -> None:
    for hinge in link.hinges:
        body.add_joint(
            name=hinge_name(link, hinge),
            type=mujoco.mjtJoint.mjJNT_HINGE,
            axis=hinge.axis,
            stiffness=[hinge.stiffness_n_m_per_rad, 0.0, 0.0],
        )


def _set_inertials(bodies: dict[mujoco.MjsBody, tuple[MassMoments, NDArray[np.float64]]]) -> None:
    """Give bodies their mass moments, of frames at an origin (3,) in aircraft axes."""
    rigid = [moments.rigid_body() for moments, _ in bodies.values()]
    principal, axes = np.linalg.eigh(np.array([r.inertia_kg_m2 for r in rigid]))
    # A flat body sits on the edge of the triangle inequality, which rounding may cross: lift it back.
    principal[:, 0] = np.maximum(principal[:, 0], (principal[:, 2] - principal[:, 1]) * (1 + 1e-12))
    principal[:, 0] = np.maximum(principal[:, 0], 1e-12 * principal[:, 2])
    axes[np.linalg.det(axes) < 0, :, 0] *= -1
    quaternion = np.zeros(4)
    for (body, (_, origin_m)), r, inertia, turn in zip(bodies.items(), rigid, principal, axes, strict=True):
        mujoco.mju_mat2Quat(quaternion, turn.ravel())
        body.explicitinertial = True
        body.mass = r.mass_kg
        body.ipos = r.centre_of_gravity_m - origin_m
        body.iquat = quaternion
        body.inertia = inertia
