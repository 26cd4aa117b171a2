"""Structural damping that gives each mode of the bare airframe the ratio the scenario asks for.

A fixed tendon over the elastic joints with the coefficients M φ and the damper
d adds d (Mφ)(Mφ)ᵀ to C: damping of one mode and no other, and none of the rigid
body, whose joints have no share in M φ. Above the limit plain joint dampers
take over, in proportion to stiffness, which also keep the chain's highest,
physically meaningless modes quiet; what they add below is taken off the tendons.
"""

from __future__ import annotations

import mujoco
import numpy as np
import scipy.linalg

from vgvt.scenario.airframe import Damping
from vgvt.simulation.linear import mass_matrix

RIGID_MODES = 6
MODAL_DAMPING = "modal-damping-"
_HIGHEST_RATIO = 0.7


def add_structural_damping(spec: mujoco.MjSpec, damping: Damping) -> None:
    """Add tendons and joint dampers to the bare airframe's ``spec`` (before rig and instruments are)."""
    model = spec.compile()
    # In its unloaded shape and without weight the bare airframe has the stiffness of its joints and no other.
    mass = mass_matrix(model, mujoco.MjData(model))
    eigenvalues, shapes = scipy.linalg.eigh(np.diag(model.jnt_stiffness), mass)
    omega = np.sqrt(np.maximum(eigenvalues[RIGID_MODES:], 0.0))
    shapes = shapes[:, RIGID_MODES:]
    limit = 2 * np.pi * damping.limit_hz
    ratios = np.full(omega.size, damping.damping_ratio)
    ratios[: len(damping.modal)] = damping.modal[: omega.size]
    exact = omega <= limit
    # As much joint damping as leaves every tendon something to give, the default ratio at the limit, and the chain's
    # highest mode, a thousand times faster than anything of interest, an oscillation that can still be stepped.
    per_stiffness = 2 * min(
        damping.damping_ratio / limit,
        (ratios[exact] / omega[exact]).min(initial=np.inf),
        _HIGHEST_RATIO / omega[-1] if omega.size else np.inf,
    )
    elastic = [(int(model.joint(j.name).dofadr[0]), j) for j in spec.joints if j.stiffness[0] > 0]
    # MuJoCo builds a tendon's row fastest from joints in the order of their coordinates.
    elastic.sort(key=lambda pair: pair[0])
    for _, joint in elastic:
        joint.damping = [per_stiffness * joint.stiffness[0], 0.0, 0.0]
    for r in np.flatnonzero(exact):
        coefficient = 2 * ratios[r] * omega[r] - per_stiffness * omega[r] ** 2
        tendon = spec.add_tendon(name=f"{MODAL_DAMPING}{r + 1}", damping=[coefficient, 0.0, 0.0])
        weights = mass @ shapes[:, r]
        for address, joint in elastic:
            tendon.wrap_joint(joint.name, weights[address])
