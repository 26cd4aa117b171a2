"""Resonances of the whole rig, shaker attached and driven, against the independent finite-element aircraft.

BFF under voltage drive is the hard case: the shaker's flexure holds the centre body, and no resonance of the rig
is near a mode of the aircraft in shape.
"""

from __future__ import annotations

import numpy as np
import pytest
from finite_element import Array, Model, build, natural_modes
from test_finite_element_agreement import FREQUENCY_TOLERANCE, placed_grid

from vgvt.scenario import load_scenario
from vgvt.scenario.model import Scenario
from vgvt.simulation import truth_of

GRAVITY_M_PER_S2 = 9.80665


def structural_damping(scenario: Scenario, model: Model) -> Array:
    """Modal damping of the free aircraft as a matrix; above the limit the rate of decay stays that at the limit."""
    damping = scenario.airframe.damping
    frequency, shapes = natural_modes(model.mass, model.stiffness)
    stated = np.full(frequency.size, damping.damping_ratio)
    stated[6 : 6 + len(damping.modal)] = damping.modal
    rate = 2 * stated * 2 * np.pi * np.minimum(frequency, damping.limit_hz)
    rate[:6] = 0.0
    momentum = model.mass @ shapes
    return np.asarray(momentum * rate @ momentum.T)


def rig_resonances(scenario: Scenario) -> tuple[Array, Array]:
    """Frequencies in Hz and damping ratios of aircraft, sensors of run 1, spring, stinger, shaker and amplifier."""
    model = build(scenario.airframe, 60)
    places = placed_grid(scenario, model)
    mass, stiffness, damping = model.mass.copy(), model.stiffness.copy(), structural_damping(scenario, model)
    shaker, stinger, suspension = scenario.shaker, scenario.stinger, scenario.suspension
    half = 0.5 * stinger.mass_kg
    carried = [(places[node], scenario.accelerometers.mass_kg) for node in scenario.acquisition.runs[0]]
    carried.append((places[shaker.node], scenario.transducer.mass_kg + half))
    for place, kg in carried:
        rows = model.motion_at(*place)[:3]
        mass += kg * rows.T @ rows
    total = float(model.motion_at(model.origin_m)[2] @ mass @ np.eye(mass.shape[0])[2])
    hook = model.motion_at(np.array(suspension.hook_m))
    weight = total * GRAVITY_M_PER_S2
    length = suspension.free_length_m + weight / suspension.stiffness_n_per_m
    above = suspension.hook_m[2] - model.origin_m[2]
    stiffness += suspension.stiffness_n_per_m * np.outer(hook[2], hook[2])
    for axis in range(2):
        stiffness += weight / length * np.outer(hook[axis], hook[axis])
        stiffness += weight * above * np.outer(hook[3 + axis], hook[3 + axis])
    stiffness += suspension.yaw_stiffness_n_m_per_rad * np.outer(hook[5], hook[5])
    damping += suspension.damping_n_s_per_m * np.outer(hook[2], hook[2])
    body = model.motion_at(model.origin_m)
    for axis in range(2):
        damping += suspension.pendulum_damping_n_s_per_m * np.outer(body[axis], body[axis])
    for axis in range(3, 6):
        damping += suspension.rotation_damping_n_m_s_per_rad * np.outer(body[axis], body[axis])
    drive = np.append(model.motion_at(*places[shaker.node])[2], -1.0)
    mass, stiffness, damping = (np.pad(matrix, (0, 1)) for matrix in (mass, stiffness, damping))
    stiffness += stinger.axial_stiffness_n_per_m * np.outer(drive, drive)
    damping += stinger.axial_damping_n_s_per_m * np.outer(drive, drive)
    mass[-1, -1] = shaker.armature_mass_kg + half
    stiffness[-1, -1] += shaker.flexure_stiffness_n_per_m
    braking = shaker.force_factor_n_per_a**2 / shaker.coil_resistance_ohm if shaker.drive == "voltage" else 0.0
    damping[-1, -1] += shaker.flexure_damping_n_s_per_m + braking
    size = mass.shape[0]
    inverse = np.linalg.solve(mass, np.hstack([-stiffness, -damping]))
    poles = np.linalg.eigvals(np.vstack([np.hstack([np.zeros((size, size)), np.eye(size)]), inverse]))
    poles = poles[poles.imag > 0]
    poles = poles[np.argsort(np.abs(poles))]
    return np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)


@pytest.mark.parametrize(("name", "resonances"), [("bff", 6), ("hati-unsymmetric", 4)])
def test_resonances_of_the_rig_agree_with_the_finite_element_model(name: str, resonances: int) -> None:
    """From the first above the suspension's own to the end of the band."""
    scenario = load_scenario(name)
    low, high = 2.5, scenario.excitation.band_hz[1]
    coupled = truth_of(scenario).coupled[0].band(low, high)
    frequency, damping = rig_resonances(scenario)
    within = (frequency > low) & (frequency < high)
    assert len(coupled) == within.sum() >= resonances
    np.testing.assert_allclose(coupled.natural_frequency_hz, frequency[within], rtol=FREQUENCY_TOLERANCE)
    np.testing.assert_allclose(coupled.damping_ratio, damping[within], rtol=0.03)
