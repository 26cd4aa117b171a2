"""Play in the drive path and in a flap's linkage, and a hardening suspension, at several levels, by harmonic balance.

Under play the linear system is the aircraft with the same joint and none; the balance adds what play takes away.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
import pytest
from harmonic_balance import Array, Complex, Force, Vibrator, balance
from hung_hati import hung_hati
from shaken_aircraft import stepped

from vgvt.effects import Effect, make_effect
from vgvt.effects.conformance import with_effect
from vgvt.effects.suspension_hardening import STROKE_M
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation.assembly import driven_rig, plans
from vgvt.simulation.state_space import mass_above_element_kg, state_space

GRAVITY_M_PER_S2 = 9.80665
FORCE = -1


@dataclass(frozen=True, eq=False)
class Played:
    """The aircraft with a loose joint: the engine's scenario and effect, the oracle's system and law."""

    scenario: Scenario
    effect: Effect
    system: Vibrator
    force: Force


def gauged_hati() -> Scenario:
    """Hung Hati with the masses of its gauge and stinger, which ride on the joint."""
    whole = load_scenario("hati-unsymmetric")
    return hung_hati().model_copy(update={"transducer": whole.transducer, "stinger": whole.stinger})


def played(
    scenario: Scenario, tight: Effect, loose: Effect, joint: str, stiffness: float, corner: float, gap: float
) -> Played:
    """``loose`` is ``tight`` but for a gap (signed) on the far side of ``corner``, where the spring carries nothing."""
    layout = plans(with_effect(scenario, tight))[0]
    rig = driven_rig(layout, 0)
    model = state_space(layout, rig, (*layout.run_points(0), layout.drive))
    resting = driven_rig(plans(with_effect(scenario, loose))[0], 0)
    rest = resting.qpos[resting.model.joint(joint).qposadr[0]]
    row = np.zeros((1, model.linear.freedoms))
    row[0, rig.model.joint(joint).dofadr[0]] = 1.0
    pushed = np.linalg.inv(model.linear.mass) @ row.T
    moved = model.linear.displacement @ pushed
    # What a force at the joint does at once: to the accelerometers, and to the gauge by the mass that rides above it.
    passed = np.vstack([moved[:-1], -mass_above_element_kg(layout) * moved[-1:]])
    outputs = [*range(len(layout.run_points(0))), len(layout.run_points(0)) + 1]
    system = Vibrator(
        state=model.state_matrix,
        command=model.input_matrix,
        entry=np.vstack([np.zeros_like(pushed), pushed]),
        select=np.hstack([row, np.zeros_like(row)]),
        output=model.output_matrix[outputs],
        feedthrough=model.feedthrough[outputs],
        passed=passed,
    )

    def spring(place: Array) -> Array:
        low, high = sorted((corner, corner + gap))
        return np.asarray(-stiffness * (np.maximum(place - high, 0.0) + np.minimum(place - low, 0.0)))

    def force(turn: Array, rate: Array) -> Array:
        del rate
        return spring(rest + turn) - spring(np.array(rest)) + stiffness * turn

    return Played(scenario, loose, system, force)


def backlash() -> Played:
    """0.1 mm in the stinger's joint beyond 0.5 N and the weight that hangs on it."""
    joint = {"compliance_m_per_n": 1e-4, "loss_factor": 0.3}
    scenario = gauged_hati()
    pull_n = 0.5 + GRAVITY_M_PER_S2 * (scenario.transducer.mass_kg + 0.5 * scenario.stinger.mass_kg)
    tight = make_effect("mount-compliance", "test", **joint)
    loose = make_effect("shaker-backlash", "test", gap_m=1e-4, preload_n=0.5, **joint)
    return played(scenario, tight, loose, "effect-0-0", 1e4, -1e-4 * pull_n, -1e-4)


def loose_flap() -> Played:
    """Half a degree in the right outer flap's linkage; its weight alone holds it."""
    hinge = {"compliance_rad_per_n_m": 2.5, "arm_m": 0.03, "damping_ratio": 0.01}
    (flap,) = (i for i in hung_hati().airframe.item if i.name == "flap-outer")
    # The hinge's axis points outboard on the right wing, so that the weight behind it turns the trailing edge down.
    leans = -2.5 * flap.mass_kg * GRAVITY_M_PER_S2 * 0.03
    tight = make_effect("control-surface", "test", **hinge)
    loose = make_effect("control-surface-freeplay", "test", gap_rad=0.0087, **hinge)
    return played(hung_hati(), tight, loose, "effect-0-0/flap", 1 / 2.5, leans, -0.0087)


def both(case: Played, lines: list[tuple[float, float]], seconds: float, harmonics: int) -> tuple[Complex, Complex]:
    """Fourier coefficients (lines, outputs, harmonics + 1) by the oracle and by the engine."""
    wanted = [balance(case.system, case.force, 2 * np.pi * hz, v, harmonics).outputs for hz, v in lines]
    return np.array(wanted), stepped(case.scenario, case.effect, lines, seconds, harmonics=5)


def agree(wanted: Complex, got: Complex, first: float, higher: float) -> None:
    """The first harmonic within ``first`` of itself, the second and third within ``higher`` of the first."""
    assert np.abs(got[:, :, 1] / wanted[:, :, 1] - 1).max() < first
    for order in (2, 3):
        assert (np.abs(got[:, :, order] - wanted[:, :, order]) / np.abs(wanted[:, :, 1])).max() < higher


def test_backlash_at_one_level() -> None:
    """The quick one: just open, at 0.3 V; its third harmonic is 2 % of the force."""
    wanted, got = both(backlash(), [(12.0, 0.3)], 5.0, 31)
    agree(wanted, got, 3e-3, 4e-3)
    assert abs(wanted[0, FORCE, 3] / wanted[0, FORCE, 1]) > 0.02


@pytest.mark.slow
def test_backlash_opens_with_level_and_closes_in_proportion() -> None:
    """Nothing below the preload; most harmonics just above it; at high level the gap is a small part of the way."""
    lines = [(12.0, v) for v in (0.02, 0.3, 1.0, 3.0)]
    wanted, got = both(backlash(), lines, 6.0, 31)
    agree(wanted, got, 3e-3, 4e-3)
    second = np.abs(got[:, FORCE, 2] / got[:, FORCE, 1])
    assert second[0] < 1e-4
    assert second[1] > second[2] > second[3] > 1e-3


@pytest.mark.slow
def test_a_loose_flap_lets_go_where_its_weight_no_longer_holds_it() -> None:
    """Linear while it turns by less than the weight's own 32 mrad; above that harmonics, of its own side most."""
    lines = [(18.0, 0.05), (18.0, 0.4), (18.0, 1.0), (18.0, 1.5)]
    case = loose_flap()
    wanted, got = both(case, lines, 6.0, 31)
    agree(wanted, got, 2e-3, 2e-3)
    # Sensor 1 is at the root of the same wing, sensor 10 near the flap.
    near = np.abs(got[:, 1, 3] / got[:, 1, 1])
    assert near[:2].max() < 1e-3
    assert near[2] > 0.01
    turn = np.abs(balance(case.system, case.force, 2 * np.pi * 18.0, 0.4, 31).motion[0, 1])
    assert turn < 0.032


@pytest.mark.slow
def test_a_spring_that_hardens_lifts_heave_with_level() -> None:
    """Stepped heave of the rig at 2.9 Hz against harmonic balance of k x + k3 x³ along the spring."""
    scenario, hardening = hung_hati(), 20.0
    layout = plans(scenario)[0]
    rig = driven_rig(layout, 0)
    model = state_space(layout, rig, layout.run_points(0))
    data = mujoco.MjData(rig.model)
    data.qpos[:] = rig.qpos
    row = np.zeros((1, model.linear.freedoms))
    for j in range(model.linear.freedoms):
        data.qvel[:] = np.eye(model.linear.freedoms)[j]
        mujoco.mj_forward(rig.model, data)
        row[0, j] = data.ten_velocity[rig.model.tendon("suspension").id]
    pushed = np.linalg.inv(model.linear.mass) @ row.T
    system = Vibrator(
        state=model.state_matrix,
        command=model.input_matrix,
        entry=np.vstack([np.zeros_like(pushed), pushed]),
        select=np.hstack([row, np.zeros_like(row)]),
        output=model.output_matrix,
        feedthrough=model.feedthrough,
        passed=np.vstack([model.linear.displacement @ pushed, np.zeros((1, 1))]),
    )
    cubic = hardening * scenario.suspension.stiffness_n_per_m / (3 * STROKE_M**2)

    def force(stretch: Array, rate: Array) -> Array:
        del rate
        return np.asarray(-cubic * stretch**3)

    effect = make_effect("suspension-hardening", "test", hardening=hardening)
    lines = [(2.9, v) for v in (0.02, 0.5, 1.0)]
    wanted = np.array([balance(system, force, 2 * np.pi * hz, v, 7).outputs for hz, v in lines])
    got = stepped(scenario, effect, lines, 12.0, harmonics=5)
    agree(wanted, got, 5e-3, 5e-3)
    per_volt = np.abs(got[:, 0, 1] / np.array([v for _, v in lines]))
    assert per_volt[2] < 0.95 * per_volt[0]
