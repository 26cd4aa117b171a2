"""What effects tie to a beam moves with the beam, wherever between two links: against closed forms."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation.assembly import hung_rig, plans
from vgvt.simulation.truth import truth_of

_ARM_M, _INERTIA_KG_M, _HALF_M = 0.14, 0.01, 1.0


def beam_with(*effects: EffectTable) -> Scenario:
    """The teaching beam with a dozen cells a side, and effects."""
    scenario = load_scenario("teaching-beam")
    beams = tuple(beam.model_copy(update={"cells": 12}) for beam in scenario.airframe.beam)
    airframe = scenario.airframe.model_copy(update={"beam": beams})
    return scenario.model_copy(update={"airframe": airframe, "effect": effects})


@pytest.mark.parametrize("y_m", [0.29, 0.33, 0.37, -0.92])
@pytest.mark.parametrize("order", [1, 2])
def test_a_dashpot_adds_the_damping_of_a_free_bar_in_torsion(order: int, y_m: float) -> None:
    """c (x θ)² / (2 ω ∫I θ² dy), θ = cos(n π (y + 1) / 2): on the nearer link it had been up to a half too much."""
    dashpot = 0.02
    damper = EffectTable(name="nonproportional-damper", x_m=_ARM_M, y_m=y_m, damping_n_s_per_m=dashpot)
    without, with_it = (truth_of(s).bare for s in (beam_with(), beam_with(damper)))
    hz = order * 11.180
    modes = [int(np.argmin(np.abs(truth.natural_frequency_hz - hz))) for truth in (without, with_it)]
    added = with_it.damping_ratio[modes[1]] - without.damping_ratio[modes[0]]
    turned = np.cos(order * np.pi * (y_m + _HALF_M) / 2)
    expected = dashpot * (_ARM_M * turned) ** 2 / (2 * 2 * np.pi * hz * _INERTIA_KG_M * _HALF_M)
    largest = dashpot * _ARM_M**2 / (2 * 2 * np.pi * hz * _INERTIA_KG_M * _HALF_M)
    assert added == pytest.approx(expected, abs=0.03 * largest)


def test_a_bundle_between_two_places_stretches_by_nothing_rigid() -> None:
    """Branches of a tendon that balance: however the aircraft as a whole moves and turns, its length stays."""
    tied = EffectTable(name="cable-bundle", x_m=0.1, y_m=0.33, other_x_m=-0.1, other_y_m=-0.61, stiffness_n_per_m=100.0)
    rig = hung_rig(plans(beam_with(tied))[0], 0)
    data = mujoco.MjData(rig.model)
    (name,) = _new_tendons(rig.model, hung_rig(plans(beam_with())[0], 0).model)
    lengths = []
    for moved in (np.zeros(6), np.array([0.02, -0.01, 0.03, 0.01, -0.02, 0.015])):
        data.qpos[:] = rig.qpos
        data.qpos[:6] += moved
        mujoco.mj_forward(rig.model, data)
        lengths.append(float(data.ten_length[rig.model.tendon(name).id]))
    assert lengths[1] == pytest.approx(lengths[0], abs=1e-6)


def _new_tendons(model: mujoco.MjModel, before: mujoco.MjModel) -> set[str]:
    """Names of the tendons of a model that another does not have."""
    known, had = ({m.tendon(k).name for k in range(m.ntendon)} for m in (model, before))
    return known - had
