"""A joint with play has no stiffness where Newton's method begins: the weight finds the stop that it rests on."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.scenario import load_scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import truth_of
from vgvt.simulation.assembly import driven_rig, plans
from vgvt.simulation.linear import joint_force, settle
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


@pytest.mark.parametrize(("beam", "kind", "gap_rad"), [
    ("nose", "torsion", 1e-3), ("nose", "bending", 8.7e-3), ("tail", "torsion", 8.7e-3), ("fin", "torsion", 1e-3),
    ("fin", "torsion", 8.7e-3), ("wing-mount", "torsion", 1e-3), ("tailplane", "torsion", 8.7e-3),
])  # fmt: skip
def test_a_joint_between_its_stops_finds_the_one_that_it_rests_on(beam: str, kind: str, gap_rad: float) -> None:
    """What Newton's step leads across the gap leads back from there: without a search along it there is no end."""
    table = EffectTable(name="root-freeplay", kind=kind, gap_rad=gap_rad, beam=beam)
    rig = driven_rig(plans(load_scenario("garteur-sm-ag19").model_copy(update={"effect": (table,)}))[0], 0)
    data = mujoco.MjData(rig.model)
    data.qpos[:] = rig.qpos
    assert np.abs(joint_force(rig.model, data)).max() < 1e-8
    assert np.abs(rig.qpos).max() < 0.1


@pytest.mark.parametrize("angle", [0.5, 2.0, 3.0])
def test_a_search_along_the_step_finds_no_rest_upside_down(angle: float) -> None:
    """A mast that falls over its stops, whose tip is heavy: it hangs below its hinge, which is no rest nearby."""
    spring = f'<fixed name="stop" stiffness="1" springlength="-{angle} {angle}"><joint joint="hinge" coef="1"/></fixed>'
    mast = '<body><joint name="hinge" axis="0 1 0"/><geom type="sphere" size="0.1" pos="0 0 1" mass="1"/></body>'
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{mast}</worldbody><tendon>{spring}</tendon></mujoco>")
    with pytest.raises(RuntimeError, match="would turn over"):
        settle(model)


def test_an_aircraft_that_finds_no_rest_is_not_told_of_a_hook_that_is_high_enough() -> None:
    """What gives way is named instead: a mass on next to no spring sags for ever."""
    table = EffectTable(name="local-absorber", mass_kg=0.1, frequency_hz=1e-3)
    soft = load_scenario("teaching-beam").model_copy(update={"effect": (table,)})
    with pytest.raises(InputError, match=r"finds no rest .*'effect-0-0.*' gives way") as caught:
        driven_rig(plans(soft)[0], 0)
    assert "Put the hook" not in str(caught.value)
    assert "stiffer" in str(caught.value)


@pytest.mark.parametrize("kind", ["bending", "torsion"])
@pytest.mark.parametrize("scenario", ["teaching-beam", pytest.param("bff", marks=pytest.mark.slow)])
def test_the_truth_of_a_wing_with_play_has_modes(scenario: str, kind: str) -> None:
    """Sensors rove, and each run rests elsewhere: one of them between the stops, within reach of a difference."""
    table = EffectTable(name="root-freeplay", kind=kind, gap_rad=5e-3)
    truth = truth_of(load_scenario(scenario).model_copy(update={"effect": (table,)}))
    for model in truth.as_tested:
        assert model.natural_frequency_hz.size
        assert np.isfinite(model.natural_frequency_hz).all()
