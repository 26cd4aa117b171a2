"""Sensors between two links of a beam: a rigid motion of both counts once; a hammer pushes what a sensor feels."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import CubicSpline

from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import simulated_campaign
from vgvt.simulation.airframe import cut_airframe
from vgvt.simulation.assembly import driven_rig, plans
from vgvt.simulation.seats import seats_at
from vgvt.simulation.state_space import state_space
from vgvt.simulation.truth import truth_of

PLACES_M = ((0.05, 0.213, 0.0), (-0.1, -0.613, 0.0), (0.0, 0.79, 0.0), (0.1, 1.0, 0.0), (0.0, 0.01, 0.0))


@pytest.mark.parametrize("place", PLACES_M)
def test_a_rigid_motion_of_both_links_counts_once(place: tuple[float, float, float]) -> None:
    """Weights add up to one, weighted places to the sensor's own."""
    parts = cut_airframe(load_scenario("teaching-beam").airframe)
    seats = seats_at(parts, "beam", np.array(place))
    assert len(seats) in (1, 2)
    assert sum(s.weight for s in seats) == pytest.approx(1.0)
    np.testing.assert_allclose(sum(s.weight * s.position_m for s in seats), place, atol=1e-12)


def test_what_turns_turns_from_one_slope_to_the_other() -> None:
    """Each link counts by how near its station is, and nothing less than nothing."""
    parts = cut_airframe(load_scenario("teaching-beam").airframe)
    links = parts.chains["beam-right"].links
    here, there = links[4], links[5]
    for share in (0.1, 0.5, 0.9):
        arc = here.twist_arc_m + share * (there.twist_arc_m - here.twist_arc_m)
        seats = seats_at(parts, "beam", np.array([0.05, arc, 0.0]))
        assert [(s.carrier, s.weight) for s in seats] == [
            (here.name, pytest.approx(1 - share)),
            (there.name, pytest.approx(share)),
        ]


def test_a_sensor_along_a_wing_that_sags_reads_what_the_beam_does() -> None:
    """Its axis leans with the static slope w₀', the wing shortens by ∫w₀'w', and the weight pulls along by g w'.

    Euler and Bernoulli's beam under its own weight, w from sensors along Z: within 3 % of the largest, with 12 cells.
    Weights that added up otherwise had read it wrong by all of it.
    """
    scenario = load_scenario("teaching-beam")
    (beam,) = scenario.airframe.beam
    stations = beam.stations
    places = np.linspace(0.05, 0.95, 19)
    count = places.size
    grid = scenario.accelerometers.grid.model_copy(
        update={
            "node": tuple(range(1, 2 * count + 1)), "x_m": (0.0,) * (2 * count), "y_m": (*places, *places),
            "direction": ("+Y",) * count + ("+Z",) * count, "z_m": None, "attached_to": ("beam",) * (2 * count),
        }
    )  # fmt: skip
    rig = {
        "airframe": scenario.airframe.model_copy(update={"beam": (beam.model_copy(update={"cells": 12}),)}),
        "accelerometers": scenario.accelerometers.model_copy(update={"grid": grid, "mass_kg": 0.0}),
        "acquisition": scenario.acquisition.model_copy(update={"runs": (tuple(range(1, 2 * count + 1)),)}),
    }
    truth = truth_of(scenario.model_copy(update=rig)).as_tested[0]
    mode = int(np.argmin(np.abs(truth.natural_frequency_hz - 5.71)))
    shape = dict(zip((dof.node for dof in truth.dofs), truth.shapes[mode], strict=True))
    along, rises = np.split(np.array([shape[node] / shape[2 * count] for node in range(1, 2 * count + 1)]), 2)
    (bending,) = set(stations.bending_stiffness_n_m2)
    (mass,) = set(stations.mass_kg_per_m)
    length = stations.position_m[-1][1]
    sag = -mass * 9.80665 / (6 * bending) * (length**3 - (length - places) ** 3)
    # Even at the root: a symmetric mode of a beam through the body.
    w = CubicSpline(np.concatenate([-places[::-1], places]), np.concatenate([rises.real[::-1], rises.real]))
    slope = w(places, 1)
    fine = np.linspace(0.0, 1.0, 2001)
    sag_fine = -mass * 9.80665 / (6 * bending) * (length**3 - (length - fine) ** 3)
    shortened = np.interp(places, fine, cumulative_trapezoid(sag_fine * w(fine, 1), fine, initial=0.0))
    omega = 2 * np.pi * truth.natural_frequency_hz[mode]
    expected = sag * w(places) - shortened - 9.80665 * slope / omega**2
    assert np.abs(along.real - expected).max() < 0.03 * np.abs(expected).max()


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
    assert between == [2, 2]
    assert np.abs(found[3] - found[6]).max() < 1e-3 * np.abs(found[3]).max()


def test_both_engines_push_and_read_between_links() -> None:
    records = [simulated_campaign(hammered(3), engine=e).runs[0].samples for e in ("mujoco", "linear")]
    stepped, solved = (np.asarray(r, dtype=float) for r in records)
    scale = np.abs(solved).max(axis=1, keepdims=True)
    assert (np.abs(stepped - solved) / scale).max() < 0.02
