"""The pLSCF method on campaigns with a known answer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Campaign, Direction, Dof, InputError, ModalModel, Outcome, Record, modal_assurance
from vgvt.identification import run_identifier
from vgvt.identification.example import Example
from vgvt_identifiers.plscf import Plscf

CLOSE = Example(
    frequency_hz=(6.3, 13.7, 13.97, 26.9), damping_ratio=(0.012, 0.009, 0.009, 0.0005), noise_m_s2=0.02, seed=4,
    duration_s=40.0, sweep_s=30.0,
)  # fmt: skip
"""Two modes 2 % apart, and one of 0.05 % damping that rings on at the end of the record."""


def errors(model: ModalModel, truth: ModalModel) -> tuple[np.ndarray, np.ndarray]:
    """Relative errors of frequencies and damping ratios."""
    return (
        np.abs(model.natural_frequency_hz / truth.natural_frequency_hz - 1),
        np.abs(model.damping_ratio / truth.damping_ratio - 1),
    )


def simultaneous(campaign: Campaign) -> Campaign:
    """All responses of a roving campaign in one run; without force noise every run has the same force."""
    first = campaign.runs[0]
    channels = (first.channels[0], *(c for r in campaign.runs for c in r.channels[1:]))
    samples = np.vstack([first.samples[:1], *(r.samples[1:] for r in campaign.runs)])
    return replace(campaign, runs=(Record(1, first.sample_rate_hz, channels, samples),))


@pytest.mark.parametrize("poles", ["common", "per-run"])
def test_a_close_pair_and_a_very_light_damping_under_roving_sensors(poles: str) -> None:
    model, truth = run_identifier(Plscf(poles=poles), CLOSE.campaign()), CLOSE.modes()
    assert len(model) == len(truth)
    frequency, damping = errors(model, truth)
    assert frequency.max() < 1e-3
    assert damping.max() < 0.1
    assert np.diag(modal_assurance(model.at(truth.dofs).shapes, truth.shapes)).min() > 0.98


def test_sensors_at_once_and_roving_ones_tell_the_same() -> None:
    model, truth = run_identifier(Plscf(), simultaneous(CLOSE.campaign())), CLOSE.modes()
    assert len(model) == len(truth)
    assert errors(model, truth)[0].max() < 1e-3


def test_residues_are_those_of_the_receptance() -> None:
    example = Example(noise_m_s2=0.002, seed=2)
    model, truth = run_identifier(Plscf(), example.campaign()), example.modes()
    drive = Dof(99, Direction.PLUS_Z)
    assert model.references == (drive,)
    found = model.at(truth.dofs).residues
    assert found is not None
    np.testing.assert_allclose(found[:, :, 0], example._gains(), atol=0.005 * np.abs(example._gains()).max())


@pytest.mark.slow
def test_the_stated_deviations_hold_over_seeds() -> None:
    """Errors over stated deviations have a root mean square of one, or less where spread over orders is added."""
    truth, scores = CLOSE.modes(), []
    for seed in range(8):
        example = replace(CLOSE, seed=seed, noise_m_s2=0.05)
        model = run_identifier(Plscf(poles="common"), simultaneous(example.campaign()))
        assert len(model) == len(truth)
        assert model.natural_frequency_std_hz is not None
        assert model.damping_ratio_std is not None
        scores.append((model.natural_frequency_hz - truth.natural_frequency_hz) / model.natural_frequency_std_hz)
        scores.append((model.damping_ratio - truth.damping_ratio) / model.damping_ratio_std)
    rms = np.sqrt(np.mean(np.square(scores)))
    assert 0.3 < rms < 2.0


def test_a_mode_that_moves_between_runs_is_one_mode() -> None:
    """As under a roving sensor's mass: 0.4 % between the first and the last run, a quarter of the half-power width."""
    example = Example(noise_m_s2=0.01)
    runs = []
    for index in range(example.stations):
        factor = 1 + 0.004 * (index / (example.stations - 1) - 0.5)
        moved = replace(example, frequency_hz=tuple(f * factor for f in example.frequency_hz), seed=index)
        runs.append(moved.campaign().runs[index])
    model = run_identifier(Plscf(), replace(example.campaign(), runs=tuple(runs)))
    assert len(model) == 3
    assert errors(model, example.modes())[0].max() < 1e-3
    assert all(any(f.startswith("run_scatter_hz=") for f in flags) for flags in model.flags)


def test_several_references_are_one_matrix_fraction() -> None:
    """The shaker moved to a second place: rows of two references, and modal masses from neither being a response."""
    example = Example(frequency_hz=(6.3, 13.7, 26.9), noise_m_s2=0.005)
    first = example.campaign()
    second = tuple(
        replace(r, run=r.run + 10, channels=tuple(_moved(c) for c in r.channels), samples=_driven(example, r))
        for r in first.runs
    )
    model = run_identifier(Plscf(), replace(first, runs=(*first.runs, *second)))
    assert len(model) == 3
    assert set(model.references) == {Dof(99, Direction.PLUS_Z), Dof(1, Direction.PLUS_Z)}
    assert errors(model, example.modes())[0].max() < 1e-3
    assert model.modal_mass_kg is not None
    scale = model.at(example.dofs).shapes[:, :1] / example.modes().shapes[:, :1]
    np.testing.assert_allclose(model.modal_mass_kg, np.abs(scale[:, 0]) ** 2, rtol=0.05)


def _moved(channel):
    return replace(channel, dof=Dof(1, Direction.PLUS_Z)) if channel.name == "force" else channel


def _driven(example: Example, record: Record) -> np.ndarray:
    """The samples of a run with the force at node 1."""
    response = example._accelerations(record.samples[0], example._gains(0))
    rows = [c.dof.node - 1 for c in record.channels[1:] if c.dof is not None]
    noise = 0.005 * np.random.default_rng([9, record.run]).standard_normal((2, response.shape[1]))
    return np.vstack([record.samples[:1], response[rows] + noise])


def test_every_pole_that_was_weighed_is_among_the_candidates() -> None:
    model = run_identifier(Plscf(), CLOSE.campaign())
    kept = [c for c in model.candidates if c.kept]
    for frequency in model.natural_frequency_hz:
        assert min(abs(c.frequency_hz - frequency) for c in kept) < 0.01 * frequency
    assert any(not c.kept for c in model.candidates)
    assert model.select([0]).candidates == model.candidates


def test_noise_alone_gives_candidates_and_no_mode() -> None:
    campaign = Example(force_n=1e-6, noise_m_s2=1.0).campaign()
    model = run_identifier(Plscf(), campaign)
    assert model.outcome is Outcome.NOTHING_FOUND
    assert model.candidates
    assert not any(c.kept for c in model.candidates)


def test_settings_out_of_range_are_refused() -> None:
    with pytest.raises(InputError, match="largest_order"):
        Plscf(largest_order=1)
