"""A centre body of two halves: what is in the plane of symmetry is on the middle and moves by the mean of both."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from effect_rig import AFT, FORE, effect_rig, largest_error
from hung_hati import with_effect
from numpy.typing import NDArray
from small_rig import revised
from test_large_aircraft import enlarged

from vgvt.scenario import Item, Scenario, load_scenario
from vgvt.simulation import simulated_campaign, truth_of
from vgvt.simulation.airframe import ROOT, cut_airframe
from vgvt.simulation.assembly import Rig, bare_rig, driven_rig, gauged_rig, hung_rig, plan, plans
from vgvt.simulation.effect_conformance import ENGINES_AGREE
from vgvt.simulation.halves import CARRY_THROUGH, LEFT_HALF, RIGHT_HALF, RIGHT_OF_MIDDLE
from vgvt.simulation.linear import LinearModel, linearise
from vgvt.simulation.modes import eigenpairs
from vgvt.simulation.picture import drawing_of
from vgvt.simulation.reduced import Layouts

Array = NDArray[np.float64]
FREQUENCY_HZ = np.linspace(4.0, 40.0, 145)
ASIDE_M = 0.01
LOSS_S = 2e-4
STIFFNESSES = (5000.0, 300.0, 100.0)


def halved(scenario: Scenario, stiffness_n_m_per_rad: float | None) -> Scenario:
    """The scenario with a carry-through of some stiffness, or with a rigid one."""
    return revised(scenario, airframe={"body": body_of(scenario, stiffness_n_m_per_rad)})


def body_of(scenario: Scenario, stiffness_n_m_per_rad: float | None) -> object:
    """The centre body with a carry-through of some stiffness."""
    return scenario.airframe.body.model_copy(update={"carry_through_stiffness_n_m_per_rad": stiffness_n_m_per_rad})


def symmetric(drive_y_m: float = 0.0) -> Scenario:
    """Hati with nothing that is on one side alone, hung and driven in its plane of symmetry, or beside it."""
    whole = load_scenario("hati-symmetric")
    x, _, z = whole.shaker.position_m
    hook = whole.suspension.hook_m
    items = tuple(item for item in whole.airframe.item if item.mirror)
    beam = whole.airframe.beam[0].model_copy(update={"cells": 6})
    # Ratios go to modes by number, and two halves have one mode more.
    damping = whole.airframe.damping.model_copy(update={"modal": ()})
    return revised(
        whole,
        airframe={"item": items, "beam": (beam,), "damping": damping},
        accelerometers={"mass_kg": 0.0},
        shaker={"position_m": (x, drive_y_m, z)},
        suspension={"hook_m": (hook[0], 0.0, hook[2])},
    )


def accelerances(model: LinearModel) -> NDArray[np.complex128]:
    """A/F (points, lines) for a force along the last row."""
    omega = 2 * np.pi * FREQUENCY_HZ[:, None, None]
    dynamic = model.stiffness + 1j * omega * model.damping - omega**2 * model.mass
    motion = np.linalg.solve(dynamic, model.displacement[-1][None, :, None])[..., 0]
    return np.asarray(-(omega[..., 0] ** 2) * (motion @ model.displacement.T), dtype=np.complex128).T


def as_hung(scenario: Scenario) -> tuple[Rig, NDArray[np.complex128]]:
    """The hung rig with all but its shaker, and its A/F at all points, the drive point's last."""
    layout = plans(scenario)[0]
    rig = gauged_rig(layout, 0, driven_rig(layout, 0).qpos)
    return rig, accelerances(linearise(rig.model, rig.qpos, tuple((p.site, p.axis) for p in layout.points)))


def mirrored_pairs(scenario: Scenario) -> list[tuple[int, int]]:
    """Indices of the points on the right and of their mirror images."""
    place = {tuple(np.round(p.position_m, 6)): k for k, p in enumerate(plan(scenario).points)}
    return [(k, place[x, -y, z]) for (x, y, z), k in place.items() if y > 0]


@pytest.mark.parametrize("stiffness", STIFFNESSES)
def test_what_is_symmetric_stays_so_however_soft_the_carry_through(stiffness: float) -> None:
    """With hook and shaker on one half it hung twisted by 3.9 to 38.7 mrad, and up to 1.3 of the answer was not."""
    rigid, soft = (as_hung(halved(symmetric(), k)) for k in (None, stiffness))
    rig, got = soft
    assert abs(rig.qpos[rig.model.joint(CARRY_THROUGH).qposadr[0]]) < 1e-9
    right, left = np.array(mirrored_pairs(symmetric())).T
    assert len(right) == 10
    assert np.abs(got[right] - got[left]).max() < 1e-6 * np.abs(got[right]).max()
    assert largest_error(got, rigid[1]) < 1e-3
    np.testing.assert_allclose(rig.qpos[:6], rigid[0].qpos[:6], atol=1e-8)


@pytest.mark.parametrize("stiffness", STIFFNESSES)
def test_the_middle_is_the_mean_of_both_halves(stiffness: float) -> None:
    """Two halves alone, in numpy: rows of force, response and a lump are the mean of those of the same point on either.

    To within a hundredth of a way to the roots, 1.9 mm here, it is the plane of symmetry.
    """
    ballast = Item(name="ballast", mass_kg=0.5, position_m=(0.1, 0.0, 0.03), attached_to="body")
    lump = np.array(ballast.position_m)
    two = halved(load_scenario("hati-symmetric"), stiffness)
    layout = plan(two)
    bare = bare_rig(layout)
    model, data = bare.model, mujoco.MjData(bare.model)
    linear = linearise(model, bare.qpos, tuple((p.site, p.axis) for p in layout.grid))
    geared, twist = (int(model.joint(name).dofadr[0]) for name in (RIGHT_OF_MIDDLE, CARRY_THROUGH))
    reduce = np.delete(np.eye(model.nv), geared, axis=1)
    reduce[geared] = -0.5 * reduce[twist]
    mujoco.mj_forward(model, data)

    def mean_rows(place: Array) -> Array:
        rows = np.zeros((2, 3, model.nv))
        for row, half in zip(rows, (RIGHT_HALF, LEFT_HALF), strict=True):
            mujoco.mj_jac(model, data, row, None, place, model.body(half).id)
        return np.asarray(rows.mean(axis=0)) @ reduce

    at_lump, drive = mean_rows(lump), mean_rows(layout.drive.position_m)[2]
    mass = reduce.T @ linear.mass @ reduce + ballast.mass_kg * at_lump.T @ at_lump
    stiff = reduce.T @ linear.stiffness @ reduce
    heavy = plan(revised(two, airframe={"item": (*two.airframe.item, ballast)}))
    whole = bare_rig(heavy)
    there = linearise(whole.model, whole.qpos, tuple((p.site, p.axis) for p in heavy.points))
    rows = np.vstack([linear.displacement @ reduce, drive])
    # The ratios that are stated are those of modes with the lump: here both lose alike instead.
    wanted = accelerances(LinearModel(mass, LOSS_S * stiff, stiff, rows, np.zeros(len(mass))))
    lossy = replace(there, damping=LOSS_S * there.stiffness)
    assert largest_error(accelerances(lossy), wanted) < 5e-4


def test_points_cross_from_half_to_half_through_the_middle() -> None:
    parts = cut_airframe(halved(symmetric(), 300.0).airframe)
    places = {y: parts.carrier("body", np.array([0.5, y, 0.0])) for y in (-0.1, -0.003, -0.0015, 0.0, 0.0015, 0.003)}
    assert list(places.values()) == [LEFT_HALF, LEFT_HALF, ROOT, ROOT, ROOT, RIGHT_HALF]
    for y, carrier in places.items():
        assert parts.shares("body", np.array([0.5, y, 0.0])) == ((carrier, 1.0),)
    whole = cut_airframe(symmetric().airframe)
    assert {whole.carrier("body", np.array([0.5, y, 0.0])) for y in places} == {ROOT}


@pytest.mark.parametrize("stiffness", STIFFNESSES)
def test_far_responses_are_the_mean_of_those_to_a_force_on_either_half(stiffness: float) -> None:
    """Between a drive point to the left and one to the right they differed from either by up to 240 %."""

    def bare(y_m: float) -> NDArray[np.complex128]:
        layout = plan(halved(symmetric(y_m), stiffness))
        rig = bare_rig(layout)
        return accelerances(linearise(rig.model, rig.qpos, tuple((p.site, p.axis) for p in layout.points)))[:-1]

    left, middle, right = (bare(y) for y in (-ASIDE_M, 0.0, ASIDE_M))
    assert largest_error(middle, (left + right) / 2) < 1e-3
    assert largest_error(left, right) > 0.1


@pytest.mark.parametrize("stiffness", STIFFNESSES)
def test_the_gear_is_no_mode_and_takes_no_damping(stiffness: float) -> None:
    """Modes of the bare airframe have the ratios that are stated, and there is one more than on a rigid body."""
    scenario = halved(symmetric(), stiffness)
    found, rigid = (bare_poles(s) for s in (scenario, symmetric()))
    # The gear's own two poles do not oscillate.
    assert len(found) == len(rigid) + 1
    stated = scenario.airframe.damping
    exact = np.abs(found) <= 2 * np.pi * stated.limit_hz
    assert exact.sum() >= 3
    np.testing.assert_allclose((-found.real / np.abs(found))[exact], stated.damping_ratio, rtol=1e-5)


def bare_poles(scenario: Scenario) -> NDArray[np.complex128]:
    """Oscillating poles of the bare airframe, rad/s."""
    bare = bare_rig(plan(scenario))
    poles = eigenpairs(linearise(bare.model, bare.qpos))[0]
    return np.asarray(poles[np.abs(poles) > 2 * np.pi])


@pytest.mark.parametrize(
    ("effect", "parameters"),
    [
        (None, {}),
        ("stinger-moment", {"rotational_stiffness_n_m_per_rad": 30.0}),
        ("mount-compliance", {"compliance_m_per_n": 5e-5}),
        ("local-absorber", {"x_m": 0.5, "y_m": 0.0, "mass_kg": 0.2, "frequency_hz": 12.0}),
        ("loose-sensor-mount", {"node": FORE}),
    ],
)
def test_both_engines_see_the_same_on_the_middle(effect: str | None, parameters: dict[str, object]) -> None:
    """Shaker, hook, two sensors and what an effect adds are in the plane of symmetry."""
    scenario = effect_rig()
    x, _, z = scenario.shaker.position_m
    scenario = revised(
        scenario,
        shaker={"position_m": (x, 0.0, z)},
        accelerometers={"mass_kg": 0.003},
        excitation={"duration_s": 1.5, "taper_s": 0.2, "ring_down_s": 0.5},
    )
    scenario = halved(scenario, 200.0)
    if effect is not None:
        scenario = with_effect(scenario, effect, **parameters)
    stepped, solved = (simulated_campaign(scenario, engine=engine).runs[0].samples for engine in ("mujoco", "linear"))
    for got, wanted in zip(stepped[1:], solved[1:], strict=True):
        assert np.linalg.norm(got - wanted) < ENGINES_AGREE * np.linalg.norm(wanted)
    layout = plans(scenario)[0]
    assert {p.carrier for p in layout.run_points(0) if p.dof.node in (FORE, AFT)} == {ROOT}


def test_a_plan_of_an_edited_scenario_puts_sensors_on_the_halves() -> None:
    """Left where they are on a rigid body, those to the left of the plane would have been on the other half."""
    whole = effect_rig()
    layouts = Layouts.of(whole)
    edited = halved(whole, 300.0)
    assert [p.carrier for p in layouts.plan(edited).grid] == [p.carrier for p in plan(edited).grid]


def test_halves_of_any_size_come_to_rest() -> None:
    """The gear's spring is far stiffer than what it carries: of a 400 t aircraft its rounding was more than allowed."""
    small = halved(load_scenario("quick"), 300.0)
    model, large = (truth_of(s).as_tested[0].natural_frequency_hz for s in (small, enlarged(small, 40.0)))
    np.testing.assert_allclose(large[:9] * np.sqrt(40.0), model[:9], rtol=1e-5)


def test_twisted_by_one_sided_weight_it_rests_by_its_spring() -> None:
    """The halves of one that is heavier on the right twist by the difference of their moments over twice the spring."""
    lump = Item(name="lump", mass_kg=0.05, position_m=(0.9, 0.1, 0.0), attached_to="body")
    scenario = symmetric()
    scenario = halved(revised(scenario, airframe={"item": (*scenario.airframe.item, lump)}), 100.0)
    rig = hung_rig(plans(scenario)[0], 0)
    twist = float(rig.qpos[rig.model.joint(CARRY_THROUGH).qposadr[0]])
    data = mujoco.MjData(rig.model)
    data.qpos[:] = rig.qpos
    mujoco.mj_forward(rig.model, data)
    # Moments of weight about the hinge, nose up, of the left half and of both; the middle's gear gives each half of it.
    left, both = (_nose_up(rig.model, data, name) for name in (LEFT_HALF, RIGHT_HALF))
    assert 100.0 * twist == pytest.approx(left - both / 2, abs=1e-6)
    assert abs(twist) > 5e-4


def _nose_up(model: mujoco.MjModel, data: mujoco.MjData, name: str) -> float:
    """The moment about its hinge of the weight of all that hangs on a body."""
    body = model.body(name).id
    joint = int(model.body_jntadr[body])
    weight = np.array([0.0, 0.0, -9.80665 * model.body_subtreemass[body]])
    return float(data.xaxis[joint] @ np.cross(data.subtree_com[body] - data.xanchor[joint], weight))


def test_halves_are_drawn() -> None:
    """Each with what of its wing is rigid with it, where the roots are in the plane, too."""
    whole = load_scenario("quick")
    wing = whole.airframe.beam[0]
    (x, _, z), *rest = wing.stations.position_m
    stations = wing.stations.model_copy(update={"position_m": ((x, 0.0, z), *rest)})
    joined = revised(whole, airframe={"beam": (wing.model_copy(update={"stations": stations}),)})
    drawn = drawing_of(halved(joined, 300.0)).rig.model
    owner = {drawn.mesh(drawn.geom_dataid[g]).name: drawn.body(drawn.geom_bodyid[g]).name for g in meshes(drawn)}
    assert owner["wing-right/skin-0"] == RIGHT_HALF
    assert owner["wing-left/skin-0"] == LEFT_HALF


def meshes(model: mujoco.MjModel) -> list[int]:
    """The geoms that are meshes."""
    return [g for g in range(model.ngeom) if model.geom_type[g] == mujoco.mjtGeom.mjGEOM_MESH]
