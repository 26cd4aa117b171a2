"""Elements added to an assembled structure by their rows alone: what a scan over thousands of variants can afford.

The aircraft keeps its attitude: the weight of what is added, and what that bends, is left out, but for what it does
along a slide or about a hinge of its own. A fit that follows assembles the whole rig.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.elements import Absorber, Element, GroundSpring, HingedFlap, PointMass, RotationSpring
from vgvt.simulation.as_hung import AXES
from vgvt.simulation.assembly import Plan
from vgvt.simulation.elements import sharing
from vgvt.simulation.felt import felt_by
from vgvt.simulation.reduced import Structure
from vgvt.simulation.rig import GRAVITY_M_PER_S2
from vgvt.simulation.seats import MeasurementPoint, seats_at

Array = NDArray[np.float64]
_UP = 2
_Simple = PointMass | GroundSpring | Absorber | RotationSpring | HingedFlap


def attach(base: Structure, layout: Plan, elements: Sequence[tuple[str, Element]]) -> Structure | None:
    """The structure with named elements on it; None where one of them is not a mass, spring, absorber or flap.

    ``layout`` is the plan that ``base`` was assembled from.
    """
    simple: list[tuple[str, _Simple]] = []
    for name, element in elements:
        if not isinstance(element, _Simple):
            return None
        simple.append((name, element))
    inner = tuple(_own_joint(name, e) for name, e in simple if isinstance(e, Absorber | HingedFlap))
    wide = base.onto((*base.joints, *inner))
    wide = replace(wide, mass=wide.mass.copy(), damping=wide.damping.copy(), stiffness=wide.stiffness.copy())
    for name, element in simple:
        if isinstance(element, RotationSpring):
            k = wide.body_names.index(layout.drives[element.exciter].carrier)
            turned = (wide.attitude[k].T @ wide.bodies[k, 3:])[AXES[element.axis]]
            _spring(wide, turned, element.stiffness_n_m_per_rad, element.damping_n_m_s_per_rad)
            # What the gauge feels of the moment is on the force's side of the equation.
            felt = element.gauge_per_m * np.outer(wide.drive, turned)
            wide.stiffness[:] -= element.stiffness_n_m_per_rad * felt
            wide.damping[:] -= element.damping_n_m_s_per_rad * felt
        elif isinstance(element, HingedFlap):
            _flap(wide, layout, wide.joints.index(_own_joint(name, element)), element)
        else:
            _at_a_point(wide, layout, name, element)
    return wide


def point_rows(structure: Structure, layout: Plan, part: str, position_m: Array) -> tuple[Array, Array]:
    """Displacement rows (3, n) of a point (3,) of a part in world axes, and the attitude (3, 3) of what carries it."""
    return carried_rows(structure, layout, layout.parts.carrier(part, position_m), position_m)


def carried_rows(structure: Structure, layout: Plan, carrier: str, position_m: Array) -> tuple[Array, Array]:
    """The same of a point (3,) that a rigid body of that name carries."""
    k = structure.body_names.index(carrier)
    turn = structure.attitude[k]
    arm = turn @ (position_m - layout.parts.origin_m[carrier])
    moved, turned = structure.bodies[k, :3], structure.bodies[k, 3:]
    return moved + np.cross(turned, arm, axis=0), turn


def held_row(structure: Structure, layout: Plan, spring: GroundSpring) -> Array:
    """What a spring to the ground is stretched by (n,), of a place that moves as the beam between two links does."""
    held, direction = np.zeros(structure.drive.size), _unit(spring.direction)
    for seat in seats_at(layout.parts, spring.part, np.array(spring.position_m)):
        moved, turn = carried_rows(structure, layout, seat.carrier, seat.position_m)
        held += seat.weight * (turn @ direction if spring.turns_with_part else direction) @ moved
    return held


def sensed_at(structure: Structure, layout: Plan, point: MeasurementPoint) -> tuple[Array, Array, Array]:
    """Rows of a sensor: displacement (3, n) in world axes, along its axis (n,), and the gravity that it feels (n,)."""
    moved, along, tilt = felt_by(
        (point,), layout.parts.origin_m, structure.body_names, structure.bodies, structure.attitude
    )
    return moved[0], along[0], tilt[0]


def vanishes(joint: str) -> bool:
    """Whether a joint is that of a thing hung on the structure by an effect: with its inertia it is gone."""
    return joint.startswith("effect-") and "/" in joint


def _own_joint(name: str, element: Absorber | HingedFlap) -> str:
    return f"{name}/{element.kind}" if isinstance(element, Absorber) else f"{name}/flap"


def _at_a_point(s: Structure, layout: Plan, name: str, element: PointMass | GroundSpring | Absorber) -> None:
    """Add to the matrices, in place, what sits at a point."""
    rows, turn = point_rows(s, layout, element.part, np.array(element.position_m))
    # Of the frame that the suspension hangs from, where that moves.
    frame = [k for k, j in enumerate(s.joints) if j.endswith("/frame")]
    if isinstance(element, PointMass):
        for carrier, share in sharing(layout.parts, element):
            rows, _ = carried_rows(s, layout, carrier, np.array(element.position_m))
            s.mass[:] += share * element.mass_kg * rows.T @ rows
        s.mass[frame, frame] += element.frame_kg
    elif isinstance(element, GroundSpring):
        held = held_row(s, layout, element)
        _spring(s, held, element.stiffness_n_per_m, element.damping_n_s_per_m)
    else:
        moved, own = rows.copy(), np.zeros(s.drive.size)
        joint, along = s.joints.index(_own_joint(name, element)), turn @ _unit(element.direction)
        moved[:, joint] += along
        own[joint] = 1.0
        # More of its weight lies along the slide, or less, as the airframe turns: most where that hangs nose down.
        carried = s.bodies[s.body_names.index(layout.parts.carrier(element.part, np.array(element.position_m))), 3:]
        pulled = element.mass_kg * GRAVITY_M_PER_S2 * np.cross(carried, along, axis=0)[_UP]
        s.stiffness[joint] += pulled
        s.stiffness[:, joint] += pulled
        own[frame] = -element.frame_share
        s.mass[:] += element.mass_kg * moved.T @ moved
        _spring(s, own, element.stiffness_n_per_m, element.damping_n_s_per_m)


def _flap(s: Structure, layout: Plan, joint: int, element: HingedFlap) -> None:
    """Add a rigid flap that turns about its hinge, in place."""
    hinge = np.array(element.hinge_m)
    carrier = layout.parts.carrier(element.part, hinge)
    k = s.body_names.index(carrier)
    rows, turn = point_rows(s, layout, element.part, hinge)
    axis = turn @ _unit(element.hinge_axis)
    arm = turn @ (np.array(element.centre_of_gravity_m) - hinge)
    turned = s.bodies[k, 3:].copy()
    turned[:, joint] += axis
    moved = rows + np.cross(turned, arm, axis=0)
    inertia = turn @ np.diag(element.inertia_kg_m2) @ turn.T
    s.mass[:] += element.mass_kg * moved.T @ moved + turned.T @ inertia @ turned
    # Of its weight, what turns the flap with or against its spring: nose down that is half of a soft one.
    swung = element.mass_kg * GRAVITY_M_PER_S2 * np.cross(turned, np.cross(axis, arm), axis=0)[_UP]
    s.stiffness[joint] += swung
    s.stiffness[:, joint] += swung
    s.stiffness[joint, joint] -= swung[joint]
    own = np.zeros(s.drive.size)
    own[joint] = 1.0
    _spring(s, own, element.stiffness_n_m_per_rad, element.damping_n_m_s_per_rad)


def _spring(s: Structure, row: Array, stiffness: float, damping: float) -> None:
    """Spring and dashpot to the ground on one motion (n,), in place."""
    s.stiffness[:] += stiffness * np.outer(row, row)
    s.damping[:] += damping * np.outer(row, row)


def _unit(direction: Sequence[float]) -> Array:
    vector: Array = np.array(direction, dtype=float)
    return vector / np.linalg.norm(vector)
