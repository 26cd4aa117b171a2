"""A joint with play has no stiffness where Newton's method begins: the weight finds the stop that it rests on."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from vgvt.scenario import load_scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import truth_of
from vgvt.simulation.assembly import driven_rig, plans
from vgvt.simulation.rig import GRAVITY_M_PER_S2

STIFFNESS = 2000.0


@pytest.mark.parametrize("gap_rad", [3.5e-4, 8.7e-3])
@pytest.mark.parametrize("scenario", ["teaching-beam", "teaching-beam-hammer", "bff"])
def test_a_wing_rests_on_the_stop_of_its_gap(scenario: str, gap_rad: float) -> None:
    """The root joint's spring, beyond the gap, bears the moment of all that hangs outboard of it."""
    table = EffectTable(name="root-freeplay", kind="bending", gap_rad=gap_rad)
    rig = driven_rig(plans(load_scenario(scenario).model_copy(update={"effect": (table,)}))[0], 0)
    model, data = rig.model, mujoco.MjData(rig.model)
    data.qpos[:] = rig.qpos
    mujoco.mj_forward(model, data)
    roots = [model.joint(k) for k in range(model.njnt) if model.joint(k).name.endswith("-right-root/bending")]
    assert len(roots) == 1
    root = roots[0]
    body, axis = int(root.bodyid[0]), data.xaxis[root.id]
    mass, centre = model.body_subtreemass[body], data.subtree_com[body]
    weight = np.array([0.0, 0.0, -mass * GRAVITY_M_PER_S2])
    moment = float(axis @ np.cross(centre - data.xanchor[root.id], weight))
    angle = float(data.qpos[root.qposadr[0]])
    assert abs(angle) > gap_rad / 2
    assert STIFFNESS * (angle - np.sign(angle) * gap_rad / 2) == pytest.approx(moment, rel=1e-6)


@pytest.mark.parametrize("kind", ["bending", "torsion"])
@pytest.mark.parametrize("scenario", ["teaching-beam", "bff"])
def test_the_truth_of_a_wing_with_play_has_modes(scenario: str, kind: str) -> None:
    table = EffectTable(name="root-freeplay", kind=kind, gap_rad=3.5e-4)
    truth = truth_of(load_scenario(scenario).model_copy(update={"effect": (table,)}))
    for model in truth.as_tested:
        assert model.natural_frequency_hz.size
        assert np.isfinite(model.natural_frequency_hz).all()
