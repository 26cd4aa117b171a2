"""The judge judged: rigid-body properties, mirroring, offsets and frequency responses of the whole airframe."""

from __future__ import annotations

import numpy as np
import pytest
from finite_element import Array, build, natural_modes
from finite_element_response import accelerance_by_modes, accelerance_by_solve, modal_damping_matrix

from vgvt.scenario.airframe import Airframe
from vgvt.scenario.mass import rigid_body_properties

ITEMS = [
    {"name": "servo", "mass_kg": 0.056, "position_m": (0.68, 0.572, 0.01), "attached_to": "wing", "mirror": True},
    {
        "name": "winglet",
        "mass_kg": 0.04,
        "position_m": (1.1, 1.53, 0.02),
        "inertia_kg_m2": (2e-4, 3e-4, 4e-4),
        "attached_to": "wing",
        "mirror": True,
    },
    {"name": "battery", "mass_kg": 0.3, "position_m": (0.4, 0.05, -0.03)},
]


def swept_airframe(**wing: object) -> Airframe:
    """A swept, tapered, cranked flying wing with every feature of the schema."""
    stations = {
        "position_m": [(0.47, 0.194, 0.0), (0.7, 0.75, 0.01), (1.0147, 1.53, 0.06)],
        "bending_stiffness_n_m2": [400.0, 316.0, 200.0],
        "torsional_stiffness_n_m2": [300.0, 290.0, 150.0],
        "mass_kg_per_m": [0.9, 0.7, 0.5],
        "pitch_inertia_kg_m": [0.007, 0.005, 0.003],
        "cg_offset_m": [0.01, -0.005, 0.02],
    }
    body = {"mass_kg": 3.36, "centre_of_gravity_m": (0.483, 0.0, 0.01), "inertia_kg_m2": (0.0153, 0.1445, 0.155)}
    beam = {"name": "wing", "mirror": True, "stations": stations} | wing
    return Airframe.model_validate({"name": "swept", "body": body, "beam": [beam], "item": ITEMS})


def particles(airframe: Airframe, slices: int = 20000) -> tuple[Array, Array]:
    """Masses (P,) and positions (P, 3) of an airframe cut into particles; thin sections as pairs along the chord."""
    masses, points = [], []
    wing = airframe.beam[0].stations
    position = np.array(wing.position_m)
    for side in (np.array([1.0, 1.0, 1.0]), np.array([1.0, -1.0, 1.0])):
        for k in range(len(position) - 1):
            step = position[k + 1] - position[k]
            xi = (np.arange(slices) + 0.5) / slices

            def value(name: str, k: int = k, xi: Array = xi) -> Array:
                column = getattr(wing, name)
                return np.asarray(column[k] + (column[k + 1] - column[k]) * xi)

            tangent = step / np.linalg.norm(step)
            normal = np.array([0, 0, 1.0]) - tangent[2] * tangent
            aft = np.cross(tangent, normal / np.linalg.norm(normal))
            mass = value("mass_kg_per_m") * np.linalg.norm(step) / slices
            radius = np.sqrt(value("pitch_inertia_kg_m") / value("mass_kg_per_m"))
            for sign in (1, -1):
                masses.append(mass / 2)
                chord = (value("cg_offset_m") + sign * radius)[:, None] * aft
                points.append((position[k] + xi[:, None] * step + chord) * side)
    for item in ITEMS:
        for side in ((1.0, 1.0, 1.0), (1.0, -1.0, 1.0))[: 1 + bool(item.get("mirror"))]:
            masses.append(np.array([item["mass_kg"]]))
            points.append(np.array([item["position_m"]]) * np.array(side))
    masses.append(np.array([airframe.body.mass_kg]))
    points.append(np.array([airframe.body.centre_of_gravity_m]))
    return np.concatenate(masses), np.concatenate(points)


def weighed(mass_matrix: Array, origin_m: Array) -> tuple[float, Array, Array]:
    """Mass, centre of gravity and inertia about it from the rigid-body block of a mass matrix."""
    block = mass_matrix[:6, :6]
    total = block[0, 0]
    arm = np.array([block[1, 5], block[2, 3], block[0, 4]]) / total
    shift = total * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return float(total), origin_m + arm, block[3:, 3:] - shift


def test_assembled_mass_matrix_weighs_what_the_particles_weigh() -> None:
    airframe = swept_airframe()
    model = build(airframe, 7)
    mass, centre, inertia = weighed(model.mass, model.origin_m)
    masses, points = particles(airframe)
    own = np.diag(airframe.body.inertia_kg_m2) + 2 * np.diag(ITEMS[1]["inertia_kg_m2"])
    expected_centre = masses @ points / masses.sum()
    arms = points - expected_centre
    expected = own + (masses * (arms**2).sum(axis=1)).sum() * np.eye(3) - (arms.T * masses) @ arms
    assert mass == pytest.approx(masses.sum(), rel=1e-12)
    np.testing.assert_allclose(centre, expected_centre, atol=1e-9)
    np.testing.assert_allclose(inertia, expected, atol=1e-8)


def test_assembled_mass_matrix_agrees_with_the_rigid_body_properties_of_the_scenario() -> None:
    airframe = swept_airframe()
    model = build(airframe, 7)
    mass, centre, inertia = weighed(model.mass, model.origin_m)
    stated = rigid_body_properties(airframe)
    assert stated.mass_kg == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(stated.centre_of_gravity_m, centre, atol=1e-12)
    np.testing.assert_allclose(stated.inertia_kg_m2, inertia, atol=1e-11)


def test_exactly_six_modes_are_rigid_and_the_first_elastic_one_is_far_above() -> None:
    model = build(swept_airframe(), 40)
    frequency, _ = natural_modes(model.mass, model.stiffness)
    assert np.all(frequency[:6] < 1e-4)
    assert frequency[6] > 1.0


def test_frequencies_are_converged_at_forty_elements() -> None:
    low, high = (natural_modes(m.mass, m.stiffness)[0][6:16] for m in (build(swept_airframe(), n) for n in (40, 80)))
    np.testing.assert_allclose(low, high, rtol=5e-4)


def test_modes_of_a_symmetric_airframe_are_symmetric_or_antisymmetric() -> None:
    airframe = swept_airframe()
    model = build(airframe.model_copy(update={"item": airframe.item[:2]}), 20)
    frequency, shapes = natural_modes(model.mass, model.stiffness)
    right, left = (
        model.motion_at(np.array([0.9, s * 1.3, 0.0]), f"wing-{n}")[2] for s, n in ((1, "right"), (-1, "left"))
    )
    for mode in shapes.T[6:14]:
        assert abs(right @ mode) == pytest.approx(abs(left @ mode), rel=1e-6)
    assert frequency[6] < frequency[13]


def test_a_wing_written_out_twice_equals_a_mirrored_one() -> None:
    mirrored = swept_airframe()
    wing = mirrored.beam[0]
    points = tuple((x, -y, z) for x, y, z in wing.stations.position_m)
    left = wing.model_copy(
        update={
            "name": "wing-left",
            "mirror": False,
            "stations": wing.stations.model_copy(update={"position_m": points}),
        }
    )
    right = wing.model_copy(update={"name": "wing-right", "mirror": False})
    written = mirrored.model_copy(update={"beam": (right, left)})
    first, second = (natural_modes(m.mass, m.stiffness)[0] for m in (build(mirrored, 10), build(written, 10)))
    np.testing.assert_allclose(first[6:20], second[6:20], rtol=1e-9)


def test_rigid_body_modes_strain_nothing_and_a_far_point_moves_rigidly() -> None:
    model = build(swept_airframe(), 10)
    assert np.all(model.stiffness[:6] == 0)
    point = np.array([1.1, 1.4, 0.1])
    spin = np.zeros(model.mass.shape[0])
    spin[3:6] = [0.1, -0.2, 0.3]
    moved = model.motion_at(point, "wing-right") @ spin
    np.testing.assert_allclose(moved[:3], np.cross(spin[3:6], point - model.origin_m), atol=1e-14)


def test_modal_superposition_equals_the_direct_solve() -> None:
    model = build(swept_airframe(), 6).with_ground_spring(130.0, np.array([0.6, 0, 0]), np.array([0, 0, 1.0]))
    frequency, shapes = natural_modes(model.mass, model.stiffness)
    ratio = np.where(frequency > 1e-3, 0.01, 0.0)
    damping = modal_damping_matrix(model.mass, frequency, shapes, ratio)
    lines = np.linspace(1.0, 40.0, 60)
    drive = model.motion_at(np.array([0.635, 0.1143, 0.0]))[2]
    response = np.array([model.motion_at(np.array([0.9, 1.2, 0.0]), "wing-right")[2], drive])
    by_modes = accelerance_by_modes(lines, frequency, shapes, ratio, response, drive)
    by_solve = accelerance_by_solve(lines, model.mass, damping, model.stiffness, response, drive)
    np.testing.assert_allclose(by_modes, by_solve, rtol=1e-6, atol=1e-8)


def test_a_free_airframe_answers_a_slow_force_with_its_mass() -> None:
    model = build(swept_airframe(), 10)
    total, centre, _ = weighed(model.mass, model.origin_m)
    drive = model.motion_at(centre)[2]
    zero = np.zeros_like(model.mass)
    slow = accelerance_by_solve(np.array([0.05]), model.mass, zero, model.stiffness, drive[None], drive)
    assert slow[0, 0].real == pytest.approx(1 / total, rel=1e-3)
