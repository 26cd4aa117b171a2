"""Elements added to an assembled structure by their rows alone: what a scan over thousands of variants can afford.

The aircraft keeps its attitude: the weight of what is added, and what that bends, is left out. A fit that follows
assembles the whole rig.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.effects.elements import Absorber, Element, GroundSpring, PointMass, RotationSpring
from vgvt.simulation.assembly import Plan
from vgvt.simulation.reduced import Structure

Array = NDArray[np.float64]


def attach(base: Structure, layout: Plan, elements: Sequence[tuple[str, Element]]) -> Structure | None:
    """The structure with named elements on it; None where one of them is not a mass, a spring or an absorber.

    ``layout`` is the plan that ``base`` was assembled from.
    """
    if not all(isinstance(e, PointMass | GroundSpring | Absorber | RotationSpring) for _, e in elements):
        return None
    if any(isinstance(e, RotationSpring) and e.gauge_per_m != 0 for _, e in elements):
        return None
    inner = tuple(f"{name}/absorber" for name, e in elements if isinstance(e, Absorber))
    wide = base.onto((*base.joints, *inner))
    mass, damping, stiffness = wide.mass.copy(), wide.damping.copy(), wide.stiffness.copy()
    for name, element in elements:
        if isinstance(element, RotationSpring):
            turned = np.zeros(wide.drive.size)
            turned[:6] = wide.root[wide.joints.index(element.axis)]
            stiffness += element.stiffness_n_m_per_rad * np.outer(turned, turned)
            damping += element.damping_n_m_s_per_rad * np.outer(turned, turned)
            continue
        rows, turn = point_rows(wide, layout, element.part, np.array(element.position_m))
        if isinstance(element, PointMass):
            mass += element.mass_kg * rows.T @ rows
        elif isinstance(element, GroundSpring):
            row = _unit(element.direction) @ rows
            stiffness += element.stiffness_n_per_m * np.outer(row, row)
            damping += element.damping_n_s_per_m * np.outer(row, row)
        else:
            joint = wide.joints.index(f"{name}/absorber")
            moved = rows.copy()
            moved[:, joint] += turn @ _unit(element.direction)
            mass += element.mass_kg * moved.T @ moved
            stiffness[joint, joint] += element.stiffness_n_per_m
            damping[joint, joint] += element.damping_n_s_per_m
    return replace(wide, mass=mass, damping=damping, stiffness=stiffness)


def point_rows(structure: Structure, layout: Plan, part: str, position_m: Array) -> tuple[Array, Array]:
    """Displacement rows (3, n) of a point (3,) of a part in world axes, and the attitude (3, 3) of what carries it."""
    carrier = layout.parts.carrier(part, position_m)
    k = structure.body_names.index(carrier)
    turn = structure.attitude[k]
    arm = turn @ (position_m - layout.parts.origin_m[carrier])
    moved, turned = structure.bodies[k, :3], structure.bodies[k, 3:]
    return moved + np.cross(turned, arm, axis=0), turn


def _unit(direction: Sequence[float]) -> Array:
    vector = np.array(direction, dtype=float)
    return np.asarray(vector / np.linalg.norm(vector))
