"""Accelerometers feel gravity as they tilt, and the truth says what their records show."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from canted_rig import canted_file
from numpy.typing import NDArray

from vgvt.data import Dof, ModalModel, synthesise
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import truth as sealed
from vgvt.simulation.assembly import Plan, driven_rig, gauged_rig, plans
from vgvt.simulation.linear import LinearModel
from vgvt.simulation.modes import modal_model
from vgvt.simulation.sensed import linearised_at, tilt_rows
from vgvt.simulation.state_space import StateSpace, mass_above_element_kg, state_space
from vgvt.simulation.truth import truth_of

Complex = NDArray[np.complex128]


@pytest.fixture(params=["garteur-sm-ag19", "canted"])
def scenario(request: pytest.FixtureRequest, tmp_path: Path) -> Scenario:
    return load_scenario(canted_file(tmp_path) if request.param == "canted" else request.param)


def driven(scenario: Scenario) -> tuple[Plan, StateSpace]:
    layout = plans(scenario)[0]
    return layout, state_space(layout, driven_rig(layout, 0), layout.points)


def outputs(model: StateSpace, frequency_hz: NDArray[np.float64]) -> tuple[Complex, Complex]:
    """Accelerations (points, lines) and force (lines,) for a unit of command."""
    identity = np.eye(len(model.state_matrix))
    states = [np.linalg.solve(2j * np.pi * f * identity - model.state_matrix, model.inputs[:, 0]) for f in frequency_hz]
    found = model.output_matrix @ np.array(states).T + model.feedthrough_rows
    return found[:-1], found[-1]


def gauged(layout: Plan, model: StateSpace) -> tuple[LinearModel, NDArray[np.float64]]:
    """What the measured force acts on, and what a unit of its coordinates lets the sensors feel of gravity."""
    rig = gauged_rig(layout, 0, model.linear.equilibrium)
    linear = linearised_at(rig, layout.points)
    above, tilt = mass_above_element_kg(layout), tilt_rows(rig, layout.points)
    row = linear.displacement[[-1]]
    mass, stiffness = linear.mass - above * row.T @ row, linear.stiffness - above * row.T @ tilt[[-1]]
    return replace(linear, mass=mass, stiffness=stiffness), tilt


def lines(scenario: Scenario, modes: ModalModel) -> NDArray[np.float64]:
    """Over the band, resonances included."""
    low, high = scenario.excitation.band_hz
    return np.unique([*np.geomspace(low, high, 60), *modes.band(low, high).natural_frequency_hz])


def largest_error(got: Complex, wanted: Complex) -> float:
    """Of any sensor, by the largest response of that sensor."""
    return float((np.abs(got - wanted).max(axis=1) / np.abs(wanted).max(axis=1)).max())


def test_all_modes_and_the_static_tilt_are_the_response_of_every_sensor(
    scenario: Scenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To 1e-6 of A/F by M, C and K; the rig with its shaker is another model, whose stiffness is differenced apart."""
    monkeypatch.setattr(sealed, "limit_hz", lambda _: np.inf)
    monkeypatch.setattr(sealed, "felt_from_hz", lambda _: 0.0)
    layout, model = driven(scenario)
    modes = sealed.assemble_truth([layout], [model]).as_tested[0]
    linear, tilt = gauged(layout, model)
    f = lines(scenario, modes)
    s, push = 2j * np.pi * f, linear.displacement[-1]
    static = np.linalg.solve(linear.stiffness, push)
    lagging = np.linalg.solve(linear.stiffness, linear.damping @ static)
    got = synthesise(modes, f).values[:, 0] + tilt @ (static[:, None] - np.outer(lagging, s))
    dynamic = s[:, None, None] ** 2 * linear.mass + s[:, None, None] * linear.damping + linear.stiffness
    moved = np.linalg.solve(dynamic, np.broadcast_to(push[:, None], (len(s), push.size, 1)))[..., 0].T
    assert largest_error(got, s**2 * (linear.displacement @ moved) + tilt @ moved) < 1e-6
    acceleration, force = outputs(model, f)
    assert largest_error(got, acceleration / force) < 2e-5


def test_the_truth_as_it_is_shows_what_every_sensor_shows(scenario: Scenario) -> None:
    """Within 1 % with nothing added, along x and y too: slow swings are there by the tails of their displacement."""
    layout, model = driven(scenario)
    modes = sealed.assemble_truth([layout], [model])
    f = lines(scenario, modes.as_tested[0])
    acceleration, force = outputs(model, f)
    assert largest_error(synthesise(modes.as_tested[0], f).values[:, 0], acceleration / force) < 0.01
    # With the shaker a swing comes near the band, and where a sensor along y moves little its static tilt counts.
    assert largest_error(synthesise(modes.coupled[0], f).values[:, 0], acceleration) < 0.05


def test_scale_and_modal_mass_are_those_of_the_displacement(
    scenario: Scenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Gravity adds to what sensors feel of a mode and not to its mass; along z it adds nothing at all."""
    felt = sealed.truth_of(scenario).as_tested[0]

    def blind(linear: LinearModel, dofs: tuple[Dof, ...], *more: Any) -> ModalModel:
        references, limit_hz, labels, _tilt, pairs, _felt_from_hz = more
        return modal_model(linear, dofs, references, limit_hz, labels, None, pairs)

    monkeypatch.setattr(sealed, "modal_model", blind)
    moved = sealed.truth_of(scenario).as_tested[0]
    np.testing.assert_allclose(felt.modal_mass_kg, moved.modal_mass_kg, rtol=1e-9)
    assert np.abs(moved.shapes).max(axis=1) == pytest.approx(1)
    vertical = [d.direction.name.endswith("Z") for d in felt.dofs]
    np.testing.assert_allclose(felt.shapes[6:, vertical], moved.shapes[6:, vertical], atol=0.02)
    swings = [i for i, label in enumerate(felt.labels) if "swing" in label]
    aside = [not z for z in vertical]
    assert np.abs(felt.shapes - moved.shapes)[swings][:, aside].max() > 0.3
    drive = felt.dofs.index(felt.references[0])
    damped = 2 * np.pi * felt.natural_frequency_hz * np.sqrt(1 - felt.damping_ratio**2)
    share = moved.shapes[:, [drive]] / (2j * damped * felt.modal_mass_kg)[:, None]
    elastic = (felt.natural_frequency_hz > 4) & (felt.natural_frequency_hz < 40)
    error = np.abs(felt.residues[:, :, 0] - felt.shapes * share).max(axis=1) / np.abs(felt.shapes * share).max(axis=1)
    assert error[elastic].max() < 0.05  # the damping is not quite proportional


def test_modes_with_the_shaker_are_the_response_to_the_command(
    scenario: Scenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All of them and a static tilt, two real terms a sensor, are acceleration over command as the sensors feel it."""
    monkeypatch.setattr(sealed, "limit_hz", lambda _: np.inf)
    monkeypatch.setattr(sealed, "felt_from_hz", lambda _: 0.0)
    layout, model = driven(scenario)
    coupled = sealed.assemble_truth([layout], [model]).coupled[0]
    f = lines(scenario, coupled)
    acceleration, _ = outputs(model, f)
    rest = acceleration - synthesise(coupled, f).values[:, 0]
    terms = np.array([np.ones_like(f), 2j * np.pi * f]).T
    parted = np.concatenate([terms.real, terms.imag])
    found = np.linalg.lstsq(parted, np.concatenate([rest.real, rest.imag], axis=1).T, rcond=None)[0]
    assert largest_error(acceleration - rest + (terms @ found).T, acceleration) < 1e-6


def test_a_wing_that_sags_twists_alike_however_finely_it_is_cut() -> None:
    """What weight does to BFF's first torsion, 0.14 %, is the same from 12 cells on, 1e-4 of the frequency.

    Hinges in one order in every cell had left it 4e-4 off: their errors add up along the wing.
    """
    scenario = load_scenario("bff")
    one = scenario.model_copy(
        update={"acquisition": scenario.acquisition.model_copy(update={"runs": scenario.acquisition.runs[:1]})}
    )
    lowered = []
    for cells in (12, 48):
        beams = tuple(beam.model_copy(update={"cells": cells}) for beam in one.airframe.beam)
        airframe = one.airframe.model_copy(update={"beam": beams})
        truth = truth_of(one.model_copy(update={"airframe": airframe}))
        hung, bare = (
            modes.natural_frequency_hz[np.argmin(np.abs(modes.natural_frequency_hz - 19.2))]
            for modes in (truth.as_tested[0], truth.bare)
        )
        lowered.append(hung / bare)
    assert lowered[0] == pytest.approx(lowered[1], abs=1e-4)
