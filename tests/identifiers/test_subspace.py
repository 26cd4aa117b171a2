"""Input-output subspace identification on campaigns and samples with a known answer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Direction, Dof, InputError, Outcome, Record, modal_assurance
from vgvt.identification import run_identifier
from vgvt.identification.example import Example
from vgvt_identifiers.input_output_subspace import DecimatedRun, decimated, hankel_gram, observability
from vgvt_identifiers.subspace import Subspace

CLOSE = Example(
    frequency_hz=(6.3, 13.7, 13.97, 26.9), damping_ratio=(0.012, 0.009, 0.009, 0.0005), noise_m_s2=0.02, seed=4,
    duration_s=40.0, sweep_s=30.0, stations=2,
)  # fmt: skip
"""Two modes 2 % apart, and one of 0.05 % damping that rings on at the end of the record."""


def test_the_gram_of_the_hankel_matrix_is_that_of_the_matrix() -> None:
    signals = np.random.default_rng(0).standard_normal((3, 60))
    hankel = np.concatenate([signals[:, lag : lag + 53] for lag in range(8)])
    np.testing.assert_allclose(hankel_gram(signals, 8), hankel @ hankel.T, atol=1e-12)


def test_decimation_keeps_the_band_and_remembers_the_scale() -> None:
    time = np.arange(4000) / 500.0
    run = decimated(np.array([np.sin(2 * np.pi * 5 * time), 3 * np.cos(2 * np.pi * 9 * time)]), 500.0, 10.0)
    assert 1 / run.step_s >= 2.56 * 10.0
    np.testing.assert_allclose(run.scale, [np.sqrt(0.5), 3 * np.sqrt(0.5)], rtol=0.02)


@pytest.mark.parametrize("weighting", ["cva", "moesp", "n4sid"])
def test_the_weights_are_those_of_the_book(weighting: str) -> None:
    """Of explicit Hankel matrices and projections, (1.8) and table 4.1 of Van Overschee and De Moor, 1996."""
    generator, rows, order = np.random.default_rng(7), 4, 3
    force = np.convolve(generator.standard_normal(402), [1.0, 1.6, 0.8], mode="valid")
    answers = np.array([_filtered(force, 0.8 * np.exp(0.5j)).real, _filtered(force, 0.9 * np.exp(1.1j)).imag])
    samples = np.vstack([force, answers + 0.3 * generator.standard_normal(answers.shape)])
    hankel = np.array([samples[:, lag : lag + 401 - 2 * rows] for lag in range(2 * rows)])
    past, inputs = hankel[:rows].reshape(3 * rows, -1), hankel[rows:, 0]
    outputs = hankel[rows:, 1:].reshape(2 * rows, -1)
    beside = np.eye(inputs.shape[1]) - np.linalg.pinv(inputs) @ inputs
    oblique = outputs @ beside @ np.linalg.pinv(past @ beside) @ past
    power = outputs @ beside @ outputs.T
    white = np.linalg.cholesky(power) if weighting == "cva" else np.eye(2 * rows)
    taken = oblique if weighting == "n4sid" else np.linalg.solve(white, oblique @ beside)
    left, values, _ = np.linalg.svd(taken, full_matrices=False)
    expected = white @ (left[:, :order] * np.sqrt(values[:order]))
    found = observability(DecimatedRun(samples, np.ones(3), 1.0), rows, order, weighting).matrix
    signs = np.sign((found * expected).sum(axis=0))
    np.testing.assert_allclose(found * signs, expected, atol=1e-7 * np.abs(expected).max())


@pytest.mark.parametrize("weighting", ["cva", "moesp", "n4sid"])
def test_without_noise_the_poles_come_back_exactly(weighting: str) -> None:
    """Two outputs of four states under a force of no colour in particular; the right order is asked for."""
    roots = np.array([0.95 * np.exp(0.4j), 0.9 * np.exp(1.2j)])
    force = np.random.default_rng(3).standard_normal(3000)
    outputs = sum(
        np.real(np.outer(gains, _filtered(force, root)))
        for root, gains in zip(roots, ((1.0 + 1j, 0.5), (0.7, -1.0 + 0.3j)), strict=True)
    )
    table = observability(DecimatedRun(np.vstack([force, outputs]), np.ones(3), 1.0), 8, 4, weighting).poles((4,))
    found = np.sort_complex(np.exp(table[0].poles_rad_s))
    np.testing.assert_allclose(found, np.sort_complex(roots), rtol=1e-8)


@pytest.mark.parametrize("weighting", ["cva", "moesp", "n4sid"])
def test_a_state_space_model_gives_its_own_poles_back(weighting: str) -> None:
    """Four states of discrete time under a white input, and two more that colour the noise of the outputs."""
    generator = np.random.default_rng(1)
    roots = np.array([0.95 * np.exp(0.4j), 0.9 * np.exp(1.2j)])
    length = 20_000
    force = generator.standard_normal(length)
    outputs = np.zeros((2, length))
    for root, gains in zip(roots, ((1.0 + 1j, 0.5), (0.7, -1.0 + 0.3j)), strict=True):
        state = _filtered(force, root)
        outputs += 2 * np.real(np.outer(gains, state))
    noise = np.array([_filtered(generator.standard_normal(length), 0.8).real for _ in range(2)])
    samples = np.vstack([force, outputs + 0.2 * outputs.std() * noise])
    table = observability(DecimatedRun(samples, np.ones(3), 1.0), 12, 6, weighting).poles((6,))
    found = np.exp(table[0].poles_rad_s)
    assert np.abs(found - roots[:, None]).min(axis=1).max() < 5e-3


def _filtered(force: np.ndarray, root: complex) -> np.ndarray:
    from scipy.signal import lfilter

    return np.asarray(lfilter([1.0], [1.0, -root], force))


@pytest.mark.parametrize("weighting", ["cva", "moesp", "n4sid"])
def test_a_close_pair_and_a_very_light_damping_under_roving_sensors(weighting: str) -> None:
    model, truth = run_identifier(Subspace(weighting=weighting, replicates=2), CLOSE.campaign()), CLOSE.modes()
    assert len(model) == len(truth)
    assert np.abs(model.natural_frequency_hz / truth.natural_frequency_hz - 1).max() < 1e-3
    assert np.abs(model.damping_ratio / truth.damping_ratio - 1).max() < 0.1
    assert np.diag(modal_assurance(model.at(truth.dofs).shapes, truth.shapes)).min() > 0.98


@pytest.mark.slow
def test_the_stated_deviations_hold_over_seeds() -> None:
    """Errors over stated deviations have a root mean square of about one."""
    scores = []
    for seed in range(6):
        example = Example(noise_m_s2=0.1, seed=seed, stations=2)
        model, truth = run_identifier(Subspace(), example.campaign()), example.modes()
        assert len(model) == len(truth)
        assert model.natural_frequency_std_hz is not None
        assert model.damping_ratio_std is not None
        scores.append((model.natural_frequency_hz - truth.natural_frequency_hz) / model.natural_frequency_std_hz)
        scores.append((model.damping_ratio - truth.damping_ratio) / model.damping_ratio_std)
    rms = np.sqrt(np.mean(np.square(scores)))
    assert 0.3 < rms < 2.0


def test_more_noise_is_stated_as_more_uncertainty() -> None:
    quiet, loud = (
        run_identifier(Subspace(replicates=4), Example(noise_m_s2=level, stations=2, seed=1).campaign())
        for level in (0.01, 0.2)
    )
    assert quiet.natural_frequency_std_hz is not None
    assert loud.natural_frequency_std_hz is not None
    assert np.all(loud.natural_frequency_std_hz > 3 * quiet.natural_frequency_std_hz)


def test_noise_alone_gives_a_reason_and_no_mode() -> None:
    model = run_identifier(Subspace(replicates=0), Example(force_n=1e-6, noise_m_s2=1.0).campaign())
    assert model.outcome is Outcome.NOTHING_FOUND
    assert model.candidates
    assert not any(c.kept for c in model.candidates)


def test_a_record_too_short_for_the_rows_is_a_reason_and_no_crash() -> None:
    campaign = Example(duration_s=6.0, sweep_s=4.0).campaign()
    model = run_identifier(Subspace(block_rows=300), campaign)
    assert model.outcome is Outcome.NOTHING_FOUND
    assert any("too few" in text for text in model.advice)


def test_a_mistake_in_the_program_is_no_advice(monkeypatch: pytest.MonkeyPatch) -> None:
    def mistaken(*_: object) -> DecimatedRun:
        raise ValueError("operands could not be broadcast together")

    monkeypatch.setattr("vgvt_identifiers.subspace.prepared", mistaken)
    with pytest.raises(ValueError, match="broadcast"):
        run_identifier(Subspace(), Example(stations=2).campaign())


def test_channels_in_another_order_or_turned_round_change_nothing() -> None:
    """Frequencies and their deviations too, which come from drawn noise, far below one deviation."""
    whole = Example(noise_m_s2=0.02, sample_rate_hz=96.0, band_hz=(3.0, 30.0), stations=2).campaign()

    def changed(record: Record) -> Record:
        force, first, second = record.channels
        assert first.dof is not None
        turned = replace(first, dof=Dof(first.dof.node, Direction.MINUS_Z))
        return replace(record, channels=(force, second, turned), samples=record.samples[[0, 2, 1]] * [[1], [1], [-1]])

    method = Subspace(replicates=2)
    plain = run_identifier(method, whole)
    other = run_identifier(method, replace(whole, runs=tuple(map(changed, whole.runs))))
    assert plain.natural_frequency_std_hz is not None and other.natural_frequency_std_hz is not None
    np.testing.assert_allclose(other.natural_frequency_std_hz, plain.natural_frequency_std_hz, rtol=1e-3)
    gap = np.abs(other.natural_frequency_hz - plain.natural_frequency_hz)
    assert (gap < 1e-3 * plain.natural_frequency_std_hz).all()


def test_settings_out_of_range_are_refused() -> None:
    with pytest.raises(InputError, match="replicates"):
        replace(Subspace(), replicates=-1)
