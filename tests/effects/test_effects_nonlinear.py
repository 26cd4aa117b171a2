"""Nonlinear root joints against exact solutions of one degree of freedom.

The rig is an arm on a root joint of a body too heavy to move, so that the assembled
MuJoCo model has one mode in reach: I θ'' + torque(θ, θ') = T(t), I = m L³ / 3 known by hand.
"""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
import pytest
import scipy.integrate
import scipy.special
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.effects import Effect, make_effect
from vgvt.effects.conformance import table_of, with_effect
from vgvt.scenario import Airframe, Beam, Body, Damping, Scenario, Stations, load_scenario
from vgvt.simulation import simulated_campaign
from vgvt.simulation.assembly import bare_rig, plans
from vgvt.simulation.effect_conformance import example_scenario

STIFFNESS = 2000.0
INERTIA = 1.0 / 3.0
OMEGA = np.sqrt(STIFFNESS / INERTIA)
STEP_S = 1e-4
# Friction acts on the short link at the root, whose own fast motion the step must follow.
FRICTION_STEP_S = 2.5e-5


def arm(*effects: Effect) -> mujoco.MjModel:
    """One metre and one kilogram of nearly rigid arm on a root joint with the effects' law."""
    stations = Stations(
        position_m=((0.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
        bending_stiffness_n_m2=(4e6, 4e6),
        torsional_stiffness_n_m2=(1e3, 1e3),
        mass_kg_per_m=(1.0, 1.0),
        pitch_inertia_kg_m=(1e-3, 1e-3),
    )
    airframe = Airframe(
        name="arm",
        body=Body(mass_kg=1e7, centre_of_gravity_m=(0.0, 0.0, 0.0), inertia_kg_m2=(1e7, 1e7, 1e7)),
        beam=(Beam(name="arm", cells=1, root_bending_stiffness_n_m_per_rad=STIFFNESS, stations=stations),),
        damping=Damping(damping_ratio=1e-7),
    )
    whole = load_scenario("quick")
    grid = whole.accelerometers.grid.model_copy(
        update={"node": (1,), "x_m": (0.0,), "y_m": (1.0,), "z_m": None, "attached_to": None, "direction": None}
    )
    scenario = whole.model_copy(
        update={
            "airframe": airframe,
            "accelerometers": whole.accelerometers.model_copy(update={"grid": grid}),
            "acquisition": whole.acquisition.model_copy(update={"runs": ((1,),)}),
        }
    )
    tables = tuple(table_of(effect) for effect in effects)
    return bare_rig(plans(scenario.model_copy(update={"effect": tables}))[0]).model


@pytest.mark.parametrize("first", ["gap", "cubic"])
def test_a_joint_with_a_gap_and_a_cubic_spring_has_the_torque_of_both(first: str) -> None:
    """k p + k3 p³ of what is left of the angle beyond the gap, and nothing within it."""
    gap = make_effect("root-freeplay", "test", kind="bending", gap_rad=2e-3)
    cubic = make_effect("cubic-root-stiffness", "test", kind="bending", cubic_n_m_per_rad3=1e8)
    model = arm(*((gap, cubic) if first == "gap" else (cubic, gap)))
    data = mujoco.MjData(model)
    root = int(model.joint("arm-root/bending").qposadr[0])
    for angle in (-8e-3, -5e-4, 9e-4, 4e-3):
        data.qpos[root] = angle
        mujoco.mj_forward(model, data)
        beyond = np.sign(angle) * max(abs(angle) - 1e-3, 0.0)
        assert data.qfrc_passive[root] == pytest.approx(-(STIFFNESS * beyond + 1e8 * beyond**3), rel=1e-9, abs=1e-9)


def motion(
    effect: Effect,
    start_rad: float,
    duration_s: float,
    torque_n_m: Callable[[float], float] = lambda _: 0.0,
    step_s: float = STEP_S,
) -> NDArray[np.float64]:
    """Angle of the root joint, (steps + 1,), let go at ``start_rad`` under an outer torque, N m at a time in s."""
    model = arm(effect)
    model.opt.timestep = step_s
    data = mujoco.MjData(model)
    joint = model.joint("arm-root/bending")
    address, dof = int(joint.qposadr[0]), int(joint.dofadr[0])
    data.qpos[address] = start_rad
    angle = np.empty(round(duration_s / step_s) + 1)
    for k in range(angle.size):
        angle[k] = data.qpos[address]
        data.qfrc_applied[dof] = torque_n_m(k * step_s)
        mujoco.mj_step(model, data)
    return angle


def period_s(angle: NDArray[np.float64]) -> float:
    """Mean time between upward zero crossings."""
    up = np.flatnonzero((angle[:-1] < 0) & (angle[1:] >= 0))
    times = (up - angle[up] / (angle[up + 1] - angle[up])) * STEP_S
    return float(np.diff(times).mean())


def turning_points(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """The largest angle of every half swing of a decay, the start included, without sign."""
    swings = np.split(np.abs(angle), np.flatnonzero(np.diff(np.sign(angle)) != 0) + 1)
    return np.array([swing.max() for swing in swings])


@pytest.mark.parametrize("cubic", [1e5, 1e6, 1e7])
def test_cubic_joint_has_the_period_of_duffing(cubic: float) -> None:
    """T = 4 K(m) / sqrt(ω² + α A²), m = α A² / 2(ω² + α A²), α = k3 / I (Nayfeh and Mook)."""
    amplitude = 0.02
    alpha = cubic / INERTIA * amplitude**2
    expected = 4 * scipy.special.ellipk(alpha / (2 * (OMEGA**2 + alpha))) / np.sqrt(OMEGA**2 + alpha)
    effect = make_effect("cubic-root-stiffness", "test", cubic_n_m_per_rad3=cubic)
    assert period_s(motion(effect, amplitude, 0.6)) == pytest.approx(expected, rel=3e-4)
    assert expected < 0.995 * 2 * np.pi / OMEGA


@pytest.mark.parametrize("gap", [2e-3, 8e-3])
def test_play_lengthens_the_period_by_the_time_in_the_gap(gap: float) -> None:
    """T = 2π/ω + 2 gap / v: half a sine on each side, and the gap crossed twice at v = ω (A - gap/2)."""
    amplitude = 0.02
    speed = OMEGA * (amplitude - gap / 2)
    effect = make_effect("root-freeplay", "test", gap_rad=gap, kind="bending")
    expected = 2 * np.pi / OMEGA + 2 * gap / speed
    assert period_s(motion(effect, amplitude, 0.6)) == pytest.approx(expected, rel=3e-4)


def test_friction_takes_the_same_off_every_swing_and_then_holds() -> None:
    """Coulomb: each half swing loses 2 M / k of amplitude; it stays where spring torque falls below M."""
    friction = 0.5
    effect = make_effect("root-friction", "test", friction_n_m=friction)
    unit = friction / STIFFNESS
    angle = motion(effect, 10.3 * unit, 0.5, step_s=FRICTION_STEP_S)
    swings = turning_points(angle)
    np.testing.assert_allclose(swings / unit, [10.3, 8.3, 6.3, 4.3, 2.3, 0.3], atol=0.02)
    # The arm itself rings without damping and shakes the joint a little while it holds.
    assert np.ptp(angle[-4000:]) < 0.1 * unit


@pytest.mark.parametrize("frequency_hz", [0.0, 10.0])
def test_a_stuck_joint_is_rigid(frequency_hz: float) -> None:
    """Below the slip torque nothing turns, neither under a steady nor under an alternating load."""
    friction = 0.5
    effect = make_effect("root-friction", "test", friction_n_m=friction)
    angle = motion(effect, 0.0, 0.5, lambda t: 0.9 * friction * np.cos(2 * np.pi * frequency_hz * t))
    assert np.abs(angle).max() < 1e-3 * 0.9 * friction / STIFFNESS


@pytest.mark.parametrize(("ratio", "load"), [(0.6, 1.2), (1.3, 3.0)])
def test_forced_friction_meets_den_hartog(ratio: float, load: float) -> None:
    """x k/T = sqrt(1/(1-r²)² - (M/T)² (sin(π/r) / (r (1 + cos(π/r))))²), without stops (Trans. ASME 53, 1931)."""
    friction = 0.5
    turning = np.sin(np.pi / ratio) / (ratio * (1 + np.cos(np.pi / ratio)))
    expected = load / STIFFNESS * np.sqrt((1 / (1 - ratio**2)) ** 2 - (friction / load * turning) ** 2)
    effect = make_effect("root-friction", "test", friction_n_m=friction)
    angle = motion(effect, 0.0, 3.0, lambda t: load * np.cos(ratio * OMEGA * t))
    assert np.abs(angle[-4000:]).max() == pytest.approx(expected, rel=5e-3)
    without = load / STIFFNESS / abs(1 - ratio**2)
    assert abs(expected / without - 1) > 0.02


def drag(growth: float) -> float:
    """Coefficient c2 of c2 |θ'| θ' on the arm: modal drag 3 π growth / 4 at the coordinate sqrt(I) θ."""
    return 0.75 * np.pi * growth * INERTIA**1.5


def test_quadratic_damping_follows_the_ordinary_differential_equation() -> None:
    """Against scipy's solution of I θ'' + c2 |θ'| θ' + k θ = 0 over ten cycles."""
    growth, amplitude = 1.5, 0.05
    angle = motion(make_effect("amplitude-dependent-damping", "test", growth_per_rtkg_m=growth), amplitude, 0.8)
    time = np.arange(angle.size) * STEP_S
    solved = scipy.integrate.solve_ivp(
        lambda _, x: [x[1], -(STIFFNESS * x[0] + drag(growth) * abs(x[1]) * x[1]) / INERTIA],
        (0.0, time[-1]),
        [amplitude, 0.0],
        t_eval=time,
        rtol=1e-9,
        atol=1e-12,
    ).y[0]
    np.testing.assert_allclose(turning_points(angle)[:15], turning_points(solved)[:15], rtol=2e-3)
    assert turning_points(solved)[15] < 0.6 * amplitude


@pytest.mark.parametrize("amplitude", [0.01, 0.04])
def test_damping_ratio_grows_by_growth_times_modal_amplitude(amplitude: float) -> None:
    """Logarithmic decrement of half a swing is π ζ with ζ = growth sqrt(I) Θ (Krylov and Bogoliubov)."""
    growth = 0.5
    swings = turning_points(
        motion(make_effect("amplitude-dependent-damping", "test", growth_per_rtkg_m=growth), amplitude, 0.12)
    )
    expected = np.pi * growth * np.sqrt(INERTIA) * np.sqrt(swings[0] * swings[1])
    assert np.log(swings[0] / swings[1]) == pytest.approx(expected, rel=0.02)


def test_the_hung_aircraft_sticks_at_low_level_and_slips_at_high_level() -> None:
    """Stepped friction tends to the rigid root for a quiet test and to the slipping joint for a loud one."""

    def accelerance(scenario: Scenario, engine: str) -> NDArray[np.complex128]:
        record = simulated_campaign(scenario, engine=engine).runs[0]
        frequency = np.fft.rfftfreq(record.samples.shape[1], 1 / record.sample_rate_hz)
        spectra = np.fft.rfft(record.samples, axis=1)[:, (frequency > 4) & (frequency < 34)]
        return np.asarray(spectra[2:] / spectra[1])

    def distance(got: NDArray[np.complex128], wanted: NDArray[np.complex128]) -> float:
        return float(np.linalg.norm(got - wanted) / np.linalg.norm(wanted))

    stuck = accelerance(example_scenario(0.02), "linear")
    slight = with_effect(example_scenario(1.0), make_effect("root-friction", "test", friction_n_m=0.02))
    slipping = accelerance(slight, "linear")
    assert distance(slipping, stuck) > 1.0
    # The damping of the airframe is set with the joint free, so that the stuck peaks differ by some percent.
    firm = make_effect("root-friction", "test", friction_n_m=2.0)
    assert distance(accelerance(with_effect(example_scenario(0.02), firm), "mujoco"), stuck) < 0.06
    assert distance(accelerance(slight, "mujoco"), slipping) < 0.2


def test_an_own_root_spring_is_kept_and_an_unknown_beam_refused() -> None:
    """The law applies to the joint that the scenario gives; a rigid root gets one of the stated stiffness."""
    scenario = load_scenario("quick")
    effect = make_effect("cubic-root-stiffness", "test", cubic_n_m_per_rad3=1e6, side="left")
    (law,) = effect.act(scenario, 0).elements
    assert (law.beam, law.stiffness_n_m_per_rad) == ("wing-left", 2000.0)
    wing = scenario.airframe.beam[0].model_copy(update={"root_bending_stiffness_n_m_per_rad": 900.0})
    airframe = scenario.airframe.model_copy(update={"beam": (wing,)})
    laws = make_effect("root-friction", "test", friction_n_m=1.0).act(
        scenario.model_copy(update={"airframe": airframe}), 0
    )
    assert [law.stiffness_n_m_per_rad for law in laws.elements] == [900.0, 900.0]
    with pytest.raises(InputError, match="no beam 'fin'"):
        make_effect("root-friction", "test", friction_n_m=1.0, beam="fin").act(scenario, 0)


@pytest.mark.parametrize("name", ["cubic-root-stiffness", "root-freeplay", "root-friction"])
def test_root_joints_are_found_on_wings_that_another_effect_wrote_out(name: str) -> None:
    """After an effect that gives each side a table of its own, the law acts on the sides that are asked for."""
    scenario = load_scenario("quick")
    size = {
        "cubic-root-stiffness": "cubic_n_m_per_rad3",
        "root-freeplay": "gap_rad",
        "root-friction": "friction_n_m",
    }[name]
    split = make_effect("stiffness-asymmetry", "test", bending=0.1).act(scenario, 0).scenario
    assert split is not None
    for side, beam, wanted in (
        ("both", "", ["wing-right", "wing-left"]),
        ("both", "wing", ["wing-right", "wing-left"]),
        ("left", "wing", ["wing-left"]),
        ("right", "", ["wing-right"]),
        ("both", "wing-left", ["wing-left"]),
    ):
        action = make_effect(name, "test", side=side, beam=beam, **{size: 1e-3}).act(split, 0)
        assert [law.beam for law in action.elements] == wanted
    with pytest.raises(InputError, match="no right copy"):
        make_effect(name, "test", side="right", beam="wing-left", **{size: 1e-3}).act(split, 0)
    both = (make_effect("stiffness-asymmetry", "test", bending=0.1), make_effect(name, "test", **{size: 1e-3}))
    chained = scenario.model_copy(update={"effect": tuple(table_of(effect) for effect in both)})
    assert bare_rig(plans(chained)[0]).model.joint(
        "wing-left-root/bending" if "play" not in name else "wing-left-root/torsion"
    )


def test_warming_follows_the_ordinary_differential_equation() -> None:
    """An arm that is let go, I θ'' + k (1 - s (1 - exp(-t/T))) θ = 0, against scipy over thirty swings."""
    softening, constant_s, step_s = 0.4, 0.2, 1e-4
    model = arm(make_effect("warm-up", "test", softening=softening, time_constant_s=constant_s))
    model.opt.timestep = step_s
    data = mujoco.MjData(model)
    joint = model.joint("arm-root/bending")
    data.qpos[int(joint.qposadr[0])] = 0.02
    angle = np.empty(6001)
    for k in range(angle.size):
        angle[k] = data.qpos[int(joint.qposadr[0])]
        mujoco.mj_step(model, data)
    time = np.arange(angle.size) * step_s
    solved = scipy.integrate.solve_ivp(
        lambda t, x: [x[1], -STIFFNESS * (1 - softening * (1 - np.exp(-t / constant_s))) * x[0] / INERTIA],
        (0.0, time[-1]),
        [0.02, 0.0],
        t_eval=time,
        rtol=1e-9,
        atol=1e-12,
    ).y[0]

    def crossings(x: NDArray[np.float64]) -> NDArray[np.float64]:
        up = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))
        return np.asarray(time[up] - x[up] / (x[up + 1] - x[up]) * step_s)

    # The arm bends a little, which adds 5e-4 to its compliance.
    np.testing.assert_allclose(crossings(angle), crossings(solved), rtol=1e-3)
    periods = np.diff(crossings(angle))
    assert periods[-1] / periods[0] > 1.1
