"""Plans of edited scenarios: where an edit moves no point they are made from one that is there, and are the same."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from vgvt.effects import make_effect
from vgvt.reconcile.question.uncertain import prepared
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import reduced, settling
from vgvt.simulation.airframe import Pushed
from vgvt.simulation.assembly import Plan, plan
from vgvt.simulation.reduced import Layouts, structure


def soft_root(scenario: Scenario, bending: float, torsion: float) -> Scenario:
    """The scenario with a root that gives way."""
    action = make_effect("root-compliance", "here", bending=bending, torsion=torsion).act(scenario, 0)
    assert action.scenario is not None
    return action.scenario


def moved_drive(scenario: Scenario, by_m: float) -> Scenario:
    """The scenario driven a little further aft."""
    x, y, z = scenario.shaker.position_m
    return scenario.model_copy(update={"shaker": scenario.shaker.model_copy(update={"position_m": (x + by_m, y, z)})})


def springs(layout: Plan) -> list[tuple[str, float]]:
    """Kinds and stiffnesses of all hinges."""
    links = [link for chain in layout.parts.chains.values() for link in chain.links]
    return [(hinge.kind, hinge.stiffness_n_m_per_rad) for link in links for hinge in link.hinges]


def test_softer_and_softer_roots_are_placed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    scenario, made = load_scenario("quick"), list[Scenario]()

    def counted(edited: Scenario, *pushed: Pushed) -> Plan:
        made.append(edited)
        return plan(edited, *pushed)

    monkeypatch.setattr(reduced, "plan", counted)
    layouts = Layouts.of(scenario)
    for softness in (0.1, 0.2, 0.3):
        layouts.plan(moved_drive(soft_root(scenario, softness, softness), 0.01))
    assert len(made) == 2


@pytest.mark.parametrize(("bending", "torsion"), [(0.0, 0.0), (0.2, 0.0), (0.0, 0.2), (0.2, 0.2)])
def test_they_are_what_is_planned_from_scratch(bending: float, torsion: float) -> None:
    scenario = load_scenario("quick")
    layouts = Layouts.of(scenario)
    if bending or torsion:
        layouts.plan(soft_root(scenario, bending / 2, torsion / 2))
        scenario = soft_root(scenario, bending, torsion)
    edited = moved_drive(scenario, 0.02)
    found, wanted = layouts.plan(edited), plan(edited)
    assert found.scenario is edited
    for one, other in zip((*found.grid, found.drive), (*wanted.grid, wanted.drive), strict=True):
        assert (one.dof, one.site, one.part, one.carrier) == (other.dof, other.site, other.part, other.carrier)
        np.testing.assert_array_equal(one.position_m, other.position_m)
    assert springs(found) == springs(wanted)


def test_few_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever is edited: what is no longer there is planned again."""
    monkeypatch.setattr(reduced, "_PLANS", 2)
    scenario = load_scenario("quick")
    layouts = Layouts.of(scenario)
    edits = [soft_root(scenario, *softness) for softness in ((0.2, 0.0), (0.0, 0.2), (0.2, 0.2), (0.1, 0.0))]
    for edited in edits:
        assert springs(layouts.plan(edited)) == springs(plan(edited))
    assert len(layouts._known) == 2


@pytest.mark.parametrize(("bending", "most"), [(0.05, 12), (0.4, 80)])
def test_a_neighbours_stiffness_leads_to_the_same_rest(
    monkeypatch: pytest.MonkeyPatch, bending: float, most: int
) -> None:
    """Without a difference of its own, but where it leads nowhere."""
    scenario = load_scenario("quick")
    here = plan(scenario)
    beside = structure(here, here.grid)
    action = make_effect("stiffness-asymmetry", "here", bending=bending, torsion=0.0).act(
        moved_drive(scenario, 0.03), 0
    )
    assert action.scenario is not None
    there = plan(action.scenario)
    alone, asked, force = structure(there, there.grid), list[int](), settling.joint_force

    def counted(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
        asked.append(1)
        return force(model, data)

    monkeypatch.setattr(settling, "joint_force", counted)
    found = structure(there, there.grid, beside)
    assert len(asked) < most
    np.testing.assert_allclose(found.equilibrium, alone.equilibrium, atol=1e-8)
    for name in ("mass", "damping", "stiffness", "axis", "tilt", "drive"):
        np.testing.assert_allclose(getattr(found, name), getattr(alone, name), rtol=1e-5, atol=1e-5)
    # Over the joints themselves, which the stiffness is not: a turned root changes both.
    turn = np.eye(len(alone.joints))
    turn[:6, :6] = alone.root
    np.testing.assert_allclose(turn.T @ np.linalg.inv(alone.softness()) @ turn, alone.stiffness, atol=1e-6)


@pytest.mark.parametrize(("right_m", "up_m"), [(0.02, 0.0), (0.0, 0.0), (0.05, 0.02)])
def test_a_far_rest_is_found_from_a_neighbours(monkeypatch: pytest.MonkeyPatch, right_m: float, up_m: float) -> None:
    """And is the same as from the unloaded shape, which nobody has to start from."""
    scenario = load_scenario("quick")
    here = plan(scenario)
    beside = structure(here, here.grid)
    action = make_effect("hook-offset", "here", aft_m=0.05, right_m=right_m, up_m=up_m).act(scenario, 0)
    assert action.scenario is not None
    there = plan(action.scenario)
    alone = structure(there, there.grid).equilibrium
    monkeypatch.setattr(reduced, "settle", None)
    found = structure(there, there.grid, beside).equilibrium
    np.testing.assert_allclose(found, alone, atol=1e-6)


@pytest.mark.parametrize("aft_m", [0.0, 0.08])
def test_what_turns_over_is_refused_whoever_is_beside_it(aft_m: float) -> None:
    """Hung below its centre of gravity; from a neighbour's rest steps lead to where it balances, or hangs nose down."""
    scenario = load_scenario("quick")
    here = plan(scenario)
    action = make_effect("hook-offset", "here", aft_m=aft_m, right_m=0.0, up_m=-0.05).act(scenario, 0)
    assert action.scenario is not None
    there = plan(action.scenario)
    for beside in (None, structure(here, here.grid)):
        with pytest.raises(RuntimeError, match="turn over"):
            structure(there, there.grid, beside)


def test_a_sensor_that_looks_ahead_feels_gravity_as_the_nose_goes_down() -> None:
    """Turned by θ to the right-hand side's axis, x points down by θ: at rest it reads -g θ, whatever the model says."""
    scenario = load_scenario("quick")
    layout = plan(scenario)
    ahead = replace(layout.grid[0], axis=np.array([1.0, 0.0, 0.0]))
    found = structure(layout, (ahead,))
    # Centre body's translations, then its rotations.
    np.testing.assert_allclose(found.tilt[0, 3:6], [0.0, -9.80665, 0.0], atol=0.05 * 9.80665)


def test_a_body_without_beams_has_a_structure() -> None:
    """Its coordinates are those of its own frame: there is no root to take them from."""
    whole = prepared(load_scenario("quick"))
    grid = whole.accelerometers.grid
    on_body = grid.model_copy(update={"attached_to": ("body",) * len(grid.node), "z_m": (0.0,) * len(grid.node)})
    airframe = whole.airframe.model_copy(
        update={
            "beam": (),
            "item": tuple(i for i in whole.airframe.item if i.attached_to == "body"),
            "damping": whole.airframe.damping.model_copy(update={"modal": ()}),
        }
    )
    sensors = whole.accelerometers.model_copy(update={"grid": on_body})
    layout = plan(whole.model_copy(update={"airframe": airframe, "accelerometers": sensors}))
    found = structure(layout, layout.grid)
    assert len(found.joints) == 6
    assert np.isfinite(found.mass).all() and np.linalg.eigvalsh(found.mass)[0] > 0
