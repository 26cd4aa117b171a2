"""The rig obeys its own equations: coil and armature, drop-out, reciprocity, the mass of roving sensors."""

from __future__ import annotations

import numpy as np
import pytest
from small_rig import revised

from vgvt.data import InputError, ModalModel
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import simulated_campaign, truth_of
from vgvt.simulation.airframe import Pushed
from vgvt.simulation.assembly import driven_rig, hung_rig, plan
from vgvt.simulation.linear import linearise
from vgvt.simulation.modes import modal_model
from vgvt.simulation.pushed import pushed_beams
from vgvt.simulation.state_space import StateSpace, state_space


def transfer(model: StateSpace, frequency_hz: np.ndarray) -> np.ndarray:
    """Measured force per volt of command, shape of ``frequency_hz``."""
    identity = np.eye(model.input_matrix.size)
    states = [np.linalg.solve(2j * np.pi * f * identity - model.state_matrix, model.input_matrix) for f in frequency_hz]
    return np.asarray(model.output_matrix[-1] @ np.array(states).T + model.feedthrough[-1])


def accelerance(scenario: Scenario, frequency_hz: np.ndarray) -> np.ndarray:
    """Drive-point accelerance (lines,) of the hung structure by direct solution."""
    layout = plan(scenario)
    rig = hung_rig(layout, 0)
    linear = linearise(rig.model, rig.qpos, ((layout.drive.site, np.array([0.0, 0.0, 1.0])),))
    row = linear.displacement[0]
    s = 2j * np.pi * frequency_hz
    stiffness = [k * k * linear.mass + k * linear.damping + linear.stiffness for k in s]
    return np.array([k * k * row @ np.linalg.solve(z, row) for k, z in zip(s, stiffness, strict=True)])


@pytest.mark.parametrize("inductance_h", [0.0, 6e-4, 1.2e-2])
def test_force_follows_from_the_shaker_equations(small: Scenario, inductance_h: float) -> None:
    """Force per volt equals m x'' + c x' + k x = Bl i - F, V = R i + L di/dt + Bl x' loaded by the structure.

    The expectation is the textbook's circuit, solved with the structure's own accelerance and no MuJoCo element
    of the shaker; the stinger is a spring and dashpot in series. Inductance is the exact R-L here, up to a lag of 3 ms.
    """
    small = revised(small, shaker={"coil_inductance_h": inductance_h})
    frequency = np.linspace(3, 80, 800)
    layout = plan(small)
    got = transfer(state_space(layout, driven_rig(layout, 0), layout.points), frequency)
    sh, st, tr = small.shaker, small.stinger, small.transducer
    s = 2j * np.pi * frequency
    receptance = accelerance(small, frequency) / s**2
    above = tr.mass_kg - tr.end_mass_kg + 0.5 * st.mass_kg
    # Structure and the mass above the sensing element, then the rod in series, seen from the armature.
    loaded = 1 / (1 / receptance + above * s**2)
    seen = loaded + 1 / (st.axial_stiffness_n_per_m + st.axial_damping_n_s_per_m * s)
    armature = (sh.armature_mass_kg + 0.5 * st.mass_kg) * s**2 + sh.flexure_damping_n_s_per_m * s
    armature = armature + sh.flexure_stiffness_n_per_m
    impedance = sh.coil_resistance_ohm + sh.coil_inductance_h * s
    blocked = sh.force_factor_n_per_a * sh.amplifier_gain / impedance
    armature = armature + sh.force_factor_n_per_a**2 * s / impedance
    rod_force = blocked / (armature + 1 / seen) / seen
    expected = rod_force * loaded / receptance
    # What is left is the sensor's tilt in gravity, which the circuit leaves out.
    assert np.abs(got / expected - 1).max() < 5e-4


def test_force_drops_out_at_resonance(small: Scenario) -> None:
    """The force per volt has its minima where the drive point's mobility peaks: at the modes as tested."""
    modes = truth_of(small).as_tested[0].band(4.0, 36.0)
    strongest = modes.select([int(np.argmax(np.abs(modes.residues[:, -1, 0] * modes.poles)))])
    centre = float(strongest.natural_frequency_hz[0])
    frequency = np.linspace(centre - 1.0, centre + 1.0, 801)
    layout = plan(small)
    force = np.abs(transfer(state_space(layout, driven_rig(layout, 0), layout.points), frequency))
    assert frequency[np.argmin(force)] == pytest.approx(centre, rel=0.01)
    assert force.min() < 0.3 * force[[0, -1]].min()


def test_voltage_drive_damps_the_coupled_system_and_current_drive_does_not(small: Scenario) -> None:
    """Bl²/R shows in the poles of A/V, not in those of A/F."""

    def damping(drive: str) -> tuple[np.ndarray, np.ndarray]:
        truth = truth_of(revised(small, shaker={"drive": drive}))
        return truth.coupled[0].band(4, 60).damping_ratio, truth.as_tested[0].band(4, 60).damping_ratio

    voltage, as_tested = damping("voltage")
    current, unchanged = damping("current")
    assert voltage.sum() > 1.3 * current.sum()
    np.testing.assert_allclose(as_tested, unchanged, rtol=1e-9)


def test_reciprocity_between_two_campaigns(small: Scenario) -> None:
    """Shaking here and measuring there equals the reverse: two rigs assembled apart, with weightless instruments.

    Exactly on the same links; as each is cut for its own shaker, but for what two cuts of one wing differ by.
    """
    weightless = revised(small, accelerometers={"mass_kg": 0.0}, transducer={"mass_kg": 0.0, "end_mass_kg": 0.0})
    weightless = revised(weightless, stinger={"mass_kg": 0.0})
    grid = weightless.accelerometers.grid
    there = grid.node.index(10)
    position = (grid.x_m[there], grid.y_m[there], 0.0)
    here = weightless.shaker.position_m
    swapped = revised(
        weightless,
        shaker={"position_m": position, "attached_to": "wing-right"},
        accelerometers={
            "grid": grid.model_copy(
                update={
                    "node": (1, 10),
                    "x_m": (grid.x_m[0], here[0]),
                    "y_m": (grid.y_m[0], here[1]),
                    "z_m": (0.0, here[2]),
                    "attached_to": ("wing-right", "body"),
                    "direction": None,
                }
            )
        },
    )
    cut = pushed_beams(swapped)
    forward, backward = _residues_at_10(weightless, cut), _residues_at_10(swapped, cut)
    assert forward.size == backward.size > 3
    np.testing.assert_allclose(forward, backward, rtol=1e-5, atol=1e-7 * np.abs(forward).max())
    np.testing.assert_allclose(_residues_at_10(weightless, pushed_beams(weightless)), backward, rtol=2e-3)


def _residues_at_10(scenario: Scenario, pushed: Pushed) -> np.ndarray:
    """Residues (modes,) of the displacement at point 10: what sensors feel of gravity has no counterpart in a push."""
    layout = plan(revised(scenario, acquisition={"runs": ((10,),)}), pushed)
    rig = hung_rig(layout, 0)
    points = tuple((p.site, p.dof.direction.unit_vector) for p in layout.points)
    linear = linearise(rig.model, rig.qpos, points)
    elastic = modal_model(linear, tuple(p.dof for p in layout.points), len(points) - 1, 60.0).band(4.0, 60.0)
    return elastic.residues[:, [d.node for d in elastic.dofs].index(10), 0]


def test_roving_mass_shifts_poles_by_half_phi_squared_m(small: Scenario) -> None:
    """Δω/ω = -φ² m / 2 for a small mass m where the mass-normalised shape is φ (Rayleigh).

    Without gravity: two grams at the tips also trim the aircraft, which moves the first bending by another 1e-4.
    """

    def modes(mass_kg: float) -> ModalModel:
        layout = plan(revised(small, accelerometers={"mass_kg": mass_kg}, acquisition={"runs": ((10,),)}))
        model = hung_rig(layout, 0).model
        model.opt.gravity[:] = 0.0
        points = tuple((p.site, p.dof.direction.unit_vector) for p in layout.points)
        linear = linearise(model, np.zeros(model.nq), points)
        return modal_model(linear, tuple(p.dof for p in layout.points), len(points) - 1, 40.0).band(5.0, 40.0)

    without, with_mass = modes(1e-4), modes(2e-3)
    index = [d.node for d in without.dofs].index(10)
    expected = -0.5 * 1.9e-3 * without.shapes[:, index].real ** 2 / without.modal_mass_kg
    shift = with_mass.natural_frequency_hz / without.natural_frequency_hz - 1
    np.testing.assert_allclose(shift, expected, rtol=0.02)
    assert shift.min() < -1e-4


def test_poles_move_from_run_to_run_as_the_sensors_do() -> None:
    """Sensors at the tips lower the first bending more than sensors at the roots."""
    truth = truth_of(load_scenario("hati-unsymmetric"))
    first = [run.band(5.0, 12.0).natural_frequency_hz[0] for run in truth.as_tested]
    assert first[4] < first[0]
    assert np.ptp(first) / np.mean(first) > 1e-4


def test_a_hook_below_the_centre_of_gravity_is_refused(small: Scenario) -> None:
    """The equilibrium there is unstable: the message says where the hook must be."""
    x, y, _ = small.suspension.hook_m
    with pytest.raises(InputError, match=r"suspension.hook_m: the hung aircraft would turn over.*\n.*above the centre"):
        truth_of(revised(small, suspension={"hook_m": (x, y, -0.2)}))


def test_sag_is_settled_before_the_record_starts(small: Scenario) -> None:
    """With the shaker silent nothing moves, at full gravity."""

    silent = revised(small, excitation={"amplitude_v": 1e-9, "duration_s": 1.0, "ring_down_s": 1.0, "taper_s": 0.1})
    record = simulated_campaign(silent, engine="mujoco").runs[0]
    assert np.abs(record.samples[1:]).max() < 1e-6
