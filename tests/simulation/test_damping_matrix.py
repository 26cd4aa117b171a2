"""What is damped by constants needs no differences of forces: both ways to a damping matrix say the same."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from vgvt.scenario import load_scenario
from vgvt.simulation.assembly import hung_rig, plans
from vgvt.simulation.linear import damping_matrix, joint_force, settle


@pytest.fixture
def hung() -> tuple[mujoco.MjModel, mujoco.MjData]:
    """An aircraft at rest on its spring: dampers of joints, of the spring and of every mode."""
    model = hung_rig(next(iter(plans(load_scenario("hati-unsymmetric")))), 0).model
    data = mujoco.MjData(model)
    data.qpos[:] = settle(model)
    assert model.ntendon > 3 and not model.nu
    return model, data


def by_differences(model: mujoco.MjModel, data: mujoco.MjData, step: float = 1e-4) -> np.ndarray:
    """Change of joint forces with each velocity, sign turned."""
    columns = []
    for change in step * np.eye(model.nv):
        ends = []
        for side in (1, -1):
            data.qvel[:] = side * change
            ends.append(joint_force(model, data))
        columns.append((ends[1] - ends[0]) / (2 * step))
    data.qvel[:] = 0.0
    return np.array(columns).T


def test_dampers_are_those_of_forces(hung: tuple[mujoco.MjModel, mujoco.MjData]) -> None:
    model, data = hung
    found, expected = damping_matrix(model, data), by_differences(model, data)
    assert np.abs(found - expected).max() < 1e-8 * np.abs(expected).max()
    # Nor is a speed that was left there taken for rest.
    data.qvel[:] = 1.0
    assert np.array_equal(damping_matrix(model, data), found)
    assert not data.qvel.any()


def test_what_is_damped_otherwise_is_asked_by_differences(hung: tuple[mujoco.MjModel, mujoco.MjData]) -> None:
    """Air around the bodies, for one: a drag that no damper states."""
    model, data = hung
    dry = damping_matrix(model, data)
    model.opt.viscosity = 1e-3
    wet = damping_matrix(model, data)
    assert np.abs(wet - dry).max() > 1e-6 * np.abs(dry).max()
    assert np.abs(wet - by_differences(model, data)).max() < 1e-8 * np.abs(wet).max()
    assert not data.qvel.any()
