"""The simulator's airframes against the independent finite-element model of the same station tables."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from finite_element import Array, Model, build, natural_modes
from uniform_beams import UniformBeam, free_beam, virtual_test

from vgvt.data import Direction, Dof, Truth, modal_assurance
from vgvt.scenario import load_scenario, rigid_body_properties
from vgvt.scenario.model import Scenario
from vgvt.simulation import truth_of

SCENARIOS = ("hati-unsymmetric", "skoll-gvt1")
HIGHEST_HZ = 45.0
FREQUENCY_TOLERANCE = 0.005
LEAST_MAC = 0.99


@functools.cache
def truth(name: str) -> Truth:
    """The simulator's truth of a bundled scenario."""
    return truth_of(load_scenario(name))


def placed_grid(scenario: Scenario, model: Model) -> dict[int, tuple[Array, str]]:
    """Position and part of every grid point and the drive point; points without a part lie on the nearer wing."""
    grid = scenario.accelerometers.grid
    halves = sorted(model.chains)
    places: dict[int, tuple[Array, str]] = {}
    for k, node in enumerate(grid.node):
        x, y = grid.x_m[k], grid.y_m[k]
        part = grid.attached_to[k] if grid.attached_to else part_under(model, x, y)
        if part not in ("body", *halves):
            part = f"{part}-{'left' if y < 0 else 'right'}"
        z = grid.z_m[k] if grid.z_m else 0.0
        places[node] = (np.array([x, y, z]), part)
    shaker = scenario.shaker
    places[shaker.node] = (np.array(shaker.position_m), shaker.attached_to)
    return places


def part_under(model: Model, x: float, y: float) -> str:
    """The beam on this side of the plane of symmetry; the body inboard of every root."""
    roots = {name: chain[0].start_m for name, chain in model.chains.items()}
    outboard = [name for name, root in roots.items() if y * root[1] > 0 and abs(y) >= abs(root[1])]
    return outboard[0] if outboard else "body"


def finite_element_modes(scenario: Scenario, model: Model, dofs: tuple[Dof, ...]) -> tuple[Array, Array]:
    """Elastic frequencies and their shapes (modes, D) at the DOFs, free and without instruments."""
    frequency, shapes = natural_modes(model.mass, model.stiffness)
    places = placed_grid(scenario, model)
    rows = np.array([dof.direction.unit_vector @ model.motion_at(*places[dof.node])[:3] for dof in dofs])
    return frequency[6:], (rows @ shapes).T[6:]


@pytest.mark.parametrize("name", SCENARIOS)
def test_elastic_modes_agree_with_the_finite_element_model(name: str) -> None:
    scenario, bare = load_scenario(name), truth(name).bare
    assert all(not dof.direction.is_rotation for dof in bare.dofs)
    frequency, shapes = finite_element_modes(scenario, build(scenario.airframe, 60), bare.dofs)
    below = int((frequency < HIGHEST_HZ).sum())
    assert below >= 3, "the airframe has modes to compare"
    assert len(bare) >= below
    np.testing.assert_allclose(bare.natural_frequency_hz[:below], frequency[:below], rtol=FREQUENCY_TOLERANCE)
    likeness = modal_assurance(bare.shapes[:below], shapes[:below].astype(complex))
    assert np.diag(likeness).min() > LEAST_MAC, f"MAC of paired modes: {np.diag(likeness)}"


@pytest.mark.parametrize("name", SCENARIOS)
def test_simulator_counts_the_same_modes_below_the_limit(name: str) -> None:
    scenario, bare = load_scenario(name), truth(name).bare
    model = build(scenario.airframe, 60)
    frequency, _ = natural_modes(model.mass, model.stiffness)
    elastic = frequency[6:]
    clear_of_the_edge = HIGHEST_HZ * np.array([1 - FREQUENCY_TOLERANCE, 1 + FREQUENCY_TOLERANCE])
    if np.any((elastic > clear_of_the_edge[0]) & (elastic < clear_of_the_edge[1])):
        pytest.skip("a mode lies on the limit itself")
    assert (bare.natural_frequency_hz < HIGHEST_HZ).sum() == (elastic < HIGHEST_HZ).sum()


@pytest.mark.parametrize("name", SCENARIOS)
def test_assembled_model_weighs_what_the_scenario_says(name: str) -> None:
    assembled, stated = truth(name).rigid_body, rigid_body_properties(load_scenario(name).airframe)
    scale = np.abs(stated.inertia_kg_m2).max()
    assert assembled.mass_kg == pytest.approx(stated.mass_kg, rel=1e-9)
    np.testing.assert_allclose(assembled.centre_of_gravity_m, stated.centre_of_gravity_m, atol=1e-9)
    np.testing.assert_allclose(assembled.inertia_kg_m2, stated.inertia_kg_m2, atol=1e-9 * scale)


def test_a_coupled_beam_weighs_and_vibrates_as_the_finite_element_model_does() -> None:
    """A centre of gravity well behind the axis couples bending and torsion; 24 links a side follow it."""
    beam = UniformBeam(cg_offset_m=0.05)
    airframe = free_beam(beam, cells=24)
    scenario = virtual_test(airframe, beam.length_m, mirror=True)
    result = truth_of(scenario)
    frequency, shapes = finite_element_modes(scenario, build(airframe, 60), result.bare.dofs)
    np.testing.assert_allclose(result.bare.natural_frequency_hz[:4], frequency[:4], rtol=FREQUENCY_TOLERANCE)
    likeness = modal_assurance(result.bare.shapes[:4], shapes[:4].astype(complex))
    assert np.diag(likeness).min() > LEAST_MAC
    stated = rigid_body_properties(airframe)
    np.testing.assert_allclose(result.rigid_body.inertia_kg_m2, stated.inertia_kg_m2, atol=1e-9)


@pytest.mark.parametrize("name", SCENARIOS)
def test_hung_aircraft_heaves_on_its_spring(name: str) -> None:
    """130 N/m under 6.3 kg: 0.72 Hz; the finite-element model with the instruments aboard says it more sharply."""
    scenario = load_scenario(name)
    heave_hz = finite_element_heave(scenario)
    hung = truth(name).as_tested[0]
    slow = hung.natural_frequency_hz < 3.0
    assert slow.any(), "the model as tested keeps the suspension modes"
    up = np.array([dof.direction in (Direction.PLUS_Z, Direction.MINUS_Z) for dof in hung.dofs])
    sign = np.array([dof.direction.sign for dof in hung.dofs])[up]
    plunge = modal_assurance(hung.shapes[slow][:, up], np.atleast_2d(sign).astype(complex))[:, 0]
    found = hung.natural_frequency_hz[slow][plunge.argmax()]
    assert plunge.max() > 0.9, f"no suspension mode moves the aircraft up and down as one: MAC {plunge}"
    assert found == pytest.approx(0.72, abs=0.015)
    assert found == pytest.approx(heave_hz, rel=0.01)


@pytest.mark.parametrize("name", SCENARIOS)
def test_bare_modes_have_the_damping_that_the_scenario_states(name: str) -> None:
    stated, bare = load_scenario(name).airframe.damping, truth(name).bare
    ratios = np.full(len(bare), stated.damping_ratio)
    ratios[: len(stated.modal)] = stated.modal[: len(bare)]
    exact = bare.natural_frequency_hz <= stated.limit_hz
    np.testing.assert_allclose(bare.damping_ratio[exact], ratios[exact], rtol=1e-6)


@pytest.mark.parametrize("name", SCENARIOS)
def test_modal_constants_as_tested_agree_with_the_finite_element_model(name: str) -> None:
    """2 i w R = shape * shape at the drive point / modal mass; both sides with the instruments of run 1 aboard."""
    scenario = load_scenario(name)
    hung = truth(name).as_tested[0].band(3.0, HIGHEST_HZ)
    model, places = instrumented(scenario, scenario.acquisition.runs[0])
    frequency, shapes = natural_modes(model.mass, model.stiffness)
    elastic = (frequency > 3.0) & (frequency < HIGHEST_HZ)
    rows = np.array([dof.direction.unit_vector @ model.motion_at(*places[dof.node])[:3] for dof in hung.dofs])
    drive = hung.references[0].direction.unit_vector @ model.motion_at(*places[hung.references[0].node])[:3]
    expected = (shapes[:, elastic].T @ rows.T) * (drive @ shapes[:, elastic])[:, None]
    assert hung.residues is not None
    assert len(hung) == elastic.sum()
    omega = 2 * np.pi * hung.natural_frequency_hz * np.sqrt(1 - hung.damping_ratio**2)
    found = hung.residues[:, :, 0] * (2j * omega)[:, None]
    scale = np.abs(expected).max(axis=1, keepdims=True)
    driven = scale[:, 0] > 0.02 * scale.max()
    np.testing.assert_allclose((found / scale)[driven], (expected / scale)[driven], atol=0.05)


def test_moving_the_sensors_moves_the_frequencies_as_their_mass_says() -> None:
    """Run by run the mass of two accelerometers loads other places; the shifts are small, systematic and predicted."""
    scenario = load_scenario("hati-unsymmetric")
    runs = scenario.acquisition.runs
    found = [hung.band(3.0, 35.0).natural_frequency_hz for hung in truth("hati-unsymmetric").as_tested]
    expected = []
    for nodes in runs:
        model, _ = instrumented(scenario, nodes)
        frequency, _ = natural_modes(model.mass, model.stiffness)
        expected.append(frequency[(frequency > 3.0) & (frequency < 35.0)])
    shift_found, shift_expected = (np.array(f) / np.array(f).mean(axis=0) - 1 for f in (found, expected))
    assert shift_found.shape == shift_expected.shape
    assert np.abs(shift_expected).max() > 1e-4, "the loading must be large enough to tell"
    np.testing.assert_allclose(shift_found, shift_expected, atol=0.1 * np.abs(shift_expected).max())


def instrumented(scenario: Scenario, nodes: tuple[int, ...]) -> tuple[Model, dict[int, tuple[Array, str]]]:
    """The airframe on its spring with the accelerometers of one run and the structure side of the transducer."""
    model = build(scenario.airframe, 40)
    places = placed_grid(scenario, model)
    for node in nodes:
        model = model.with_point_mass(scenario.accelerometers.mass_kg, *places[node])
    model = model.with_point_mass(scenario.transducer.end_mass_kg, *places[scenario.shaker.node])
    hook = np.array(scenario.suspension.hook_m)
    spring = scenario.suspension.stiffness_n_per_m
    return model.with_ground_spring(spring, hook, np.array([0.0, 0.0, 1.0])), places


def finite_element_heave(scenario: Scenario) -> float:
    """The suspension's heave frequency with the instruments of the first run on the aircraft."""
    model, _ = instrumented(scenario, scenario.acquisition.runs[0])
    frequency, _ = natural_modes(model.mass, model.stiffness)
    return float(frequency[5])
