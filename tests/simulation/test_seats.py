"""Sensors between two links of a beam: a rigid motion of both counts once; a hammer pushes what a sensor feels."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import simulated_campaign
from vgvt.simulation.airframe import cut_airframe
from vgvt.simulation.assembly import driven_rig, plans
from vgvt.simulation.seats import seats_at
from vgvt.simulation.state_space import state_space

PLACES_M = ((0.05, 0.213, 0.0), (-0.1, -0.613, 0.0), (0.0, 0.79, 0.0), (0.1, 1.0, 0.0), (0.0, 0.01, 0.0))


@pytest.mark.parametrize("place", PLACES_M)
def test_a_rigid_motion_of_both_links_counts_once(place: tuple[float, float, float]) -> None:
    """Weights add up to one, weighted places to the sensor's own."""
    parts = cut_airframe(load_scenario("teaching-beam").airframe)
    seats = seats_at(parts, "beam", np.array(place))
    assert len(seats) in (1, 3)
    assert sum(s.weight for s in seats) == pytest.approx(1.0)
    np.testing.assert_allclose(sum(s.weight * s.position_m for s in seats), place, atol=1e-12)


def hammered(node: int) -> Scenario:
    """The teaching beam with seven cells a side, struck at a point, without noise."""
    scenario = load_scenario("teaching-beam-hammer")
    assert scenario.hammer is not None
    beams = tuple(b.model_copy(update={"cells": 7}) for b in scenario.airframe.beam)
    return scenario.model_copy(
        update={
            "airframe": scenario.airframe.model_copy(update={"beam": beams}),
            "hammer": scenario.hammer.model_copy(update={"nodes": (node,)}),
            "accelerometers": scenario.accelerometers.model_copy(update={"mass_kg": 0.0, "noise": None}),
            "excitation": scenario.excitation.model_copy(update={"duration_s": 3.0, "blocks": 1, "ring_down_s": 0.5}),
        }
    )


def test_a_hammer_pushes_what_a_sensor_feels() -> None:
    """Struck at one point and seen at another, and the other way round: between links at both, 0.1 % of the largest."""
    found, between = {}, []
    for here, there in ((3, 6), (6, 3)):
        layout = plans(hammered(here))[0]
        assert layout.strike is not None
        between.append(len(layout.strike.seats))
        point = next(p for p in layout.grid if p.dof.node == there)
        model = state_space(layout, driven_rig(layout, 0), (point,))
        states = [
            np.linalg.solve(2j * np.pi * f * np.eye(len(model.state_matrix)) - model.state_matrix, model.inputs[:, 0])
            for f in np.linspace(3.0, 60.0, 200)
        ]
        found[here] = np.array(states) @ model.output_matrix[0] + model.feedthrough_rows[0, 0]
    assert between == [3, 3]
    assert np.abs(found[3] - found[6]).max() < 1e-3 * np.abs(found[3]).max()


def test_both_engines_push_and_read_between_links() -> None:
    records = [simulated_campaign(hammered(3), engine=e).runs[0].samples for e in ("mujoco", "linear")]
    stepped, solved = (np.asarray(r, dtype=float) for r in records)
    scale = np.abs(solved).max(axis=1, keepdims=True)
    assert (np.abs(stepped - solved) / scale).max() < 0.02
