"""Two shakers at once: every method that works on frequency responses is given each run once per force."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.signal

from vgvt.data import Campaign, Channel, ChannelRole, Direction, Dof, Geometry, Outcome, Quantity, Record
from vgvt.identification import make_identifier, run_identifier

RATE, BLOCK_S, BLOCKS = 128.0, 16.0, 10
FREQUENCY_HZ, RATIO = np.array([6.3, 13.7, 21.9]), np.array([0.02, 0.015, 0.012])
SHAPES = np.array([[1.0, 0.6, -0.4, -1.0], [1.0, -0.7, -0.6, 1.0], [0.8, -1.0, 1.0, -0.9]])
DRIVEN = (0, 1)


def campaign(noise: float = 1e-3) -> Campaign:
    """Four sensors, forces at the first two: modal superposition of exactly held forces, bursts that die away."""
    generator = np.random.default_rng(5)
    block = round(BLOCK_S * RATE)
    force = generator.standard_normal((2, BLOCKS, block)) * (np.arange(block) < 0.3 * block)
    force = force.reshape(2, -1)
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
    record = Record(1, RATE, channels, np.vstack([force, response]))
    geometry = Geometry((1, 2, 3, 4), np.array([[float(k), 0.0, 0.0] for k in range(4)]))
    notes = {"blocks": f'{{"block_s": {BLOCK_S}, "lead_in_s": 0.0}}'}
    return Campaign("two shakers", geometry, (record,), (3.0, 30.0), notes)


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
