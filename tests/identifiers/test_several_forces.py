"""Two shakers at once: every method that works on frequency responses is given each run once per force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.signal
from numpy.typing import NDArray

from vgvt.data import Campaign, Channel, ChannelRole, Direction, Dof, Geometry, Outcome, Quantity, Record
from vgvt.identification import make_identifier, run_identifier

RATE, BLOCK_S, BLOCKS = 128.0, 16.0, 10
FREQUENCY_HZ, RATIO = np.array([6.3, 13.7, 21.9]), np.array([0.02, 0.015, 0.012])
SHAPES = np.array([[1.0, 0.6, -0.4, -1.0], [1.0, -0.7, -0.6, 1.0], [0.8, -1.0, 1.0, -0.9]])
DRIVEN = (0, 1)


def record(run: int, force: NDArray[np.float64], noise: float, generator: np.random.Generator) -> Record:
    """Four sensors, forces (2, samples) at the first two: modal superposition of exactly held forces."""
    response = np.zeros((4, force.shape[1]))
    for f, ratio, shape in zip(FREQUENCY_HZ, RATIO, SHAPES, strict=True):
        w = 2 * np.pi * f
        mode = scipy.signal.StateSpace(
            [[0, 1], [-(w**2), -2 * ratio * w]], [[0], [1]], [[-(w**2), -2 * ratio * w]], [[1]]
        )
        held = mode.to_discrete(1 / RATE, "zoh")
        modal = shape[list(DRIVEN)] @ force
        _, acceleration, _ = scipy.signal.dlsim(held, modal)
        response += np.outer(shape, acceleration[:, 0])
    response += noise * response.std() * generator.standard_normal(response.shape)
    dofs = [Dof(k + 1, Direction.PLUS_Z) for k in range(4)]
    channels = (
        *(Channel(f"force {k}", Quantity.EXCITATION_FORCE, ChannelRole.REFERENCE, dofs[k]) for k in DRIVEN),
        *(Channel(f"acceleration {d}", Quantity.ACCELERATION, ChannelRole.RESPONSE, d) for d in dofs),
    )
    return Record(run, RATE, channels, np.vstack([force, response]))


def of_records(*runs: Record, **notes: str) -> Campaign:
    """A campaign of such records."""
    geometry = Geometry((1, 2, 3, 4), np.array([[float(k), 0.0, 0.0] for k in range(4)]))
    return Campaign("two shakers", geometry, runs, (3.0, 30.0), notes)


def campaign(noise: float = 1e-3) -> Campaign:
    """Bursts that die away."""
    generator = np.random.default_rng(5)
    block = round(BLOCK_S * RATE)
    force = generator.standard_normal((2, BLOCKS, block)) * (np.arange(block) < 0.3 * block)
    one = record(1, force.reshape(2, -1), noise, generator)
    return of_records(one, blocks=f'{{"block_s": {BLOCK_S}, "lead_in_s": 0.0}}')


def sweeps(signs: tuple[tuple[float, float], ...], noise: float = 1e-3) -> Campaign:
    """A sweep of 60 s and silence in every run, with factors for the two shakers."""
    generator = np.random.default_rng(6)
    time = np.arange(round(64.0 * RATE)) / RATE
    sweep = np.sin(2 * np.pi * (2.0 * time + 34.0 / 60.0 * time**2 / 2)) * (time < 60.0)
    return of_records(*(record(k + 1, np.outer(s, sweep), noise, generator) for k, s in enumerate(signs)))


@pytest.mark.parametrize("name", ["auto", "maximum-likelihood", "plscf", "quadrature"])
def test_three_modes_are_found_with_their_shapes(name: str) -> None:
    """Within 0.1 % and 5 % (a force held between samples delays every mode alike), MAC 0.99, and none besides."""
    claim = run_identifier(make_identifier(name), campaign())
    np.testing.assert_allclose(claim.natural_frequency_hz, FREQUENCY_HZ, rtol=1e-3)
    np.testing.assert_allclose(claim.damping_ratio, RATIO, rtol=0.05)
    for shape, true in zip(claim.shapes, SHAPES, strict=True):
        assert np.abs(np.vdot(shape, true)) ** 2 > 0.99 * np.vdot(shape, shape).real * (true @ true)


@pytest.mark.parametrize("name", ["auto", "maximum-likelihood", "plscf"])
def test_residues_are_those_of_the_system(name: str) -> None:
    """psi_d psi_r / (2i w_d) for unit modal masses, within 5 %: nothing of them is put down to the ends of records."""
    claim = run_identifier(make_identifier(name), campaign())
    damped = 2 * np.pi * FREQUENCY_HZ * np.sqrt(1 - RATIO**2)
    exact = SHAPES[:, :, None] * SHAPES[:, None, list(DRIVEN)] / (2j * damped[:, None, None])
    assert claim.residues is not None
    for found, wanted in zip(claim.residues, exact, strict=True):
        assert abs(np.vdot(wanted, found)) / np.vdot(wanted, wanted).real == pytest.approx(1.0, abs=0.05)


def test_a_method_for_one_force_declines_several_and_names_another() -> None:
    claim = run_identifier(make_identifier("subspace"), campaign())
    assert claim.outcome is Outcome.DECLINED
    assert any("several forces" in line and "run 1" in line and "'auto'" in line for line in claim.advice)


def test_one_record_without_averages_says_why() -> None:
    whole = campaign()
    record = whole.runs[0]
    short = Record(1, RATE, record.channels, record.samples[:, : round(BLOCK_S * RATE)])
    claim = run_identifier(
        make_identifier("auto"), Campaign("short", whole.geometry, (short,), (3.0, 30.0), whole.notes)
    )
    assert len(claim) == 0
    assert any("average" in line for line in claim.advice)


@pytest.mark.parametrize("name", ["auto", "quadrature", "era"])
@pytest.mark.parametrize("signs", [((1.0, 1.0), (1.0, -1.0)), ((1.0, 0.05), (0.05, 1.0))])
def test_sweeps_in_turn_or_with_changing_signs_show_the_three_modes(
    name: str, signs: tuple[tuple[float, float], ...]
) -> None:
    """A line is driven in one segment of a sweep and in none of the others: whole records hold it in every run."""
    claim = run_identifier(make_identifier(name), sweeps(signs))
    np.testing.assert_allclose(claim.natural_frequency_hz, FREQUENCY_HZ, rtol=1e-4)
    np.testing.assert_allclose(claim.damping_ratio, RATIO, rtol=0.01)


def test_noise_of_a_minute_shows_the_damping_within_its_errors() -> None:
    """Windows of an eighth of the record made it 4 to 15 % too high, 6 standard deviations."""
    generator = np.random.default_rng(0)
    noise = generator.standard_normal((2, round(64.0 * RATE)))
    claim = run_identifier(make_identifier("auto"), of_records(record(1, noise, 1e-2, generator)))
    assert claim.damping_ratio_std is not None
    np.testing.assert_allclose(claim.damping_ratio, RATIO, rtol=5e-3)
    assert np.all(np.abs(claim.damping_ratio - RATIO) < 3.5 * claim.damping_ratio_std)


@pytest.mark.parametrize(("quantity", "times"), [(Quantity.VELOCITY, 1), (Quantity.DISPLACEMENT, 2)])
def test_velocities_and_displacements_are_differentiated(quantity: Quantity, times: int) -> None:
    """Spectra of the accelerations over (i w)^times: the claim is that of the accelerometers."""
    whole = campaign()
    one = whole.runs[0]
    omega = 2 * np.pi * np.fft.rfftfreq(one.samples.shape[1], 1 / RATE)
    spectra = np.fft.rfft(one.samples[2:], axis=1)
    spectra[:, 1:] /= (1j * omega[1:]) ** times
    spectra[:, 0] = 0.0
    moved = np.fft.irfft(spectra, one.samples.shape[1], axis=1)
    channels = (*one.channels[:2], *(replace(c, quantity=quantity) for c in one.channels[2:]))
    other = replace(one, channels=channels, samples=np.vstack([one.samples[:2], moved]))
    claim = run_identifier(make_identifier("auto"), replace(whole, runs=(other,)))
    np.testing.assert_allclose(claim.natural_frequency_hz, FREQUENCY_HZ, rtol=1e-3)
    np.testing.assert_allclose(claim.damping_ratio, RATIO, rtol=0.05)


@pytest.mark.parametrize("forces", [1, 2])
def test_a_strain_gauge_is_left_out_and_named(forces: int) -> None:
    whole = campaign() if forces == 2 else sweeps(((1.0, 0.0),))
    one = whole.runs[0]
    gauge = Channel("strain", Quantity.GENERAL, ChannelRole.RESPONSE, Dof(3, Direction.PLUS_X))
    kept = [0, 2, 3, 4, 5] if forces == 1 else list(range(6))
    channels = (*(one.channels[i] for i in kept), gauge)
    samples = np.vstack([one.samples[kept], 1e-3 * one.samples[-1:]])
    claim = run_identifier(
        make_identifier("auto"), replace(whole, runs=(replace(one, channels=channels, samples=samples),))
    )
    np.testing.assert_allclose(claim.natural_frequency_hz, FREQUENCY_HZ, rtol=1e-3)
    assert any("strain (3+X) left out, it measures no motion" in line for line in claim.advice)
