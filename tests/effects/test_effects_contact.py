"""One-sided springs against piecewise solutions known in closed form."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import scipy.integrate
from hung_hati import hung_hati, made
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.effects.elements import MountCompliance, RattlingMass
from vgvt.simulation.airframe import ROOT, cut_airframe
from vgvt.simulation.assembly import plan
from vgvt.simulation.elements import add_elements
from vgvt.simulation.linear import linearise, settle
from vgvt.simulation.rig import GRAVITY_M_PER_S2, TRANSDUCER, add_point_mass

MASS_KG = 0.02
STEP_S = 1e-5
PUSH = plan(hung_hati()).drive


def on_the_ground(*elements: MountCompliance | RattlingMass, gravity: bool) -> mujoco.MjModel:
    """The elements on a body that holds still, mounts with a transducer of MASS_KG; its coordinate is the first.

    It could slide sideways: several joints on the ground itself MuJoCo takes for those of so many directions.
    """
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.option.timestep = STEP_S
    spec.option.gravity = [0.0, 0.0, -GRAVITY_M_PER_S2 if gravity else 0.0]
    ground = spec.worldbody.add_body(name=ROOT, mass=1.0, inertia=[1.0, 1.0, 1.0], explicitinertial=True)
    ground.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[1.0, 0.0, 0.0])
    parts = cut_airframe(hung_hati().airframe)
    if isinstance(elements[0], MountCompliance):
        add_point_mass(spec, parts, TRANSDUCER, ROOT, np.array(parts.origin_m[ROOT]), MASS_KG)
    add_elements(spec, parts, [(f"it-{k}", element) for k, element in enumerate(elements)], (PUSH,))
    model: mujoco.MjModel = spec.compile()
    return model


def motion(model: mujoco.MjModel, start_m: float, duration_s: float) -> NDArray[np.float64]:
    """The one coordinate of what is on the ground, let go at a place, (steps + 1,)."""
    data = mujoco.MjData(model)
    data.qpos[1] = start_m
    place = np.empty(round(duration_s / STEP_S) + 1)
    for k in range(place.size):
        place[k] = data.qpos[1]
        mujoco.mj_step(model, data)
    return place


def period_s(place: NDArray[np.float64], level: float = 0.0) -> float:
    """Mean time between upward crossings of a level."""
    x = place - level
    up = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))
    times = (up - x[up] / (x[up + 1] - x[up])) * STEP_S
    return float(np.diff(times).mean())


@pytest.mark.parametrize("ratio", [0.2, 0.7])
def test_a_mount_that_lifts_off_swings_half_and_half(ratio: float) -> None:
    """Without preload and weight: T = π/ω + π/(ω sqrt(ratio)), and the pull side is 1/sqrt(ratio) as wide."""
    stiffness = 2e4
    omega = np.sqrt(stiffness / MASS_KG)
    place = motion(on_the_ground(MountCompliance(stiffness, 0.0, ratio), gravity=False), 1e-5, 0.1)
    assert period_s(place) == pytest.approx(np.pi / omega * (1 + 1 / np.sqrt(ratio)), rel=1e-4)
    assert place.max() == pytest.approx(1e-5, rel=1e-3)
    assert -place.min() == pytest.approx(1e-5 / np.sqrt(ratio), rel=1e-3)


@pytest.mark.parametrize(("preload", "ratio"), [(0.05, 0.3), (1.0, 0.3)])
def test_a_preloaded_mount_follows_the_ordinary_differential_equation(preload: float, ratio: float) -> None:
    """m x'' = -k x above -p/k and slope ratio · k below, with the weight that hangs on it, against scipy."""
    stiffness = 2e4
    corner = -preload / stiffness

    def force(x: float) -> float:
        return -stiffness * x if x > corner else preload - ratio * stiffness * (x - corner)

    start = 1.2e-5
    place = motion(on_the_ground(MountCompliance(stiffness, 0.0, ratio, preload), gravity=True), start, 0.05)
    time = np.arange(place.size) * STEP_S
    solved = scipy.integrate.solve_ivp(
        lambda _, x: [x[1], force(x[0]) / MASS_KG - GRAVITY_M_PER_S2],
        (0.0, time[-1]),
        [start, 0.0],
        t_eval=time,
        rtol=1e-9,
        atol=1e-14,
        max_step=1e-4,
    ).y[0]
    np.testing.assert_allclose(place, solved, atol=2e-3 * np.ptp(solved))
    # The weight of 0.2 N is carried by the larger preload only.
    linear = np.sqrt(stiffness / MASS_KG)
    slow = period_s(place, -MASS_KG * GRAVITY_M_PER_S2 / stiffness) * linear / (2 * np.pi)
    assert slow == pytest.approx(1.0, abs=1e-3) if preload > 0.5 else slow > 1.2


@pytest.mark.parametrize(
    "laws",
    [
        ((1e4, 0.1 / 6.3),),
        ((1e4, 0.3 / 63.0), (4e3, 0.1 / 63.0)),
        # Neither is like the other: glue with clay that loses all it takes at 1 Hz, and something without a loss.
        ((5e6, 0.05 / 220.0), (4e3, 1.0 / 6.3), (8e3, 0.0)),
    ],
)
def test_mounts_in_series_add_their_compliances(laws: tuple[tuple[float, float], ...]) -> None:
    """F/x = k - ω² m, 1/k the sum of 1/(k + iωc), but for what gives 25 µs late; a single mount does not."""
    model = on_the_ground(*(MountCompliance(k, k * late) for k, late in laws), gravity=False)
    linear = linearise(model, np.zeros(model.nq))
    stiffness = linear.stiffness + np.diag([1.0, *(0.0 for _ in laws)])
    omega = 2 * np.pi * np.linspace(1.0, 40.0, 40)
    together = np.array([0.0, *(1.0 for _ in laws)])
    got = np.array([
        together @ np.linalg.solve(stiffness + 1j * w * linear.damping - w**2 * linear.mass, together)
        for w in omega
    ])  # fmt: skip
    give = sum(1 / (k * (1 + 1j * omega * late)) for k, late in laws)
    allowed = 1e-8 if len(laws) == 1 else omega * 2.5e-5
    assert np.all(np.abs(1 / (1 / got + omega**2 * MASS_KG) / give - 1) < allowed)
    state = np.block([[np.zeros((model.nq, model.nq)), np.eye(model.nq)], [-stiffness, -linear.damping]])
    state[model.nq :] = np.linalg.solve(linear.mass, state[model.nq :])
    poles = np.linalg.eigvals(state)
    assert poles.real.max() < 1e-9 * np.abs(poles).max()
    # Nothing is faster than what makes them late: it can be stepped in time.
    assert len(laws) == 1 or np.abs(poles).max() < 4.1e4


@pytest.mark.parametrize("pull_n", [-0.5, 0.2, 0.7, 1.5, 3.0])
def test_what_gives_in_series_is_the_sum_of_what_each_gives(pull_n: float) -> None:
    """A joint with play on a mount that lifts off, on one that only gives: pulled, each goes by its own law."""
    play = MountCompliance(1e4, 5.0, preload_n=0.6, gap_m=2e-4)
    lifting = MountCompliance(2e4, 5.0, tension_ratio=0.3, preload_n=1.1)
    plain = MountCompliance(5e3, 5.0)
    model = on_the_ground(play, lifting, plain, gravity=True)
    model.opt.gravity[2] = -pull_n / MASS_KG
    beyond = max(0.0, pull_n - lifting.preload_n) * (1 / lifting.tension_ratio - 1)
    wanted = -np.array([
        pull_n / play.stiffness_n_per_m + (play.gap_m if pull_n > play.preload_n else 0.0),
        (pull_n + beyond) / lifting.stiffness_n_per_m,
        pull_n / plain.stiffness_n_per_m,
    ])  # fmt: skip
    # The preload of the play is the pull of a spring of 1 km: 1e-3 of its stiffness across the gap.
    model.jnt_stiffness[0] = 1.0
    np.testing.assert_allclose(settle(model)[1:], wanted, rtol=1e-4, atol=2e-8)


@pytest.mark.parametrize("height_m", [2e-4, 8e-4])
def test_a_rattling_mass_bounces_as_on_a_spring(height_m: float) -> None:
    """Dropped: 2 v/g in the air and (2/ω)(π - atan(v ω/g)) on the spring, v = sqrt(2 g h); it loses nothing."""
    stiffness = MASS_KG * (2 * np.pi * 150.0) ** 2
    model = on_the_ground(RattlingMass("body", (0.48, 0.0, 0.0), MASS_KG, 5e-3, stiffness, 0.0), gravity=True)
    omega = np.sqrt(stiffness / MASS_KG)
    touch = GRAVITY_M_PER_S2 / omega**2
    place = motion(model, touch + height_m, 0.2)
    speed = np.sqrt(2 * GRAVITY_M_PER_S2 * height_m)
    contact = 2 / omega * (np.pi - np.arctan(speed * omega / GRAVITY_M_PER_S2))
    expected = 2 * speed / GRAVITY_M_PER_S2 + contact
    assert period_s(place, touch) == pytest.approx(expected, rel=2e-3)
    assert place[5000:].max() == pytest.approx(touch + height_m, rel=1e-2)


def test_a_rattling_mass_rests_where_it_lies_and_is_stopped_above() -> None:
    """At zero its weight is carried; thrown up in a narrow gap it turns around before it would in the open."""
    stiffness = MASS_KG * (2 * np.pi * 150.0) ** 2
    at_rest = motion(
        on_the_ground(RattlingMass("body", (0.48, 0.0, 0.0), MASS_KG, 1e-3, stiffness, 0.0), gravity=True), 0.0, 0.02
    )
    assert np.abs(at_rest).max() < 1e-12
    pressed_m = -1e-3
    tops = [
        motion(
            on_the_ground(RattlingMass("body", (0.48, 0.0, 0.0), MASS_KG, gap, stiffness, 0.0), gravity=True),
            pressed_m,
            0.12,
        ).max()
        for gap in (1e-3, 1.0)
    ]
    energy = 0.5 * stiffness * (pressed_m - GRAVITY_M_PER_S2 * MASS_KG / stiffness) ** 2
    free_top = pressed_m + energy / (MASS_KG * GRAVITY_M_PER_S2)
    assert tops[1] == pytest.approx(free_top, rel=1e-2)
    assert 1e-3 < tops[0] < 0.6 * tops[1]


def test_impossible_contacts_are_refused() -> None:
    with pytest.raises(InputError, match="mount-lift-off"):
        made("mount-lift-off", stiffness_loss=1.0)
    with pytest.raises(InputError, match="end_mass_kg"):
        made("mount-lift-off", stiffness_loss=0.5).act(hung_hati(), 0)
