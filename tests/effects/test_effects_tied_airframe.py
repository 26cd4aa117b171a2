"""Left and right tied together, or let go: the carry-through spring and the bundle of cables."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import scipy.linalg
import scipy.optimize
from hung_hati import UP, hung_hati, made, with_effect
from numpy.typing import NDArray

from vgvt.scenario import Airframe, Beam, Body, Damping, Item, Scenario, Stations, load_scenario
from vgvt.simulation.assembly import bare_rig, hung_rig, plans, rigid_body
from vgvt.simulation.linear import linearise

BODY_PITCH, GJ, PITCH_PER_M, SPAN_M = 0.04, 20.0, 0.004, 1.0


def straight_wing() -> Scenario:
    """Two straight wings on one line with the body's centre of gravity: torsion is a rod's, apart from bending."""
    stations = Stations(
        position_m=((0.0, 0.0, 0.0), (0.0, SPAN_M, 0.0)),
        bending_stiffness_n_m2=(400.0, 400.0),
        torsional_stiffness_n_m2=(GJ, GJ),
        mass_kg_per_m=(0.5, 0.5),
        pitch_inertia_kg_m=(PITCH_PER_M, PITCH_PER_M),
    )
    airframe = Airframe(
        name="straight",
        body=Body(mass_kg=3.0, centre_of_gravity_m=(0.0, 0.0, 0.0), inertia_kg_m2=(0.02, BODY_PITCH, 0.05)),
        beam=(Beam(name="wing", mirror=True, cells=24, stations=stations),),
        damping=Damping(damping_ratio=0.01),
    )
    whole = load_scenario("quick")
    grid = whole.accelerometers.grid.model_copy(
        update={
            "node": (1, 2),
            "x_m": (0.0, 0.0),
            "y_m": (0.9, -0.9),
            "z_m": None,
            "attached_to": None,
            "direction": None,
        }
    )
    return whole.model_copy(
        update={
            "airframe": airframe,
            "accelerometers": whole.accelerometers.model_copy(update={"grid": grid}),
            "acquisition": whole.acquisition.model_copy(update={"runs": ((1, 2),)}),
            "shaker": whole.shaker.model_copy(update={"position_m": (0.0, 0.1, 0.0), "attached_to": "wing"}),
            "suspension": whole.suspension.model_copy(update={"hook_m": (0.0, 0.0, 0.05)}),
        }
    )


def twisting_hz(scenario: Scenario) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Natural frequencies of the bare airframe in which something turns about y, and of all the others."""
    rig = bare_rig(plans(scenario)[0])
    linear = linearise(rig.model, rig.qpos)
    names = [rig.model.joint(j).name for j in range(rig.model.njnt)]
    turns = np.array([n in ("pitch", "carry-through-middle", "carry-through") or n.endswith("torsion") for n in names])
    for matrix in (linear.mass, linear.stiffness):
        assert np.abs(matrix[np.ix_(turns, ~turns)]).max() < 1e-9 * np.abs(matrix).max()
    squares = [
        scipy.linalg.eigvalsh(linear.stiffness[np.ix_(k, k)], linear.mass[np.ix_(k, k)]) for k in (turns, ~turns)
    ]
    return tuple(np.sqrt(np.abs(s)) / (2 * np.pi) for s in squares)  # type: ignore[return-value]


@pytest.mark.parametrize("compliance", [5e-4, 5e-3])
def test_torsion_is_that_of_two_rods_on_a_spring(compliance: float) -> None:
    """J ω² cos βL + GJ β sin βL = 2 k cos βL with half a body J and β = ω sqrt(I/GJ); for symmetric modes k = 0.

    Each half turns by half of the twist, which makes the spring two springs of 2 k to the plane of symmetry."""

    def balance(hz: float, spring: float) -> float:
        omega = 2 * np.pi * hz
        beta = omega * np.sqrt(PITCH_PER_M / GJ)
        inertia = (BODY_PITCH / 2 * omega**2 - spring) * np.cos(beta * SPAN_M)
        return float(inertia + GJ * beta * np.sin(beta * SPAN_M))

    def roots(spring: float) -> list[float]:
        grid = np.linspace(0.5, 60.0, 4000)
        signs = np.sign([balance(f, spring) for f in grid])
        ends = [(grid[i], grid[i + 1]) for i in np.flatnonzero(np.diff(signs))]
        return [scipy.optimize.brentq(balance, *pair, args=(spring,)) for pair in ends]

    scenario = straight_wing()
    spoiled = with_effect(scenario, "carry-through-torsion", compliance_rad_per_n_m=compliance)
    got, other = twisting_hz(spoiled)
    wanted = sorted(roots(2 / compliance) + roots(0.0))
    # The first is the body's own pitch, free.
    np.testing.assert_allclose(got[1 : len(wanted) + 1], wanted, rtol=2e-3)
    np.testing.assert_allclose(other, twisting_hz(scenario)[1], atol=1e-4)


def test_halved_the_body_weighs_and_balances_the_same() -> None:
    """And what is in the plane of symmetry is shared: symmetric modes cannot tell."""
    scenario = straight_wing()
    ballast = Item(name="ballast", mass_kg=0.5, position_m=(0.1, 0.0, 0.02), attached_to="body")
    scenario = scenario.model_copy(update={"airframe": scenario.airframe.model_copy(update={"item": (ballast,)})})
    halved = with_effect(scenario, "carry-through-torsion", compliance_rad_per_n_m=5e-3)
    one, other = (rigid_body(bare_rig(plans(s)[0])) for s in (halved, scenario))
    assert one.mass_kg == pytest.approx(other.mass_kg, rel=1e-12)
    np.testing.assert_allclose(one.centre_of_gravity_m, other.centre_of_gravity_m, atol=1e-12)
    np.testing.assert_allclose(one.inertia_kg_m2, other.inertia_kg_m2, atol=1e-12)
    models = [linearise(r.model, r.qpos) for r in (bare_rig(plans(s)[0]) for s in (halved, scenario))]
    every = [np.sqrt(np.abs(scipy.linalg.eigvalsh(m.stiffness, m.mass))) / (2 * np.pi) for m in models]
    # Every mode of the whole airframe that is symmetric is one of the halved airframe's, to rounding.
    kept = [f for f in every[1] if np.abs(every[0] - f).min() < 1e-7 * f]
    assert len(kept) >= (len(every[1]) - 6) // 2


def test_compliances_of_the_carry_through_add() -> None:
    first, second = (made("carry-through-torsion", compliance_rad_per_n_m=c) for c in (1e-3, 3e-3))
    once = first.act(straight_wing(), 0).scenario
    assert once is not None
    twice = second.act(once, 0).scenario
    assert twice is not None
    assert twice.airframe.body.carry_through_stiffness_n_m_per_rad == pytest.approx(250.0)


def branches(model: mujoco.MjModel, tendon: str) -> list[list[float]]:
    """What each branch of a bundle's tendon is divided by, of those to either end."""
    k = model.tendon(tendon).id
    wraps = range(model.tendon_adr[k], model.tendon_adr[k] + model.tendon_num[k])
    pulleys = [w for w in wraps if model.wrap_type[w] == mujoco.mjtWrap.mjWRAP_PULLEY]
    found = [(model.site(model.wrap_objid[w + 1]).name, float(model.wrap_prm[w])) for w in pulleys]
    return [[divisor for name, divisor in found if f"/end-{end}/" in name] for end in (0, 1)]


@pytest.mark.parametrize("other", [(0.45, 0.0), (0.9, -1.2)])
def test_a_bundle_adds_its_spring_to_the_difference_of_two_heights(other: tuple[float, float]) -> None:
    """K and C grow by k d dᵀ and c d dᵀ, d the height of one end above the body less that of the other."""
    hati = hung_hati()
    tied = with_effect(
        hati, "cable-bundle", stiffness_n_per_m=50.0, damping_n_s_per_m=0.4, other_x_m=other[0], other_y_m=other[1]
    )
    layout = plans(tied)[0]
    rig, plain = bare_rig(layout), bare_rig(plans(hati)[0])
    ends = [
        [(f"effect-0-0/end-{end}/near-{k}", 1.0 / divisor) for k, divisor in enumerate(divisors)]
        for end, divisors in enumerate(branches(rig.model, "effect-0-0"))
    ]
    data_points = tuple((site, UP) for end in ends for site, _ in end)
    got, without = linearise(rig.model, rig.qpos, data_points), linearise(plain.model, plain.qpos)
    names = [rig.model.joint(j).name for j in range(rig.model.njnt)]
    assert [sum(weight for _, weight in end) for end in ends] == pytest.approx([1.0, 1.0])
    heights = iter(got.displacement)
    one, another = (sum(weight * next(heights) for _, weight in end) for end in ends)
    difference = one - another
    # What the body does as a rigid whole stretches nothing.
    difference[[i for i, name in enumerate(names) if "/" not in name]] = 0.0
    scale = 50.0 * float(difference @ difference)
    np.testing.assert_allclose(
        got.stiffness - without.stiffness, 50.0 * np.outer(difference, difference), atol=2e-6 * scale
    )
    np.testing.assert_allclose(got.damping - without.damping, 0.4 * np.outer(difference, difference), atol=2e-6 * scale)
    assert scale > 10.0


def test_a_bundle_is_at_rest_as_the_aircraft_hangs() -> None:
    """Laid where the drooping wing is, it carries nothing: the aircraft hangs as without it."""
    hati = hung_hati()
    tied = with_effect(hati, "cable-bundle", stiffness_n_per_m=100.0)
    np.testing.assert_allclose(hung_rig(plans(tied)[0], 0).qpos, hung_rig(plans(hati)[0], 0).qpos, atol=1e-9)


@pytest.mark.parametrize(("softer", "droop", "first_bending"), [(1.0, 0.009, 0.0), (8.0, 0.07, -0.013)])
def test_droop_is_in_the_model(softer: float, droop: float, first_bending: float) -> None:
    """What the effects page says of gravity: the droop over the semi-span, and what that shape does to the modes."""
    hati = hung_hati()
    wing = hati.airframe.beam[0]
    columns = ("bending_stiffness_n_m2", "torsional_stiffness_n_m2")
    changed = {name: tuple(v / softer for v in getattr(wing.stations, name)) for name in columns}
    wing = wing.model_copy(update={"stations": wing.stations.model_copy(update=changed)})
    scenario = hati.model_copy(update={"airframe": hati.airframe.model_copy(update={"beam": (wing,)})})
    rig = hung_rig(plans(scenario)[0], 0)
    model = rig.model
    data = mujoco.MjData(model)
    heights = []
    for qpos in (np.concatenate([rig.qpos[:6], np.zeros(model.nq - 6)]), rig.qpos):
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        heights.append(float(data.site("node-9").xpos[2]))
    assert (heights[0] - heights[1]) / 1.53 == pytest.approx(droop, rel=0.25)
    model.opt.gravity[:] = 0.0
    model.tendon_stiffness[model.tendon("suspension").id] = 0.0
    flat, bent = (linearise(model, qpos) for qpos in (np.zeros(model.nq), rig.qpos))
    hz = [np.sqrt(np.abs(scipy.linalg.eigh(m.stiffness, m.mass, eigvals_only=True)))[6:10] for m in (flat, bent)]
    shift = hz[1] / hz[0] - 1
    assert shift[0] == pytest.approx(first_bending, abs=5e-4)
    # 3.35e-4 with 40 and 80 cells a wing, 3.33e-4 with these.
    assert np.abs(shift).max() < (4e-4 if softer == 1.0 else 0.015)
