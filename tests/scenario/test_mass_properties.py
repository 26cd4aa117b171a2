"""Exact mass properties against brute force, closed forms and the scales."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import RigidBodyProperties
from vgvt.scenario import Airframe, Beam, Body, Item, load_scenario, rigid_body_properties


def _random_beam(generator: np.random.Generator, normal: tuple[float, float, float], mirror: bool) -> Beam:
    rows = int(generator.integers(2, 6))
    x, y, z = np.cumsum(generator.uniform(0.05, 0.4, size=(3, rows)), axis=1)
    column = lambda low, high: tuple(generator.uniform(low, high, rows).tolist())  # noqa: E731
    return Beam.model_validate(
        {
            "name": "surface",
            "mirror": mirror,
            "normal": normal,
            "stations": {
                "position_m": np.column_stack([x, y, 0.3 * z]).tolist(),
                "bending_stiffness_n_m2": column(1, 2),
                "torsional_stiffness_n_m2": column(1, 2),
                "mass_kg_per_m": column(0.1, 2),
                "pitch_inertia_kg_m": column(0, 0.02),
                "cg_offset_m": column(-0.1, 0.1),
            },
        }
    )


def _point_masses(beam: Beam, pieces: int = 4000) -> tuple[np.ndarray, np.ndarray]:
    """A beam as a cloud: every slice is two equal masses on its chord that have the slice's pitch inertia."""
    table = beam.stations
    points, masses = [], []
    for k in range(len(table.position_m) - 1):
        a, b = np.array(table.position_m[k]), np.array(table.position_m[k + 1])
        length = np.linalg.norm(b - a)
        chord = np.cross(beam.normal, (b - a) / length)
        chord = chord / np.linalg.norm(chord) * (1 if chord[0] > 0 else -1)
        share = (np.arange(pieces) + 0.5) / pieces

        def at(column: tuple[float, ...], k: int = k, share: np.ndarray = share) -> np.ndarray:
            return column[k] + (column[k + 1] - column[k]) * share

        mass = at(table.mass_kg_per_m) * length / pieces
        reach = np.sqrt(at(table.pitch_inertia_kg_m) / at(table.mass_kg_per_m))
        middle = a + share[:, None] * (b - a) + at(table.cg_offset_m)[:, None] * chord
        for side in (-1, 1):
            points.append(middle + side * reach[:, None] * chord)
            masses.append(mass / 2)
    return np.concatenate(points), np.concatenate(masses)


def _of_cloud(points: np.ndarray, masses: np.ndarray) -> RigidBodyProperties:
    centre = (masses[:, None] * points).sum(axis=0) / masses.sum()
    x, y, z = (points - centre).T
    moment = lambda a, b: float((masses * a * b).sum())  # noqa: E731
    inertia = [
        [moment(y, y) + moment(z, z), -moment(x, y), -moment(x, z)],
        [-moment(x, y), moment(x, x) + moment(z, z), -moment(y, z)],
        [-moment(x, z), -moment(y, z), moment(x, x) + moment(y, y)],
    ]
    return RigidBodyProperties(float(masses.sum()), centre, np.array(inertia))


_BODY = Body(mass_kg=1e-9, centre_of_gravity_m=(0.3, 0.0, 0.0), inertia_kg_m2=(1e-12, 1e-12, 1e-12))


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
@pytest.mark.parametrize("mirror", [False, True])
@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (0.0, -0.3, 2.0)])
def test_station_tables_are_integrated_exactly(seed: int, mirror: bool, normal: tuple[float, float, float]) -> None:
    beam = _random_beam(np.random.default_rng(seed), normal, mirror)
    points, masses = _point_masses(beam)
    if mirror:
        points, masses = np.concatenate([points, points * [1, -1, 1]]), np.concatenate([masses, masses])
    expected = _of_cloud(points, masses)
    found = rigid_body_properties(Airframe(name="x", body=_BODY, beam=(beam,)))
    assert found.mass_kg == pytest.approx(expected.mass_kg, rel=1e-7)
    np.testing.assert_allclose(found.centre_of_gravity_m, expected.centre_of_gravity_m, atol=2e-8)
    np.testing.assert_allclose(
        found.inertia_kg_m2, expected.inertia_kg_m2, atol=1e-7 * np.trace(expected.inertia_kg_m2)
    )


def test_uniform_strip_has_its_handbook_inertia() -> None:
    mass, length, width = 3.0, 2.0, 0.4
    beam = Beam.model_validate(
        {
            "name": "plate",
            "stations": {
                "position_m": [[0, -length / 2, 0], [0, length / 2, 0]],
                "bending_stiffness_n_m2": [1, 1],
                "torsional_stiffness_n_m2": [1, 1],
                "mass_kg_per_m": [mass / length] * 2,
                "pitch_inertia_kg_m": [mass / length * width**2 / 12] * 2,
            },
        }
    )
    body = Body(mass_kg=1e-12, centre_of_gravity_m=(0, 0, 0), inertia_kg_m2=(1e-15, 1e-15, 1e-15))
    found = rigid_body_properties(Airframe(name="x", body=body, beam=(beam,))).inertia_kg_m2
    expected = mass / 12 * np.diag([length**2, width**2, length**2 + width**2])
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_offset_is_positive_aft_on_both_wings() -> None:
    scenario = load_scenario("quick")
    wing = scenario.airframe.beam[0]
    rows = len(wing.stations.position_m)

    def centre(offset_m: float) -> np.ndarray:
        stations = wing.stations.model_copy(update={"cg_offset_m": (offset_m,) * rows})
        beam = wing.model_copy(update={"stations": stations})
        return rigid_body_properties(scenario.airframe.model_copy(update={"beam": (beam,)})).centre_of_gravity_m

    assert centre(0.02)[0] > centre(0.0)[0] > centre(-0.02)[0]
    assert centre(0.02)[1] == pytest.approx(centre(-0.02)[1], abs=1e-12)


def test_mirrored_airframe_has_no_products_with_y() -> None:
    beam = _random_beam(np.random.default_rng(5), (0.0, 0.2, 1.0), True)
    item = Item(name="tip", mass_kg=0.2, position_m=(0.7, 1.0, 0.2), attached_to="surface", mirror=True)
    found = rigid_body_properties(Airframe(name="x", body=_BODY, beam=(beam,), item=(item,)))
    assert found.centre_of_gravity_m[1] == pytest.approx(0.0, abs=1e-15)
    np.testing.assert_allclose(found.inertia_kg_m2[1, [0, 2]], 0.0, atol=1e-15)
    assert np.linalg.eigvalsh(found.inertia_kg_m2).min() > 0


def test_items_and_body_obey_the_parallel_axis_theorem() -> None:
    body = Body(mass_kg=2.0, centre_of_gravity_m=(1.0, 0.0, 0.0), inertia_kg_m2=(0.1, 0.2, 0.3))
    item = Item(name="lump", mass_kg=1.0, position_m=(4.0, 0.0, 0.0), inertia_kg_m2=(0.01, 0.02, 0.03))
    found = rigid_body_properties(Airframe(name="x", body=body, item=(item,)))
    np.testing.assert_allclose(found.centre_of_gravity_m, [2.0, 0.0, 0.0])
    reduced = 2.0 * 1.0 / 3.0 * 3.0**2
    np.testing.assert_allclose(found.inertia_kg_m2, np.diag([0.11, 0.22 + reduced, 0.33 + reduced]), atol=1e-14)


@pytest.mark.parametrize(
    ("name", "mass_kg", "cg_m", "inertia"),
    [
        ("hati-unsymmetric", 6.23989, 23.732 * 0.0254, (2.798, 0.481, 2.941)),
        ("skoll-gvt1", 6.26981, 23.726 * 0.0254, (3.098, 0.528, 3.315)),
    ],
)
def test_bundled_aircraft_against_the_scales(
    name: str, mass_kg: float, cg_m: float, inertia: tuple[float, float, float]
) -> None:
    found = rigid_body_properties(load_scenario(name).airframe)
    assert found.mass_kg == pytest.approx(mass_kg, abs=1e-4)
    assert found.centre_of_gravity_m[0] == pytest.approx(cg_m, abs=3e-3)
    assert abs(found.centre_of_gravity_m[1]) < 1e-3
    ixx, iyy, izz = np.diag(found.inertia_kg_m2)
    # Swing tests add the air that they move, which a flat aircraft shows as Ixx + Iyy - Izz > 0; Izz moves none.
    assert izz == pytest.approx(inertia[2], rel=0.05)
    assert 0.88 * inertia[0] < ixx < inertia[0]
    assert iyy < inertia[1]
    assert ixx + iyy - izz == pytest.approx(0.0, abs=0.005)
