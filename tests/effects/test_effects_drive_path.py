"""Each effect of drive path and mount leaves the signature that theory gives it, on the linear model."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from canted_rig import canted_file
from effect_rig import (
    AFT,
    BESIDE,
    DRIVE,
    FORE,
    FREQUENCY_HZ,
    OFFSET,
    SHIFT_M,
    TIP,
    WING,
    Complex,
    at_rest,
    clear_error,
    effect_rig,
    elastic,
    entry,
    having,
    largest_error,
    responses,
)
from numpy.typing import NDArray
from small_rig import band_spectra, revised

from vgvt.data import InputError, ModalModel
from vgvt.effects import make_effect
from vgvt.effects.force_distortion import ForceDistortion
from vgvt.effects.parameter import parameters_of
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import simulated_campaign, truth_of
from vgvt.simulation.assembly import hung_rig, plans
from vgvt.simulation.command import drive_commands, sample_times_s
from vgvt.simulation.linear import site_row
from vgvt.simulation.sensed import linearised_at


@pytest.fixture(scope="module")
def rig() -> Scenario:
    """The rig to try effects on."""
    return effect_rig()


def test_transducer_mass_divides_every_frf_by_one_factor(rig: Scenario) -> None:
    """The gauge reads F + m a: H' = H / (1 + m H_dd)."""
    mass = 0.03
    before, _ = responses(rig)
    after, _ = responses(having(rig, "transducer-mass", mass_kg=mass))
    # Heavier, the aircraft also hangs a little otherwise: 3e-5 of a frequency, 0.3 % on the flank of a peak.
    assert clear_error(after, before / (1 + mass * before[-1])) < 0.01
    assert clear_error(after, before) > 0.1


def test_drive_point_offset_scales_residues_by_the_shape(rig: Scenario) -> None:
    """Residues go with φ(d + δ) / φ(d), poles stay, and the campaign's geometry keeps the stated point."""
    light = revised(rig, transducer={"mass_kg": 0.0, "end_mass_kg": 0.0}, stinger={"mass_kg": 0.0})
    moved = having(light, "drive-point-offset", dx_m=SHIFT_M[0], dy_m=SHIFT_M[1])
    before, after = elastic(light), elastic(moved)
    np.testing.assert_allclose(after.poles, before.poles, rtol=1e-9)
    assert before.residues is not None and after.residues is not None
    ratio = after.residues[:, 1, 0] / before.residues[:, 1, 0]
    np.testing.assert_allclose(np.real(ratio), entry(before, OFFSET) / entry(before, DRIVE), rtol=5e-3)
    assert np.abs(ratio - 1).max() > 0.02
    geometry = simulated_campaign(moved, engine="linear").geometry
    np.testing.assert_array_equal(geometry.position_m(DRIVE), light.shaker.position_m)


def test_stinger_moment_stiffens_what_turns_the_drive_point(rig: Scenario) -> None:
    """Δω = k (roll² + pitch²) / (2 ω), with the body's rotations from three of its points."""
    stiffness = 1.0
    before = elastic(rig)
    after = elastic(having(rig, "stinger-moment", rotational_stiffness_n_m_per_rad=stiffness, loss_factor=1e-6))
    pitch, roll = _rotations(before)
    omega = 2 * np.pi * before.natural_frequency_hz
    expected = stiffness * (pitch**2 + roll**2) / (2 * omega**2)
    got = after.natural_frequency_hz / before.natural_frequency_hz - 1
    strong = expected > 0.02 * expected.max()
    np.testing.assert_allclose(got[strong], expected[strong], rtol=0.05)
    assert expected.max() > 1e-4


def _rotations(modes: ModalModel) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    fore, aft, beside = (entry(modes, node) for node in (FORE, AFT, BESIDE))
    return (aft - fore) / 0.25, (beside - fore) / 0.15


@pytest.mark.parametrize(("axis", "other", "apart_m"), [("pitch", AFT, 0.25), ("roll", BESIDE, -0.15)])
def test_base_strain_adds_the_moment_to_the_force(rig: Scenario, axis: str, other: int, apart_m: float) -> None:
    """1/H(s) - 1/H(-s) = 2 s M/A for every channel, M from the rotation that two body sensors see."""
    s, k, loss, at_hz = 8.0, 10.0, 0.2, 12.0
    seen = revised(rig, acquisition={"runs": ((WING, TIP, FORE, other),)})

    def frf(sign: float) -> Complex:
        effect = {"axis": axis, "rotational_stiffness_n_m_per_rad": k, "loss_factor": loss, "frequency_hz": at_hz}
        return responses(having(seen, "base-strain", apparent_force_per_moment_per_m=sign * s, **effect))[0]

    plus, minus = frf(1.0), frf(-1.0)
    omega = 2 * np.pi * FREQUENCY_HZ
    turned_per_force = (plus[3] - plus[2]) / apart_m / omega**2
    moment = -(k + 1j * omega * loss * k / (2 * np.pi * at_hz)) * turned_per_force
    for got, wanted in zip((1 / plus - 1 / minus), 2 * s * moment / plus, strict=True):
        # It hangs pitched by a quarter of a degree: what yaws is not all of it out of the sensors' sight.
        assert np.linalg.norm(got - wanted) < 2e-3 * np.linalg.norm(wanted)
        if axis == "pitch":
            np.testing.assert_allclose(got, wanted, rtol=1e-3, atol=1e-3 * np.median(np.abs(wanted)))
    assert largest_error(plus, minus) > 0.05


def test_moment_effects_refuse_a_drive_point_on_a_wing(rig: Scenario) -> None:
    """A moment can only be put on the centre body; the message says so."""
    layout = {p.dof.node: p for p in plans(rig)[0].grid}[WING]
    on_wing = revised(rig, shaker={"attached_to": layout.part, "position_m": tuple(map(float, layout.position_m))})
    for name, values in (
        ("stinger-moment", {"rotational_stiffness_n_m_per_rad": 1.0}),
        ("base-strain", {"rotational_stiffness_n_m_per_rad": 1.0}),
    ):
        with pytest.raises(InputError, match="centre body"):
            truth_of(having(on_wing, name, **values))


def test_stinger_compliance_shows_in_the_force_alone(rig: Scenario) -> None:
    """A/F is the structure's; force per volt is not."""
    before, force_before = responses(rig)
    after, force_after = responses(having(rig, "stinger-compliance", compliance_m_per_n=5e-5))
    assert largest_error(after, before) < 1e-5
    assert largest_error(force_after, force_before) > 0.01


def test_mount_compliance_follows_from_substructuring(rig: Scenario) -> None:
    """1/H' = 1/H - ω² m / (k* H0), H0 the structure's without the end mass m: small at soft clay, nil at stiff glue."""
    mass, compliance, loss, at_hz = rig.transducer.end_mass_kg, 2.5e-4, 0.5, 10.0
    before, _ = responses(rig)
    without = before / (1 - mass * before[-1])
    omega = 2 * np.pi * FREQUENCY_HZ
    dynamic = (1 + 1j * omega * loss / (2 * np.pi * at_hz)) / compliance
    expected = 1 / (1 / before - omega**2 * mass / (dynamic * without))
    effect = {"loss_factor": loss, "frequency_hz": at_hz}
    soft, _ = responses(having(rig, "mount-compliance", compliance_m_per_n=compliance, **effect))
    assert largest_error(soft[:-1], expected[:-1]) < 2e-3
    assert largest_error(soft[:-1], before[:-1]) > 5 * largest_error(soft[:-1], expected[:-1])


def test_lateral_force_turns_the_input_only(rig: Scenario) -> None:
    """Poles stay; half the difference of leaning right and left is the response to a sideways force."""
    angle = 0.08
    light = revised(rig, transducer={"mass_kg": 0.0, "end_mass_kg": 0.0}, stinger={"mass_kg": 0.0})
    lean = [having(light, "lateral-force", angle_rad=angle, azimuth_rad=side * np.pi / 2) for side in (1, -1)]
    np.testing.assert_allclose(elastic(lean[0]).poles, elastic(light).poles, rtol=1e-9)
    right, left, straight = (responses(s)[0][1] for s in (*lean, light))
    sideways = _accelerance(light, TIP, np.array([0.0, 1.0, 0.0]))
    assert clear_error((right - left) / 2, np.sin(angle) * sideways) < 5e-3
    assert clear_error((right + left) / 2, np.cos(angle) * straight) < 1e-6


def _accelerance(scenario: Scenario, node: int, push: NDArray[np.float64]) -> Complex:
    """Vertical acceleration at a node per force along ``push`` at the drive point, by direct solution (lines,)."""
    layout = plans(scenario)[0]
    structure = hung_rig(layout, 0)
    data = at_rest(structure)
    linear = linearised_at(structure, [p for p in layout.grid if p.dof.node == node])
    (seen,) = linear.displacement
    driven = site_row(structure.model, data, layout.drive.site, push)
    s = 2j * np.pi * FREQUENCY_HZ
    dynamic = [k**2 * linear.mass + k * linear.damping + linear.stiffness for k in s]
    return np.array([k**2 * seen @ np.linalg.solve(z, driven) for k, z in zip(s, dynamic, strict=True)])


@pytest.mark.parametrize(
    ("name", "along", "across"), [("drive-point-offset", "dx_m", "dy_m"), ("drive-remount", "shift_x_m", "shift_y_m")]
)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_moved_drive_point_stays_on_a_wing_with_dihedral(
    tmp_path: Path, name: str, along: str, across: str, side: float
) -> None:
    """Its axis runs 0.25 m aft and 0.12 m up on 0.9 m of span, whichever wing it is; across the axis it is level."""
    rig = load_scenario(canted_file(tmp_path))
    x, y, z = rig.shaker.position_m
    rig = revised(rig, shaker={"position_m": (x, side * y, z), "attached_to": "beam"})
    moved = make_effect(name, "test", **{along: 0.01, across: side * 0.02}).act(rig, 1).scenario
    assert moved is not None
    shift = np.subtract(moved.shaker.position_m, rig.shaker.position_m)
    np.testing.assert_allclose(shift[:2], [0.01, side * 0.02], atol=1e-12)
    axis = np.array([0.25, side * 0.9, 0.12])
    normal = np.array([0.0, 0.0, 1.0]) - axis * axis[2] / (axis @ axis)
    assert shift @ normal == pytest.approx(0.0, abs=1e-12)
    assert shift[2] > 0.002


def test_force_distortion_makes_the_harmonics_it_names() -> None:
    """A sine comes out with its fundamental untouched and the stated second and third harmonics."""
    scenario = revised(load_scenario("quick"), excitation={"amplitude_v": 0.7})
    time_s = np.arange(1000) / 1000
    command = make_effect("force-distortion", "test", second_harmonic=0.3, third_harmonic=0.1).act(scenario, 0).command
    assert command is not None
    lines = np.abs(np.fft.rfft(command(0.7 * np.sin(2 * np.pi * 10 * time_s), time_s))) / 500 / 0.7
    np.testing.assert_allclose(lines[[10, 20, 30]], [1.0, 0.3, 0.1], atol=1e-9)
    assert np.delete(lines, [0, 10, 20, 30]).max() < 1e-9


@pytest.mark.parametrize("kind", ["random", "burst-random", "multisine"])
@pytest.mark.parametrize("second", [0.0, 0.01, 0.25, 0.7])
@pytest.mark.parametrize("third", [0.0, 0.01, 0.05, 0.11, 0.2])
def test_force_distortion_turns_no_noise_over(kind: str, second: float, third: float) -> None:
    """What comes out rises with the command at all its peaks, and its linear part is the command."""
    own = {"blocks": None if kind == "random" else 4, "burst_fraction": 0.5 if kind == "burst-random" else None}
    own |= {"lines": "full", "crest_iterations": 20} if kind == "multisine" else {}
    scenario = revised(load_scenario("quick"), excitation={"kind": kind, "amplitude_v": 0.7, **own})
    time_s = sample_times_s(scenario)
    sent = drive_commands(scenario, 0, time_s)[0]
    command = (
        make_effect("force-distortion", "test", second_harmonic=second, third_harmonic=third).act(scenario, 0).command
    )
    if second == third == 0:
        assert command is None
        return
    assert command is not None
    got = command(sent, time_s)
    assert (np.diff(got[np.argsort(sent)]) > -1e-9).all()
    about = got - got.mean()
    gain = about @ sent / (sent @ sent)
    assert 0.9 < gain < 1.1
    # It is bent, and no less than a sine of that power would be by the smaller of its harmonics.
    assert np.linalg.norm(about - gain * sent) > 0.5 * max(second, third) * np.linalg.norm(sent)
    assert not command(np.zeros(3), time_s[:3]).any()


@pytest.mark.parametrize(("name", "share"), [("second_harmonic", 1.0), ("third_harmonic", 1.0)])
def test_force_distortion_turns_no_sine_over_where_it_is_plausible(name: str, share: float) -> None:
    scenario = revised(load_scenario("quick"), excitation={"amplitude_v": 0.7})
    largest = next(p for p in parameters_of(ForceDistortion) if p.name == name).at(share)
    command = make_effect("force-distortion", "test", **{name: largest}).act(scenario, 0).command
    assert command is not None
    sent = 0.7 * np.linspace(-1, 1, 1001)
    assert (np.diff(command(sent, sent)) > -1e-9).all()


def test_force_distortion_leaves_the_structures_frf(rig: Scenario) -> None:
    """Force and responses carry the same harmonics: A/F stays, force per command does not."""
    clean = band_spectra(simulated_campaign(rig, engine="linear").runs[0])
    bent = band_spectra(
        simulated_campaign(
            having(rig, "force-distortion", second_harmonic=0.3, third_harmonic=0.1), engine="linear"
        ).runs[0]
    )
    assert largest_error(bent[2:] / bent[1], clean[2:] / clean[1]) < 0.02
    assert largest_error(bent[1] / bent[0], clean[1] / clean[0]) > 0.2
