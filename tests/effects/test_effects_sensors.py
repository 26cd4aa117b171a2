"""Each effect of the sensors leaves the signature that theory gives it, on the linear model."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from effect_rig import (
    FORE,
    TIP,
    WING,
    at_rest,
    effect_rig,
    elastic,
    entry,
    having,
    largest_error,
    responses,
)
from numpy.typing import NDArray
from small_rig import band_spectra, revised

from vgvt.data import InputError
from vgvt.scenario import Scenario
from vgvt.simulation import simulate, simulated_campaign, truth_of
from vgvt.simulation.assembly import driven_rig, plans
from vgvt.simulation.linear import joint_force
from vgvt.simulation.state_space import state_space


@pytest.fixture(scope="module")
def rig() -> Scenario:
    """The rig to try effects on."""
    return effect_rig()


def test_roving_mass_shifts_poles_by_rayleighs_quotient(rig: Scenario) -> None:
    """Δω/ω = -Σ φ² m / 2 over the run's sensors, so that two runs differ."""
    mass = 0.002
    two_runs = revised(rig, acquisition={"runs": ((WING,), (TIP,))})
    before = truth_of(two_runs).as_tested
    after = truth_of(having(two_runs, "roving-sensor-mass", mass_kg=mass)).as_tested
    largest = []
    for node, bare, loaded in zip((WING, TIP), before, after, strict=True):
        bare, loaded = bare.band(5.0, 40.0), loaded.band(5.0, 40.0)
        expected = -(entry(bare, node) ** 2) * mass / 2
        got = loaded.natural_frequency_hz / bare.natural_frequency_hz - 1
        # Two grams at a tip also make it hang askew, which moves the first mode by 4e-5.
        np.testing.assert_allclose(got, expected, rtol=0.05, atol=5e-5)
        largest.append(float(np.abs(got).max()))
    assert min(largest) > 3e-4
    assert not np.allclose(*(m.band(5.0, 40.0).natural_frequency_hz for m in after), rtol=1e-4)


def test_cables_shift_frequency_and_damping(rig: Scenario) -> None:
    """Δω = φ² k / (2 ω) and Δζ = φ² c / (2 ω), for the sensors that have the cable."""
    k, c = 5.0, 0.02
    before = elastic(rig)
    after = elastic(having(rig, "cable-drag", stiffness_n_per_m=k, damping_n_s_per_m=c, sensors="sensor-2"))
    omega = 2 * np.pi * before.natural_frequency_hz
    shape = entry(before, TIP) ** 2
    got = 2 * np.pi * (after.natural_frequency_hz - before.natural_frequency_hz)
    np.testing.assert_allclose(got, shape * k / (2 * omega), rtol=0.05, atol=1e-5)
    added = after.damping_ratio - before.damping_ratio
    np.testing.assert_allclose(added, shape * c / (2 * omega), rtol=0.1, atol=1e-6)


@pytest.mark.parametrize(
    ("effect", "values"),
    [
        ("cable-drag", {"stiffness_n_per_m": 50.0}),
        ("stinger-moment", {"rotational_stiffness_n_m_per_rad": 20.0}),
    ],
)
def test_springs_to_the_ground_hold_nothing_up(rig: Scenario, effect: str, values: dict[str, float]) -> None:
    """Put on last, they leave the aircraft where and as it hangs: no force is left at the start of a run."""
    alone, held = (driven_rig(plans(s)[0], 0) for s in (rig, having(rig, effect, **values)))
    np.testing.assert_allclose(held.qpos, alone.qpos, atol=1e-12)
    assert np.abs(joint_force(held.model, at_rest(held))).max() < 1e-6


def test_gain_and_sign_are_factors_of_the_chosen_channels(rig: Scenario) -> None:
    """(1 + ε) on the odd nodes, minus one on one DOF, and the rest to the converter's step."""
    plain = simulated_campaign(rig, engine="linear").runs[0].samples
    odd = simulated_campaign(having(rig, "channel-gain", gain_error=0.04, channels="odd"), engine="linear").runs[0]
    for row, factor in ((1, 1.0), (2, 1.04), (3, 1.0), (4, 1.04), (5, 1.0)):
        np.testing.assert_allclose(odd.samples[row], factor * plain[row], atol=1e-6)
    flipped = simulated_campaign(having(rig, "sign-flip", channels=f"{TIP}+Z"), engine="linear").runs[0]
    np.testing.assert_allclose(flipped.samples[3], -plain[3], atol=1e-6)
    np.testing.assert_array_equal(flipped.samples[2], plain[2])
    force = simulated_campaign(having(rig, "channel-gain", gain_error=-0.1, channels="force"), engine="linear").runs[0]
    np.testing.assert_allclose(force.samples[1], 0.9 * plain[1], atol=1e-6)


def test_high_pass_leads_by_the_corner_over_the_frequency(rig: Scenario) -> None:
    """Phase lead atan(f_c/f) and magnitude 1/sqrt(1 + (f_c/f)²) against the plain record, low frequencies most."""
    corner = 0.5
    frequency = _band_hz(rig)
    plain = band_spectra(simulated_campaign(rig, engine="linear").runs[0])
    late = band_spectra(
        simulated_campaign(having(rig, "high-pass-mismatch", corner_hz=corner), engine="linear").runs[0]
    )
    ratio = late[3] / plain[3]
    clear = np.abs(plain[3]) > 0.2 * np.median(np.abs(plain[3]))
    np.testing.assert_allclose(np.angle(ratio)[clear], np.arctan(corner / frequency)[clear], atol=5e-3)
    np.testing.assert_allclose(np.abs(ratio)[clear], 1 / np.hypot(1, corner / frequency)[clear], atol=5e-3)
    np.testing.assert_array_equal(late[1], plain[1])


def _band_hz(scenario: Scenario) -> NDArray[np.float64]:
    rate = scenario.acquisition.sample_rate_hz
    frequency = np.fft.rfftfreq(round(scenario.excitation.record_s * rate) + 1, 1 / rate)
    return frequency[(frequency >= 3.0) & (frequency <= 35.0)]


def test_loose_sensor_rides_on_its_spring(rig: Scenario) -> None:
    """One sensor alone, by the motion of a mass on a shaken spring, solved in its own coordinates."""
    own_hz, damping = 40.0, 0.1
    loose = having(rig, "loose-sensor-mount", period_s=1 / own_hz, damping_ratio=damping, node=TIP)
    plain, got = (band_spectra(simulated_campaign(s, engine="linear").runs[0]) for s in (rig, loose))
    omega, own = 2 * np.pi * _band_hz(rig), 2 * np.pi * own_hz
    # Relative motion u of sensor and base: u'' + 2 ζ ω0 u' + ω0² u = -x''; the sensor reads x'' + u''.
    relative = -1 / (own**2 - omega**2 + 2j * damping * own * omega)
    expected = 1 - omega**2 * relative
    clear = np.abs(plain[3]) > 0.2 * np.median(np.abs(plain[3]))
    np.testing.assert_allclose((got[3] / plain[3])[clear], expected[clear], rtol=0.01)
    np.testing.assert_array_equal(got[[1, 2, 4, 5]], plain[[1, 2, 4, 5]])
    assert np.abs(expected).max() > 2.0


def test_swapped_sensors_exchange_their_records_and_nothing_else(rig: Scenario) -> None:
    """Labels, geometry and truth stay; the two channels' samples change places."""
    plain, swapped = (
        simulate(s, engine="linear") for s in (rig, having(rig, "swapped-sensors", node=WING, other_node=TIP))
    )
    one, other = plain.campaign.runs[0], swapped.campaign.runs[0]
    assert [c.name for c in one.channels] == [c.name for c in other.channels]
    np.testing.assert_allclose(other.samples[[3, 2, 4, 5]], one.samples[2:], atol=1e-6)
    np.testing.assert_array_equal(plain.campaign.geometry.positions_m, swapped.campaign.geometry.positions_m)
    np.testing.assert_allclose(swapped.truth.as_tested[0].shapes, plain.truth.as_tested[0].shapes, atol=1e-9)


def test_position_error_is_in_the_record_not_in_the_labels(rig: Scenario) -> None:
    """The record is that of a grid drawn where the sensor sits; geometry and truth keep to the node."""
    shift = (0.03, -0.02)
    wrong = having(rig, "sensor-position-error", node=TIP, dx_m=shift[0], dy_m=shift[1])
    grid, k = rig.accelerometers.grid, rig.accelerometers.grid.node.index(TIP)
    columns = {"x_m": shift[0], "y_m": shift[1]}
    moved = {n: tuple(v + (d if i == k else 0) for i, v in enumerate(getattr(grid, n))) for n, d in columns.items()}
    redrawn = revised(rig, accelerometers={"grid": grid.model_copy(update=moved)})
    got, wanted, plain = (responses(s)[0] for s in (wrong, redrawn, rig))
    assert largest_error(got, wanted) < 1e-9
    assert largest_error(got[1], plain[1]) > 0.01
    result = simulate(wrong, engine="linear")
    np.testing.assert_array_equal(result.campaign.geometry.position_m(TIP)[:2], [grid.x_m[k], grid.y_m[k]])
    np.testing.assert_allclose(result.truth.as_tested[0].shapes, truth_of(rig).as_tested[0].shapes, atol=1e-6)


def test_tilt_and_transverse_sensitivity_mix_in_a_sensor_that_lies_down(rig: Scenario) -> None:
    """cos Z + sin X, and Z + fraction X, with X from a sensor laid along the aircraft at the same point."""
    angle, fraction = 0.08, 0.05
    grid, k = rig.accelerometers.grid, rig.accelerometers.grid.node.index(TIP)
    lying = grid.model_copy(update={"direction": tuple("+X" if i == k else "+Z" for i in range(len(grid.node)))})
    upright, along = responses(rig)[0][1], responses(revised(rig, accelerometers={"grid": lying}))[0][1]
    choice = {"azimuth_rad": 0.0, "sensors": f"{TIP}+Z"}
    tilted, _ = responses(having(rig, "sensor-tilt", angle_rad=angle, **choice))
    assert largest_error(tilted[1], np.cos(angle) * upright + np.sin(angle) * along) < 1e-9
    mixed, _ = responses(having(rig, "transverse-sensitivity", fraction=fraction, **choice))
    assert largest_error(mixed[1], upright + fraction * along) < 1e-9
    assert largest_error(tilted[0], responses(rig)[0][0]) < 1e-9


def test_tilt_feels_gravity_as_the_body_pitches(rig: Scenario) -> None:
    """A sensor that leans aft by an angle reads sin(angle) (x'' + g θ) on top, θ nose-up pitch times the right sign."""
    angle = 0.08
    tilted = plans(having(rig, "sensor-tilt", angle_rad=angle, sensors=f"{FORE}+Z"))[0]
    driven = driven_rig(tilted, 0)
    data = at_rest(driven)
    position = tilted.run_points(0)[2]
    model = state_space(tilted, driven, (position,))
    pitch = driven.model.joint("pitch").dofadr[0]
    # Still, but pitched: all that the sensor can feel is gravity, g along its axis.
    felt = model.output_matrix[0] - model.linear.displacement[0] @ model.state_matrix[model.linear.freedoms :]
    step = 1e-6
    data.qpos[pitch] += step
    mujoco.mj_kinematics(driven.model, data)
    up_in_site = data.site(position.site).xmat.reshape(3, 3)[2]
    before = at_rest(driven).site(position.site).xmat.reshape(3, 3)[2]
    lean = np.array([np.sin(angle), 0.0, np.cos(angle)])
    assert felt[pitch] == pytest.approx(9.80665 * (up_in_site - before) @ lean / step, rel=1e-3)
    assert abs(felt[pitch]) == pytest.approx(9.80665 * np.sin(angle), rel=0.1)


@pytest.mark.parametrize("choice", ["sensor-0", "12+Q", "left"])
def test_an_unknown_choice_of_sensors_is_explained(rig: Scenario, choice: str) -> None:
    """The message lists what can be written."""
    with pytest.raises(InputError, match=r"chooses no sensor|nothing measures"):
        plans(having(rig, "channel-gain", gain_error=0.1, channels=choice))
    with pytest.raises(InputError, match="no node"):
        plans(having(rig, "sensor-position-error", dx_m=0.01, node=999))
