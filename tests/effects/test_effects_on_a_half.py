"""A moment on a body of two halves is on what the shaker pushes on, a half or the middle, and its gauge feels that."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from effect_rig import FREQUENCY_HZ, at_rest, effect_rig, largest_error, responses
from numpy.typing import NDArray

from vgvt.scenario import Scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import simulated_campaign
from vgvt.simulation.airframe import ROOT
from vgvt.simulation.assembly import hung_rig, plans
from vgvt.simulation.attached import attach
from vgvt.simulation.effect_conformance import ENGINES_AGREE, example_scenario
from vgvt.simulation.halves import LEFT_HALF, RIGHT_HALF
from vgvt.simulation.linear import linearise
from vgvt.simulation.reduced import structure

HALVED = EffectTable(name="carry-through-torsion", compliance_rad_per_n_m=1e-2)
MOMENT = EffectTable(name="stinger-moment", rotational_stiffness_n_m_per_rad=30.0)
STRAIN = EffectTable(name="base-strain", rotational_stiffness_n_m_per_rad=10.0, apparent_force_per_moment_per_m=8.0)
ASIDE_M = 0.1143


def driven_at(scenario: Scenario, y_m: float, *tables: EffectTable) -> Scenario:
    """The scenario on two halves with effects, its shaker to one side of the plane of symmetry."""
    x, _, z = scenario.shaker.position_m
    moved = scenario.shaker.model_copy(update={"position_m": (x, y_m, z)})
    return scenario.model_copy(update={"shaker": moved, "effect": (HALVED, *tables)})


@pytest.mark.parametrize("y_m", [-ASIDE_M, 0.0, ASIDE_M])
def test_a_moment_is_on_the_half_under_the_shaker(y_m: float) -> None:
    """K grows by k (r rᵀ + p pᵀ), with roll and pitch of that half: pitch of the other was 0.36 Hz off."""
    plain, held = (hung_rig(plans(driven_at(effect_rig(), y_m, *t))[0], 0) for t in ((), (MOMENT,)))
    turned: NDArray[np.float64] = np.zeros((3, held.model.nv))
    driven = {-ASIDE_M: LEFT_HALF, 0.0: ROOT, ASIDE_M: RIGHT_HALF}[y_m]
    data = at_rest(held)
    mujoco.mj_jacBody(held.model, data, None, turned, held.model.body(driven).id)
    across = (data.body(driven).xmat.reshape(3, 3).T @ turned)[:2]
    before, after = (linearise(r.model, r.qpos).stiffness for r in (plain, held))
    np.testing.assert_allclose(after - before, 30.0 * across.T @ across, atol=1e-4)


@pytest.mark.parametrize("y_m", [-ASIDE_M, 0.0, ASIDE_M])
@pytest.mark.parametrize("table", [MOMENT, STRAIN])
def test_a_fit_assembles_what_is_driven(y_m: float, table: EffectTable) -> None:
    """Whole, and by rows alone on an aircraft that is assembled without."""
    scenario = driven_at(effect_rig(), y_m, table)
    (layout,), (bare,) = plans(scenario), plans(driven_at(effect_rig(), y_m))
    wanted = responses(scenario)[0][:-1]
    beside = attach(structure(bare, bare.run_points(0)), bare, layout.elements)
    assert beside is not None
    for s in (structure(layout, layout.run_points(0)), beside):
        omega = 2 * np.pi * FREQUENCY_HZ[:, None, None]
        motion = np.linalg.solve(s.stiffness + 1j * omega * s.damping - omega**2 * s.mass, s.drive[None, :, None])
        assert largest_error(((s.tilt - omega**2 * s.axis) @ motion)[..., 0].T, wanted) < 1e-4
    assert largest_error(responses(driven_at(effect_rig(), y_m))[0][:-1], wanted) > 0.05


def test_a_gauge_on_the_left_half_reads_the_same_in_both_engines() -> None:
    scenario = driven_at(example_scenario(), -ASIDE_M, STRAIN)
    stepped, solved = (simulated_campaign(scenario, engine=engine).runs[0].samples for engine in ("mujoco", "linear"))
    for got, wanted in zip(stepped[1:], solved[1:], strict=True):
        assert np.linalg.norm(got - wanted) < ENGINES_AGREE * np.linalg.norm(wanted)
