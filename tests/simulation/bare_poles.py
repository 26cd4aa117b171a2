"""The poles of a bare aircraft, by the dampers that are in its model."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.airframe import Airframe
from vgvt.simulation.airframe import airframe_spec
from vgvt.simulation.linear import mass_matrix
from vgvt.simulation.once import cut_once, damping_once


def poles(airframe: Airframe) -> NDArray[np.complex128]:
    """The elastic poles, rad/s, of the bare aircraft that swing, by frequency."""
    spec = airframe_spec(cut_once(airframe))
    damping = damping_once(airframe)
    damping.damp_joints(spec)
    model = spec.compile()
    mass = mass_matrix(model, mujoco.MjData(model))
    names = [model.joint(j).name for j in range(model.njnt)]
    damper = np.diag(model.dof_damping) + damping.modal_matrix(names)
    by_mass = np.linalg.solve(mass, np.hstack([-np.diag(model.jnt_stiffness), -damper]))
    found = np.linalg.eigvals(np.vstack([np.hstack([np.zeros_like(mass), np.eye(model.nv)]), by_mass]))
    swinging = found[(np.abs(found) > 1.0) & (found.imag > 0)]
    return swinging[np.argsort(np.abs(swinging))]
