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


@pytest.mark.parametrize("kind", ["bending", "torsion"])
@pytest.mark.parametrize("scenario", ["teaching-beam", "teaching-beam-hammer", "bff", "garteur-sm-ag19"])
def test_a_wing_rests_where_its_root_bears_what_hangs_on_it(scenario: str, kind: str) -> None:
    """On a stop the root's spring, beyond the gap, bears the moment of all outboard; within it there is none."""
    beam = "wing" if scenario.startswith("garteur") else ""
    for gap_rad in np.geomspace(2e-5, 2e-2, 7):
        table = EffectTable(name="root-freeplay", kind=kind, gap_rad=float(gap_rad), beam=beam)
        rig = driven_rig(plans(load_scenario(scenario).model_copy(update={"effect": (table,)}))[0], 0)
        model, data = rig.model, mujoco.MjData(rig.model)
        data.qpos[:] = rig.qpos
        mujoco.mj_forward(model, data)
        joints = [model.joint(k) for k in range(model.njnt)]
        (root,) = [j for j in joints if j.name.endswith(f"right-root/{kind}")]
        body = int(root.bodyid[0])
        weight = np.array([0.0, 0.0, -model.body_subtreemass[body] * GRAVITY_M_PER_S2])
        moment = float(data.xaxis[root.id] @ np.cross(data.subtree_com[body] - data.xanchor[root.id], weight))
        angle = float(data.qpos[root.qposadr[0]])
        beyond = max(abs(angle) - gap_rad / 2, 0.0)
        assert STIFFNESS * np.sign(angle) * beyond == pytest.approx(moment, rel=1e-6, abs=1e-7), gap_rad
        assert kind == "torsion" or beyond > 0


@pytest.mark.parametrize("kind", ["bending", "torsion"])
@pytest.mark.parametrize("scenario", ["teaching-beam", pytest.param("bff", marks=pytest.mark.slow)])
def test_the_truth_of_a_wing_with_play_has_modes(scenario: str, kind: str) -> None:
    """Sensors rove, and each run rests elsewhere: one of them between the stops, within reach of a difference."""
    table = EffectTable(name="root-freeplay", kind=kind, gap_rad=5e-3)
    truth = truth_of(load_scenario(scenario).model_copy(update={"effect": (table,)}))
    for model in truth.as_tested:
        assert model.natural_frequency_hz.size
        assert np.isfinite(model.natural_frequency_hz).all()
