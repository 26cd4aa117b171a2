"""What effects do to an aircraft that hangs nose down: along it, and about its axes, and not otherwise."""

from __future__ import annotations

from functools import lru_cache

import mujoco
import numpy as np
import pytest
from effect_rig import Complex, accelerance, at_rest, having, largest_error, responses

from vgvt.data import InputError
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation.assembly import Rig, driven_rig, hung_rig, plans
from vgvt.simulation.attached import attach
from vgvt.simulation.linear import LinearModel, joint_force, linearise
from vgvt.simulation.modes import eigenpairs
from vgvt.simulation.reduced import structure
from vgvt.simulation.rig import GRAVITY_M_PER_S2

DRAG: dict[str, object] = {"mass_fraction": 0.0, "drag_n_s_per_m3": 5.0}
HELD_N_M = 20.0
FLAP: dict[str, object] = {"compliance_rad_per_n_m": 10.0, "arm_m": 0.03, "item": "grid-7"}
FLAP_KG = 0.19


@lru_cache(maxsize=2)
def bff(name: str = "bff-hung-aft") -> Scenario:
    """BFF with one run of two sensors that weigh nothing; hung aft it is nose down at 66 degrees."""
    whole = load_scenario(name)
    runs = whole.acquisition.model_copy(update={"runs": ((10, 18),), "repeats": 1})
    weightless = whole.accelerometers.model_copy(update={"mass_kg": 0.0})
    return whole.model_copy(update={"acquisition": runs, "accelerometers": weightless})


def hung(scenario: Scenario) -> tuple[Rig, LinearModel]:
    rig = hung_rig(plans(scenario)[0], 0)
    return rig, linearise(rig.model, rig.qpos)


def between(poles: Complex, low_hz: float, high_hz: float) -> Complex:
    hz = np.abs(poles) / (2 * np.pi)
    return poles[(hz > low_hz) & (hz < high_hz)]


def test_air_drags_at_a_wing_across_it() -> None:
    """As much nose down as level: it had been a seventh, and held the wing back along its chord."""
    gained = {}
    for name in ("bff", "bff-hung-aft"):
        without, with_it = (
            between(eigenpairs(hung(s)[1])[0], 5.0, 9.0)
            for s in (bff(name), having(bff(name), "entrained-air", **DRAG))
        )
        ratios = [-poles.real / np.abs(poles) for poles in (without, with_it)]
        gained[name] = ratios[1] - ratios[0]
    assert gained["bff"].size == 2
    np.testing.assert_allclose(gained["bff-hung-aft"], gained["bff"], rtol=0.08)


@pytest.mark.parametrize("name", ["bff", "bff-hung-aft"])
def test_a_stinger_resists_rotation_about_the_axes_of_the_body(name: str) -> None:
    """Of which yaw is a part, nose down: about the vertical the aircraft had turned freely."""
    rig, free = hung(bff(name))
    _, held = hung(having(bff(name), "stinger-moment", rotational_stiffness_n_m_per_rad=HELD_N_M))
    data, turned = at_rest(rig), np.zeros((3, rig.model.nv))
    mujoco.mj_jacBody(rig.model, data, None, turned, rig.model.body("body").id)
    across = (data.body("body").xmat.reshape(3, 3).T @ turned)[:2]
    np.testing.assert_allclose(held.stiffness - free.stiffness, HELD_N_M * across.T @ across, atol=1e-4)
    yaw = rig.model.joint("yaw").dofadr[0]
    upright = data.body("body").xmat.reshape(3, 3)[2, 2]
    assert (across[:, yaw] ** 2).sum() == pytest.approx(1 - upright**2, abs=1e-9)


@pytest.mark.parametrize("name", ["bff", "bff-hung-aft"])
@pytest.mark.parametrize("axis", ["roll", "pitch"])
def test_a_moment_about_one_axis_is_about_that_one(name: str, axis: str) -> None:
    """Roll turns the aircraft about the line from nose to tail, pitch about the one from wing to wing, as they hang."""
    rig, free = hung(bff(name))
    values: dict[str, object] = {"rotational_stiffness_n_m_per_rad": HELD_N_M, "axis": axis}
    _, held = hung(having(bff(name), "base-strain", **values))
    data, turned = at_rest(rig), np.zeros((3, rig.model.nv))
    mujoco.mj_jacBody(rig.model, data, None, turned, rig.model.body("body").id)
    right, left = (data.body(f"wing-{side}-01").xpos for side in ("right", "left"))
    across = (right - left) / np.linalg.norm(right - left)
    about = across if axis == "pitch" else np.cross(across, data.body("body").xmat.reshape(3, 3)[:, 2])
    np.testing.assert_allclose(
        held.stiffness - free.stiffness, HELD_N_M * np.outer(about @ turned, about @ turned), atol=1e-4
    )


@pytest.mark.parametrize(
    ("effect", "values"),
    [
        ("entrained-air", DRAG),
        ("stinger-moment", {"rotational_stiffness_n_m_per_rad": HELD_N_M}),
        ("base-strain", {"rotational_stiffness_n_m_per_rad": HELD_N_M, "axis": "roll"}),
    ],
)
def test_so_they_are_foretold(effect: str, values: dict[str, object]) -> None:
    """Assembled it is the driven rig; beside a known structure it has its own coordinates' matrices."""
    layout, plain = plans(having(bff(), effect, **values))[0], plans(bff())[0]
    whole, base = (structure(one, one.run_points(0)) for one in (layout, plain))
    assert largest_error(accelerance(whole), responses(having(bff(), effect, **values))[0][:-1]) < 1e-4
    beside = attach(base, plain, layout.elements)
    assert beside is not None
    whole = whole.onto(beside.joints)
    for name in ("stiffness", "damping"):
        got, wanted, without = (getattr(s, name) for s in (beside, whole, base.onto(beside.joints)))
        change = np.abs(wanted - without).max()
        assert np.abs(got - wanted).max() <= 1e-4 * max(change, 1e-9)


@pytest.mark.parametrize("name", ["bff", "bff-hung-aft"])
@pytest.mark.parametrize("effect", ["control-surface", "control-surface-freeplay"])
def test_a_control_surface_hangs_in_line_with_its_wing(name: str, effect: str) -> None:
    """Trimmed as if level it hung by 40 degrees, nose down: its weight swings it, and has been carried."""
    play = {} if effect == "control-surface" else {"gap_rad": 0.01}
    scenario = having(bff(name), effect, side="left", **FLAP, **play)
    driven = driven_rig(plans(scenario)[0], 0)
    assert np.abs(joint_force(driven.model, at_rest(driven))).max() < 1e-6
    rig, linear = hung(scenario)
    data, hinge = at_rest(rig), rig.model.joint("effect-0-0/flap")
    assert abs(rig.qpos[hinge.qposadr[0]]) < 1e-5
    without, _ = hung(bff(name))
    level = [at_rest(r).body("body").xmat for r in (rig, without)]
    np.testing.assert_allclose(*level, atol=1e-5)
    # The weight's potential m g z, turned about the hinge: the centre of gravity falls from how high it stands.
    axis, arm = data.xaxis[hinge.id], data.xipos[rig.model.body("effect-0-0").id] - data.xanchor[hinge.id]
    stands_m = (arm - axis * (axis @ arm))[2]
    own = linear.stiffness[hinge.dofadr[0], hinge.dofadr[0]]
    assert own == pytest.approx(0.1 - FLAP_KG * GRAVITY_M_PER_S2 * stands_m, rel=1e-6)
    assert (own < 0.06) == (name == "bff-hung-aft")
    if play:
        # Leant on by its weight, with all of the play on the other side.
        near, far = sorted(rig.model.tendon_lengthspring[rig.model.tendon("effect-0-0").id], key=abs)
        leans = data.qfrc_bias[hinge.dofadr[0]] / 0.1
        assert (near, far) == pytest.approx((leans, leans + np.copysign(0.01, leans)), abs=1e-6)


def test_a_flap_that_its_weight_turns_over_is_refused() -> None:
    """Nose down the weight of a soft one is stronger than its spring: it stands on its hinge."""
    with pytest.raises(InputError, match="would fall over its hinge"):
        hung(having(bff(), "control-surface", **(FLAP | {"compliance_rad_per_n_m": 40.0})))


def test_a_flap_beside_a_known_aircraft_is_swung_by_its_weight() -> None:
    """The rows of its own hinge are those that assembling gives: nose down its spring alone had been twice as stiff."""
    plain, layout = bff(), plans(having(bff(), "control-surface", **FLAP))[0]
    first = plans(plain)[0]
    beside = attach(structure(first, first.run_points(0)), first, layout.elements)
    assert beside is not None
    whole = structure(layout, layout.run_points(0)).onto(beside.joints)
    own = beside.joints.index("effect-0-0/flap")
    for name in ("mass", "stiffness", "damping"):
        np.testing.assert_allclose(getattr(beside, name)[own], getattr(whole, name)[own], atol=1e-6)


@pytest.mark.parametrize("y_m", [0.0, 0.9, -0.9])
def test_an_absorber_beside_a_known_aircraft_is_pulled_by_its_weight(y_m: float) -> None:
    """Along its slide, by the part that the airframe turns there: it had been a spring's alone."""
    plain = bff()
    loose: dict[str, object] = {"mass_kg": 0.002, "frequency_hz": 5.0, "x_m": 0.7, "y_m": y_m}
    layout, first = plans(having(plain, "local-absorber", **loose))[0], plans(plain)[0]
    beside = attach(structure(first, first.run_points(0)), first, layout.elements)
    assert beside is not None
    whole = structure(layout, layout.run_points(0)).onto(beside.joints)
    own = beside.joints.index("effect-0-0/absorber")
    got, wanted = (np.delete(s.stiffness[own], own) for s in (beside, whole))
    # m g sin(66 degrees), per radian of pitch: less what so light a mass tips the aircraft by.
    assert np.abs(wanted).max() > 0.9 * 0.002 * GRAVITY_M_PER_S2
    np.testing.assert_allclose(got, wanted, atol=0.02 * np.abs(wanted).max())
