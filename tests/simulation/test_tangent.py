"""The stiffness in closed form is what forces do: against differences of them, and by hand."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from effect_rig import having
from numpy.typing import NDArray

from vgvt.scenario import load_scenario
from vgvt.simulation import linear
from vgvt.simulation.assembly import bare_rig, driven_rig, plans
from vgvt.simulation.linear import joint_force, settle, stiffness_matrix
from vgvt.simulation.settling import settle_near
from vgvt.simulation.tangent import tangent_stiffness

Array = NDArray[np.float64]

PENDULUM = """
<mujoco>
  <compiler angle="radian"/>
  <option gravity="0 0 -9"/>
  <worldbody>
    <body>
      <joint name="turn" type="hinge" axis="0 1 0" stiffness="{spring}"/>
      <inertial pos="0 0 -2" mass="3" diaginertia="1 1 1"/>
      <body pos="0 0 -2" gravcomp="{held}">
        <joint name="slip" type="slide" axis="1 0 0" stiffness="4"/>
        <inertial pos="0 0 0" mass="5" diaginertia="1 1 1"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""

BENT = """
<mujoco>
  <compiler angle="radian"/>
  <option gravity="1 -2 -9"/>
  <worldbody>
    <site name="near" pos="0 0.3 1"/>
    <site name="off" pos="0.5 1 1"/>
    <body>
      <joint name="a" type="hinge" axis="1 2 3" stiffness="7 2 5" springref="0.1"/>
      <joint name="b" type="slide" axis="1 0 1"/>
      <inertial pos="0.1 0 0.2" mass="2" diaginertia="1 1 1"/>
      <site name="one" pos="0.3 0.1 0"/>
      <body pos="0.5 0 0.1">
        <joint name="c" type="hinge" axis="0 1 0.2"/>
        <joint name="d" type="hinge" axis="1 0 0" pos="0 0.1 0"/>
        <inertial pos="0 0.3 0" mass="1" diaginertia="1 1 1"/>
        <site name="two" pos="0.1 0.2 0.3"/>
        <body pos="0 0.1 0"><inertial pos="0.2 0.3 0" mass="1.5" diaginertia="1 1 1"/></body>
      </body>
      <body pos="-0.5 0 0.1" gravcomp="1">
        <joint name="e" type="hinge" axis="0 1 0"/>
        <inertial pos="0 0.3 0.1" mass="1" diaginertia="1 1 1"/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <spatial name="rope" stiffness="30 4 9" springlength="0.2">
      <site site="near"/><site site="one"/><site site="two"/>
      <pulley divisor="2"/><site site="off"/><site site="two"/>
    </spatial>
    <spatial name="loose" stiffness="50" springlength="0.1 9"><site site="near"/><site site="two"/></spatial>
    <fixed name="gear" stiffness="11 3 2" springlength="-0.01 0.02">
      <joint joint="a" coef="2"/><joint joint="d" coef="-1"/><joint joint="e" coef="0.5"/>
    </fixed>
  </tendon>
</mujoco>
"""


def by_differences(model: mujoco.MjModel, qpos: Array, step: float = 1e-4) -> Array:
    """What forces do (nv, nv), by differences of two steps, which leave the fourth power of them."""
    data = mujoco.MjData(model)

    def change(size: float) -> Array:
        columns = []
        for aside in np.eye(model.nv) * size:
            ends = []
            for side in (qpos - aside, qpos + aside):
                data.qpos[:] = side
                ends.append(joint_force(model, data))
            columns.append((ends[0] - ends[1]) / (2 * size))
        return np.array(columns).T

    return (4 * change(step) - change(2 * step)) / 3


def closed(model: mujoco.MjModel, qpos: Array) -> Array:
    """The closed form at a position (nq,)."""
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    found = tangent_stiffness(model, data)
    assert found is not None
    return found


@pytest.mark.parametrize(("held", "falling"), [(0, 5.0), (1, 0.0)])
def test_a_pendulum_by_hand(held: int, falling: float) -> None:
    """Its own weight and what slides on it: (3 + 5) · 9 · 2 about the hinge, and -5 · 9 between the two.

    What slides out along x is lowered by a turn about y.
    """
    model = mujoco.MjModel.from_xml_string(PENDULUM.format(spring=6, held=held))
    wanted = [[6 + (3 + falling) * 9 * 2, -falling * 9], [-falling * 9, 4.0]]
    np.testing.assert_allclose(closed(model, np.zeros(2)), wanted, atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_anything_bent_is_as_stiff_as_its_forces_say(seed: int) -> None:
    """Hinges and slides askew, springs of higher powers, ropes over pulleys, gears with play, what has no weight."""
    model = mujoco.MjModel.from_xml_string(BENT)
    qpos = 0.3 * np.random.default_rng(seed).standard_normal(model.nq)
    found = closed(model, qpos)
    np.testing.assert_allclose(found, by_differences(model, qpos), atol=1e-7 * np.abs(found).max())
    np.testing.assert_allclose(found, found.T, atol=1e-12 * np.abs(found).max())


def test_within_its_play_a_tendon_holds_nothing() -> None:
    """The gear within its gap, at the end of it, and beyond, on top of what everything else does."""
    model = mujoco.MjModel.from_xml_string(BENT)
    gear, row = model.tendon("gear").id, np.array([2.0, 0.0, 0.0, -1.0, 0.5])
    model.opt.gravity[:], model.jnt_stiffness[:], model.jnt_stiffnesspoly[:] = 0.0, 0.0, 0.0
    model.tendon_stiffness[np.arange(model.ntendon) != gear] = 0.0
    model.tendon_stiffnesspoly[np.arange(model.ntendon) != gear] = 0.0
    for angle, beyond in ((0.005, 0.0), (0.01, 0.0), (0.02, 0.02), (-0.015, -0.02)):
        rate = 11 + 2 * 3 * beyond + 3 * 2 * beyond**2 if beyond else 0.0
        got = closed(model, np.array([angle, 0.0, 0.0, 0.0, 0.0]))
        np.testing.assert_allclose(got, rate * np.outer(row, row), atol=1e-12)


@pytest.mark.parametrize("name", ["hati-unsymmetric", "garteur-sm-ag19", "bff"])
def test_a_driven_aircraft(name: str) -> None:
    """At rest, and off it, with all its tendons: suspension, stinger, dampers of modes."""
    rig = driven_rig(plans(load_scenario(name))[0], 0)
    aside = 0.01 * np.random.default_rng(2).standard_normal(rig.model.nq)
    for qpos in (rig.qpos, rig.qpos + aside):
        found = closed(rig.model, qpos)
        np.testing.assert_allclose(found, by_differences(rig.model, qpos), atol=1e-6 * np.abs(found).max())


@pytest.mark.parametrize(
    ("effect", "parameters"),
    [
        ("root-freeplay", {"gap_rad": 0.002}),
        ("cubic-root-stiffness", {"cubic_n_m_per_rad3": 2e4}),
        ("cable-bundle", {}),
        ("suspension-hardening", {}),
        ("frame-resonance", {}),
        ("control-surface", {}),
        ("stinger-moment", {}),
        ("entrained-air", {}),
        ("carry-through-torsion", {}),
        ("bend-twist-coupling", {}),
        ("viscoelastic-stiffness", {}),
        ("rattling-mass", {}),
    ],
)
def test_an_aircraft_with_an_effect(effect: str, parameters: dict[str, float]) -> None:
    """What effects lay across it: play, powers, pairs of points over a pulley, gears, bodies without weight."""
    rig = driven_rig(plans(having(load_scenario("quick"), effect, **parameters))[0], 0)
    qpos = rig.qpos + 0.003 * np.random.default_rng(5).standard_normal(rig.model.nq)
    found = closed(rig.model, qpos)
    np.testing.assert_allclose(found, by_differences(rig.model, qpos, 1e-6), atol=2e-6 * np.abs(found).max())


def test_what_it_does_not_know_is_asked_by_differences() -> None:
    """Springs that have warmed up are an actuator's: no closed form, and the same answer as ever."""
    model = bare_rig(plans(having(load_scenario("quick"), "warm-up", softening=0.1))[0]).model
    data, unloaded = mujoco.MjData(model), np.zeros(model.nq)
    cold = closed(model, unloaded)
    data.act[:] = 1.0
    assert tangent_stiffness(model, data) is None
    np.testing.assert_allclose(stiffness_matrix(model, data, unloaded), 0.9 * cold, atol=1e-6 * np.abs(cold).max())


def test_a_ball_joint_is_not_known() -> None:
    ball = "<mujoco><worldbody><body><joint type='ball'/><geom size='1'/></body></worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(ball)
    assert tangent_stiffness(model, mujoco.MjData(model)) is None


def test_a_rig_comes_to_rest_where_its_forces_do(monkeypatch: pytest.MonkeyPatch) -> None:
    """By the closed form and by differences alike."""
    model = driven_rig(plans(load_scenario("quick"))[0], 0).model
    found = settle(model)
    assert np.abs(found).max() > 1e-4
    monkeypatch.setattr(linear, "tangent_stiffness", lambda model, data: None)
    np.testing.assert_allclose(found, settle(model), atol=1e-9)


def test_what_nothing_holds_has_no_rest_nearby() -> None:
    """A coordinate without any stiffness, as a joint within its gap: left to the way downhill."""
    loose = PENDULUM.replace('stiffness="4"', "").format(spring=6, held=1)
    model = mujoco.MjModel.from_xml_string(loose)
    assert np.linalg.matrix_rank(closed(model, np.zeros(2))) == 1
    assert settle_near(model, np.array([0.1, 0.0]), None) is None


PUSHED = """
<mujoco>
  <compiler angle="radian"/>
  <option gravity="0 0 -9" {option}>{flags}</option>
  <worldbody>
    <body>
      <joint name="turn" type="hinge" axis="0 1 0" stiffness="6" {joint}/>
      <inertial pos="0 0 -2" mass="3" diaginertia="1 1 1"/>
      <geom size="0.1" contype="0" conaffinity="0"/>
    </body>
    {beside}
  </worldbody>
  <actuator>{actuator}</actuator>
</mujoco>
"""


def pushed(**parts: str) -> mujoco.MjModel:
    words = {name: parts.get(name, "") for name in ("option", "flags", "joint", "beside", "actuator")}
    return mujoco.MjModel.from_xml_string(PUSHED.format(**words))


@pytest.mark.parametrize(
    "parts",
    [
        {"flags": '<flag spring="disable"/>'},
        {"flags": '<flag gravity="disable"/>'},
        {"option": 'density="1.2" wind="5 0 0"'},
        {"joint": 'actuatorgravcomp="true"'},
        {"actuator": '<motor joint="turn" ctrlrange="1 2" ctrllimited="true"/>'},
        {"actuator": '<motor joint="turn" forcerange="1 2" forcelimited="true"/>'},
        {"joint": 'actuatorfrcrange="1 2" actuatorfrclimited="true"', "actuator": '<motor joint="turn"/>'},
        {"actuator": '<position joint="turn" kp="3"/>'},
    ],
    ids=str,
)
def test_what_may_push_is_not_known(parts: dict[str, str]) -> None:
    """Forces that this does not ask about, or does not find: differences see them."""
    model = pushed(**parts)
    assert tangent_stiffness(model, mujoco.MjData(model)) is None


@pytest.mark.parametrize(
    "parts",
    [
        {"option": 'density="1.2"'},
        {"actuator": '<motor joint="turn" ctrlrange="-1 2" ctrllimited="true"/>'},
        {"beside": '<body mocap="true" pos="1 1 1"><geom size="0.2"/></body>'},
    ],
    ids=str,
)
def test_what_does_nothing_at_rest_changes_nothing(parts: dict[str, str]) -> None:
    """Least of all a body that hangs on no joint, which is its own anchor."""
    model = pushed(**parts)
    bent = np.array([0.2])
    np.testing.assert_allclose(closed(model, bent), [[6 + 9 * 3 * 2 * np.cos(0.2)]], rtol=1e-12)
    np.testing.assert_allclose(closed(model, bent), by_differences(model, bent), rtol=1e-6)


def test_what_moves_and_ropes_without_length_are_not_known() -> None:
    model = pushed()
    data = mujoco.MjData(model)
    data.qvel[:] = 1.0
    assert tangent_stiffness(model, data) is None
    joined = BENT.format().replace('<site name="one" pos="0.3 0.1 0"/>', '<site name="one" pos="0 0.3 1"/>')
    together = mujoco.MjModel.from_xml_string(joined)
    assert tangent_stiffness(together, mujoco.MjData(together)) is None
