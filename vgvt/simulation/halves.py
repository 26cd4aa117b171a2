"""A centre body of two halves that pitch against each other, and the middle between them.

The halves turn about the line through the roots of the beams, on the carry-through spring. What is in the plane of
symmetry, the hook say, is on the middle, which turns by the mean of what they do: it moves as the mean of the same
point on either half. So what is symmetric stays so, and a point that moves from one half to the other passes through
the middle. The middle is the root of the airframe, the right half hangs on it and the left half on the right.

A tree of bodies knows no gear. In its place the difference of the middle's turn and that mean has a spring and an
inertia of its own, and a damper that leaves it no oscillation. The spring is one on which the whole airframe would
pitch at 4 kHz: to what is carried by the middle it gives way by (f / 4 kHz)² of what the airframe's inertia does, 1e-4
at 40 Hz. Inertia alone would not hold the middle at rest, and a spring alone, on so light a body, would need time
steps that nobody cares to wait for.
"""

from __future__ import annotations

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.simulation.inertia import MassMoments

RIGHT_HALF, LEFT_HALF = "body-right", "body-left"
CARRY_THROUGH = "carry-through"
"""The joint of the left half on the right one."""
RIGHT_OF_MIDDLE = "carry-through-middle"
"""The joint of the right half on the middle."""
MIDDLE_SHARE = 1e-6
"""Of the body's mass and inertia, that of the middle: no body may be without."""
_GEAR = "carry-through-gear"
# The gear's own rate, as fast as explicit steps of a quarter of a millisecond stand, and its inertia over the
# airframe's; a little more than critical damping.
_RATE_RAD_PER_S, _FLYWHEEL, _DAMPING = 2 * math.pi * 1000.0, 16.0, 1.05


def add_halves(
    middle: mujoco.MjsBody, from_middle_m: NDArray[np.float64], stiffness_n_m_per_rad: float
) -> dict[str, mujoco.MjsBody]:
    """The two halves, by name, on their hinges at a point (3,) in the middle's frame."""
    right = middle.add_body(name=RIGHT_HALF, pos=from_middle_m)
    left = right.add_body(name=LEFT_HALF)
    for half, joint, stiffness in ((right, RIGHT_OF_MIDDLE, 0.0), (left, CARRY_THROUGH, stiffness_n_m_per_rad)):
        half.add_joint(
            name=joint, type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0.0, 1.0, 0.0), stiffness=[stiffness, 0.0, 0.0]
        )
    return {RIGHT_HALF: right, LEFT_HALF: left}


def gear_middle(spec: mujoco.MjSpec, airframe: MassMoments, hinge_m: NDArray[np.float64]) -> None:
    """Let the middle turn by the mean of the halves, of an ``airframe`` of that mass, about the hinge (3,)."""
    whole = airframe.rigid_body()
    arm_m = (whole.centre_of_gravity_m - hinge_m)[[0, 2]]
    inertia = _FLYWHEEL * float(whole.inertia_kg_m2[1, 1] + whole.mass_kg * (arm_m @ arm_m))
    gear = spec.add_tendon(
        name=_GEAR,
        stiffness=[inertia * _RATE_RAD_PER_S**2, 0.0, 0.0],
        damping=[2 * _DAMPING * inertia * _RATE_RAD_PER_S, 0.0, 0.0],
        armature=inertia,
    )
    gear.wrap_joint(RIGHT_OF_MIDDLE, 1.0)
    gear.wrap_joint(CARRY_THROUGH, 0.5)


def pitched_by(carrier: str) -> tuple[str, ...]:
    """The joints by whose angles one of the bodies pitches more than the middle."""
    return {RIGHT_HALF: (RIGHT_OF_MIDDLE,), LEFT_HALF: (RIGHT_OF_MIDDLE, CARRY_THROUGH)}.get(carrier, ())
