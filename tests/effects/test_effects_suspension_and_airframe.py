"""Effects of the suspension leave the signature that a formula predicts; they and the airframe's go together."""

from __future__ import annotations

import numpy as np
import pytest
from hung_hati import (
    AFT,
    HEIGHT_M,
    RIGHT,
    UP,
    as_tested,
    elastic,
    hung,
    hung_hati,
    made,
    mode,
    receptance,
    stiffened,
    with_effect,
)
from numpy.typing import NDArray
from scipy.linalg import eigh

from vgvt.data import InputError
from vgvt.effects.elements import Absorber, PointMass
from vgvt.scenario import Scenario
from vgvt.scenario.mass import rigid_body_properties
from vgvt.simulation.assembly import hung_rig, plans


@pytest.fixture(scope="module")
def hati() -> Scenario:
    """Hati, one run, hung right above its centre of gravity."""
    return hung_hati()


@pytest.fixture(scope="module")
def stiff(hati: Scenario) -> Scenario:
    """The same as a rigid body, or nearly."""
    return stiffened(hati)


def test_surge_elements_sum_to_the_exact_spring(hati: Scenario) -> None:
    """k plus absorbers plus lump equals k γ cot γ with γ = ω sqrt(m_s/k) up to three surges, loss and all."""
    mass, loss, k = 0.4, 0.01, hati.suspension.stiffness_n_per_m
    elements = made("suspension-surge", mass_kg=mass, loss_factor=loss).act(hati, 0).elements
    assert sum(e.mass_kg for e in elements if isinstance(e, Absorber | PointMass)) == pytest.approx(mass / 3, rel=1e-12)
    omega = 2 * np.pi * np.linspace(0.5, 30.0, 4000)
    stiffness = np.full(omega.shape, k, dtype=complex)
    for element in elements:
        if isinstance(element, Absorber):
            spring = element.stiffness_n_per_m + 1j * omega * element.damping_n_s_per_m
            inertia = omega**2 * element.mass_kg
            stiffness -= inertia * spring / (spring - inertia)
        elif isinstance(element, PointMass):
            stiffness -= omega**2 * element.mass_kg
    gamma = omega * np.sqrt(mass / (k * (1 + 1j * loss)))
    exact = k * (1 + 1j * loss) * gamma / np.tan(gamma)
    # What the lump stands for grows as (f/f_7)²; a hysteretic spring loses more between its surges, and at rest.
    assert np.abs(stiffness - exact).max() / np.abs(exact).max() < 0.02
    np.testing.assert_allclose(stiffness.real[:400], exact.real[:400], rtol=1e-3)


def spring_exchanged(
    hati: Scenario, frequency_hz: NDArray[np.float64], mass_kg: float, along: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """Receptance (lines,) of the plain rig's drive point with its spring exchanged at the hook (Woodbury).

    ``along`` (lines,) is the other one's dynamic stiffness, N/m. Sideways a spring acts as a taut string, which below
    its own resonance is a third of its mass.
    """
    points = (("drive-point", UP), ("hook", AFT), ("hook", RIGHT), ("hook", UP))
    plain = receptance(hung(hati, *points), frequency_hz)
    across = -((2 * np.pi * frequency_hz) ** 2) * mass_kg / 3
    stiffer = along - hati.suspension.stiffness_n_per_m
    change = np.array([np.diag(row) for row in zip(across, across, stiffer, strict=True)])
    loaded = np.linalg.solve(np.eye(3) + change @ plain[:, 1:, 1:], change @ plain[:, 1:, :1])
    return np.asarray(plain[:, 0, 0] - (plain[:, :1, 1:] @ loaded)[:, 0, 0])


def test_surge_in_the_rig_equals_substructuring_with_the_exact_spring(hati: Scenario) -> None:
    """The plain rig with its spring exchanged at the hook for k γ cot γ is the rig with surge."""
    mass, loss, k = 0.3, 0.004, hati.suspension.stiffness_n_per_m
    frequency = np.linspace(4.0, 35.0, 3000)
    plain = receptance(hung(hati, ("drive-point", UP)), frequency)
    gamma = 2 * np.pi * frequency * np.sqrt(mass / (k * (1 + 1j * loss)))
    expected = spring_exchanged(hati, frequency, mass, k * (1 + 1j * loss) * gamma / np.tan(gamma))
    got = receptance(
        hung(with_effect(hati, "suspension-surge", mass_kg=mass, loss_factor=loss), ("drive-point", UP)), frequency
    )
    assert np.abs(got[:, 0, 0] - expected).max() < 0.02 * np.abs(expected).max()
    assert np.abs(expected - plain[:, 0, 0]).max() > 0.2 * np.abs(expected).max(), "the surge must show in this test"


@pytest.mark.parametrize("frame_first", [False, True])
@pytest.mark.parametrize(("frame_n_per_m", "frame_hz"), [(5e4, 9.0), (5e4, 12.0), (5e3, 9.0)])
def test_a_surging_spring_on_a_frame_equals_substructuring_with_the_exact_bar(
    hati: Scenario, frame_n_per_m: float, frame_hz: float, frame_first: bool
) -> None:
    """A uniform bar between the hook and a frame of dynamic stiffness z loads the hook with
    k γ (z cos γ − k γ sin γ) / (z sin γ + k γ cos γ), γ = ω sqrt(m_s/k) (Rao, bars with an elastic end).

    Its first surge is at 9.0 Hz. What it would be on a rigid frame is far from it.
    """
    mass, loss, ratio = 0.4, 0.005, 0.02
    undamped = hati.suspension.model_copy(update={"damping_n_s_per_m": 0.0})
    hati = hati.model_copy(update={"suspension": undamped})
    frequency = np.linspace(4.0, 35.0, 3000)
    omega, own = 2 * np.pi * frequency, 2 * np.pi * frame_hz
    k = hati.suspension.stiffness_n_per_m * (1 + 1j * loss)
    gamma = omega * np.sqrt(mass / k)
    frame = frame_n_per_m * (1 + 2j * ratio * omega / own - (omega / own) ** 2)
    cosine, sine = np.cos(gamma), np.sin(gamma)
    along = k * gamma * (frame * cosine - k * gamma * sine) / (frame * sine + k * gamma * cosine)
    expected, rigid = (
        -(omega**2) * spring_exchanged(hati, frequency, mass, hook) for hook in (along, k * gamma * cosine / sine)
    )
    effects: list[tuple[str, dict[str, object]]] = [
        ("suspension-surge", {"mass_kg": mass, "loss_factor": loss}),
        ("frame-resonance", {"compliance_m_per_n": 1 / frame_n_per_m, "frequency_hz": frame_hz}),
    ]
    both = hati
    for name, parameters in reversed(effects) if frame_first else effects:
        both = with_effect(both, name, **parameters)
    got = -(omega**2) * receptance(hung(both, ("drive-point", UP)), frequency)[:, 0, 0]
    assert np.abs(got - expected).max() < 0.02 * np.abs(expected).max()
    assert np.abs(rigid - expected).max() > 0.5 * np.abs(expected).max(), "the frame must show in this test"


def test_surges_are_named_and_equally_spaced(hati: Scenario) -> None:
    modes = as_tested(with_effect(hati, "suspension-surge", mass_kg=0.3))
    surges = [f for f, label in zip(modes.natural_frequency_hz, modes.labels, strict=True) if "surge" in label]
    spacing = 0.5 * np.sqrt(hati.suspension.stiffness_n_per_m / 0.3)
    np.testing.assert_allclose(surges, spacing * np.arange(1, len(surges) + 1), rtol=0.03)


def test_heave_goes_with_the_root_of_the_spring(hati: Scenario, stiff: Scenario) -> None:
    stiffer = with_effect(stiff, "suspension-stiffness", stiffness_change=0.2)
    ratio = mode(as_tested(stiffer), "heave")[0] / mode(as_tested(stiff), "heave")[0]
    assert ratio == pytest.approx(np.sqrt(1.2), rel=1e-3)
    assert elastic(with_effect(hati, "suspension-stiffness", stiffness_change=0.2)) == pytest.approx(
        elastic(hati), rel=5e-3
    )


def test_suspension_damping_adds_to_heave(stiff: Scenario) -> None:
    """ζ = c/(2 sqrt(k m)) of a mass on a spring; frequencies stay."""
    damper = 2.0
    spring, weighed = stiff.suspension.stiffness_n_per_m, rigid_body_properties(stiff.airframe).mass_kg
    before, after = (
        mode(as_tested(s), "heave") for s in (stiff, with_effect(stiff, "suspension-damping", damping_n_s_per_m=damper))
    )
    assert after[1] - before[1] == pytest.approx(damper / (2 * np.sqrt(spring * weighed)), rel=0.02)
    assert after[0] == pytest.approx(before[0], rel=2e-3)


@pytest.mark.parametrize("change_m", [0.0, 0.7])
def test_swing_is_that_of_the_double_pendulum(stiff: Scenario, change_m: float) -> None:
    """A body hung by a cord of length l at height h over its centre of gravity: a 2x2 problem a plane."""
    longer = with_effect(stiff, "pendulum-length", length_change_m=change_m)
    weighed = rigid_body_properties(stiff.airframe)
    mass, spring = weighed.mass_kg, stiff.suspension.stiffness_n_per_m
    length = stiff.suspension.free_length_m + change_m + mass * 9.80665 / spring
    height, tension = HEIGHT_M, mass * 9.80665
    pull = tension / length * np.array([[1.0, height], [height, height**2]])
    expected = []
    for axis in (0, 1):
        stiffness = pull + np.diag([0.0, tension * height])
        squared = eigh(stiffness, np.diag([mass, weighed.inertia_kg_m2[axis, axis]]), eigvals_only=True)
        expected += list(np.sqrt(squared) / (2 * np.pi))
    got = as_tested(longer).natural_frequency_hz
    for frequency in expected:
        assert np.abs(got / frequency - 1).min() < 0.01, f"{frequency:.3f} Hz is not among {got[:6]}"


def test_hook_offset_tilts_the_aircraft_until_the_hook_is_above_the_centre_of_gravity(stiff: Scenario) -> None:
    offset, height = 0.02, HEIGHT_M
    layout = plans(with_effect(stiff, "hook-offset", aft_m=offset))[0]
    rig = hung_rig(layout, 0)
    pitch = rig.qpos[rig.model.joint("pitch").qposadr[0]]
    assert abs(pitch) == pytest.approx(np.arctan(offset / height), rel=0.01)
    level = hung_rig(plans(stiff)[0], 0)
    assert abs(level.qpos[level.model.joint("pitch").qposadr[0]]) < 2e-3


def test_frame_and_heave_are_two_masses_in_series(stiff: Scenario) -> None:
    """Aircraft on its spring on the frame's mass on the frame's spring: eigenvalues of a 2x2 problem."""
    compliance, frequency = 4e-4, 4.0
    modes = as_tested(with_effect(stiff, "frame-resonance", compliance_m_per_n=compliance, frequency_hz=frequency))
    spring, weighed = stiff.suspension.stiffness_n_per_m, rigid_body_properties(stiff.airframe).mass_kg
    frame = 1 / compliance
    stiffness = np.array([[spring, -spring], [-spring, spring + frame]])
    mass = np.diag([weighed, frame / (2 * np.pi * frequency) ** 2])
    expected = np.sqrt(eigh(stiffness, mass, eigvals_only=True)) / (2 * np.pi)
    got = [mode(modes, "heave")[0], mode(modes, "1st frame")[0]]
    np.testing.assert_allclose(got, expected, rtol=2e-3)
    assert got[0] < mode(as_tested(stiff), "heave")[0] * 0.98


def test_a_second_frame_is_refused(hati: Scenario) -> None:
    """It would leave the first one in the air."""
    once = with_effect(hati, "frame-resonance", compliance_m_per_n=1e-4)
    with pytest.raises(InputError, match="one upper end"):
        as_tested(with_effect(once, "frame-resonance", compliance_m_per_n=2e-4))


def test_effects_that_split_the_wings_go_together(hati: Scenario) -> None:
    """One after the other on an aircraft whose wings were written out by the first."""
    both = with_effect(hati, "stiffness-asymmetry", bending=0.1, beam="wing")
    for name, parameters in (
        ("root-compliance", {"bending": 0.1, "side": "right", "beam": "wing"}),
        ("bend-twist-coupling", {"coupling": 0.1, "side": "left"}),
        ("control-surface", {"compliance_rad_per_n_m": 10.0, "side": "both"}),
        ("entrained-air", {"mass_fraction": 1.0, "drag_n_s_per_m3": 1.0}),
        ("added-mass", {"mass_kg": 0.01, "x_m": 1.0, "y_m": -1.4}),
    ):
        both = with_effect(both, name, **parameters)
    modes = as_tested(both)
    assert {"1st flap", "2nd flap"} <= set(modes.labels)
    assert (modes.damping_ratio > 0).all()


@pytest.mark.parametrize(
    ("name", "parameters", "says"),
    [
        ("root-compliance", {"bending": 0.1, "beam": "wnig"}, "did you mean|wing"),
        ("control-surface", {"compliance_rad_per_n_m": 1.0, "item": "flap-outr"}, "flap-outer"),
        ("pendulum-length", {"length_change_m": -2.0}, "only 0.8 m"),
    ],
)
def test_mistakes_are_explained(hati: Scenario, name: str, parameters: dict[str, object], says: str) -> None:
    with pytest.raises(InputError, match=says):
        made(name, **parameters).act(hati, 0)


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        ("root-compliance", {"bending": -0.1}),
        ("bend-twist-coupling", {"coupling": 1.0}),
        ("suspension-stiffness", {"stiffness_change": -1.0}),
        ("added-mass", {"mass_kg": -0.1}),
    ],
)
def test_impossible_sizes_are_refused(name: str, parameters: dict[str, object]) -> None:
    with pytest.raises(InputError, match=name):
        made(name, **parameters)


@pytest.mark.parametrize(
    ("name", "parameter"),
    [
        ("local-absorber", "mass_kg"),
        ("local-absorber", "damping_ratio"),
        ("suspension-surge", "mass_kg"),
        ("frame-resonance", "compliance_m_per_n"),
        ("cable-drag", "damping_n_s_per_m"),
        ("stinger-moment", "rotational_stiffness_n_m_per_rad"),
        ("amplitude-dependent-damping", "growth_per_rtkg_m"),
        ("loose-sensor-mount", "damping_ratio"),
        ("high-pass-mismatch", "corner_hz"),
        ("mount-compliance", "compliance_m_per_n"),
        ("mount-creep", "compliance_m_per_n"),
        ("entrained-air", "mass_fraction"),
        ("entrained-air", "drag_n_s_per_m3"),
        ("root-friction", "friction_n_m"),
        ("root-freeplay", "gap_rad"),
        ("payload-change", "mass_kg"),
    ],
)
def test_masses_dampers_and_springs_of_their_own_are_not_negative(name: str, parameter: str) -> None:
    """Such a mass has no model, such a damper feeds the aircraft."""
    with pytest.raises(InputError, match=rf"{parameter}: effect '{name}': -0.1 is below 0"):
        made(name, **{parameter: -0.1})


@pytest.mark.parametrize("name", ["cubic-root-stiffness", "root-friction", "root-freeplay"])
def test_a_root_that_holds_nothing_is_refused(name: str) -> None:
    """Its wing would hang loose: the aircraft finds no rest, or one that no lab has seen."""
    with pytest.raises(InputError, match=rf"root_stiffness_n_m_per_rad: effect '{name}': 0 is below 1"):
        made(name, root_stiffness_n_m_per_rad=0.0)
