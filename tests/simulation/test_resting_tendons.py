"""Differences for a stiffness leave out the dampers of modes, which reach over every joint and do nothing at rest."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from vgvt.scenario import load_scenario
from vgvt.simulation import linear
from vgvt.simulation.assembly import driven_rig, plans
from vgvt.simulation.linear import joint_force, stiffness_matrix

RIG = """
<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <body>
      <joint name="a" type="slide" axis="0 0 1" stiffness="7"/>
      <geom size="0.1" mass="1"/>
      <body pos="1 0 0">
        <joint name="b" type="slide" axis="0 0 1"/>
        <geom size="0.1" mass="1"/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <fixed name="damper" damping="3"><joint joint="a" coef="1"/><joint joint="b" coef="2"/></fixed>
    <fixed name="spring" stiffness="5" springlength="0"><joint joint="a" coef="1"/><joint joint="b" coef="-1"/></fixed>
    <fixed name="both" stiffness="2" springlength="0" damping="9"><joint joint="b" coef="3"/></fixed>
    <fixed name="driven" damping="1"><joint joint="a" coef="1"/><joint joint="b" coef="1"/></fixed>
  </tendon>
  <actuator><position tendon="driven" kp="11"/></actuator>
</mujoco>
"""


def test_springs_and_actuators_stay() -> None:
    model = mujoco.MjModel.from_xml_string(RIG)
    kept = model.tendon_num.copy()
    rows = {"spring": (5.0, [1.0, -1.0]), "both": (2.0, [0.0, 3.0]), "driven": (11.0, [1.0, 1.0])}
    wanted = np.diag([7.0, 0.0]) + sum(k * np.outer(row, row) for k, row in rows.values())
    got = stiffness_matrix(model, mujoco.MjData(model), np.array([0.1, -0.2]))
    np.testing.assert_allclose(got, wanted, rtol=1e-9)
    np.testing.assert_array_equal(model.tendon_num, kept)


def test_a_dampers_force_is_the_same_as_ever() -> None:
    """The copy is for forces at rest: the model's own dampers still act."""
    model = mujoco.MjModel.from_xml_string(RIG)
    data = mujoco.MjData(model)
    stiffness_matrix(model, data, np.zeros(2))
    data.qvel[:] = [1.0, 0.0]
    # 3 · 1 · (1, 2) and 1 · 1 · (1, 1).
    np.testing.assert_allclose(joint_force(model, data), [-4.0, -7.0], rtol=1e-12)


@pytest.mark.parametrize("name", ["hati-unsymmetric", "garteur-sm-ag19", "bff"])
def test_an_aircraft_is_as_stiff_as_with_all_its_tendons(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setattr(linear, "tangent_stiffness", lambda model, data: None)
    rig = driven_rig(plans(load_scenario(name))[0], 0)
    data = mujoco.MjData(rig.model)
    step = 1e-5
    columns = []
    for k in range(rig.model.nv):
        forces = []
        for side in (step, -step):
            data.qpos[:] = rig.qpos
            data.qpos[k] += side
            forces.append(joint_force(rig.model, data))
        columns.append((forces[1] - forces[0]) / (2 * step))
    assert (rig.model.tendon_num > 2).any()
    np.testing.assert_array_equal(stiffness_matrix(rig.model, data, rig.qpos, step), np.array(columns).T)
