"""The synthetic campaigns of the conformance suite are what they say, checked by another way of computing them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from vgvt.identification.example import DRIVE_NODE, Example, plate_shapes


def test_the_records_solve_the_modal_equations_of_motion() -> None:
    """Oracle: a Runge-Kutta solution of each modal oscillator under the one curve of no more than half the rate."""
    example = replace(Example(), duration_s=1.5, sweep_s=1.5, stations=2)
    record = example.campaign().runs[0]
    force, measured = record.samples[0], record.samples[1]
    truth = example.modes()
    shapes = plate_shapes(example.positions_m(), 3)
    omega, zeta = 2 * np.pi * truth.natural_frequency_hz, truth.damping_ratio

    def push(time: float) -> float:
        return float(force @ np.sinc((time - record.time_s) * example.sample_rate_hz))

    def rate(time: float, state: np.ndarray) -> np.ndarray:
        drive = shapes[:, -1] * push(time) / example.modal_mass_kg
        return np.concatenate([state[3:], drive - 2 * zeta * omega * state[3:] - omega**2 * state[:3]])

    span = (0.0, record.time_s[-1])
    solution = solve_ivp(rate, span, np.zeros(6), t_eval=record.time_s, rtol=1e-9, atol=1e-12, max_step=1 / 256)
    acceleration = np.array([rate(t, s)[3:] for t, s in zip(record.time_s, solution.y.T, strict=True)])
    expected = acceleration @ shapes[:, 0]
    assert np.abs(measured - expected).max() < 1e-5 * np.abs(expected).max()


@pytest.mark.parametrize("frequency_hz", [6.3, 26.9, 37.0])
def test_responses_over_the_force_are_the_accelerance_that_it_states(frequency_hz: float) -> None:
    example = Example(frequency_hz=(6.3, 13.7, 37.0), damping_ratio=(0.03,) * 3)
    spectra = np.fft.rfft(np.vstack([r.samples for r in example.campaign().runs]))
    frequency = np.fft.rfftfreq(round(example.duration_s * example.sample_rate_hz), 1 / example.sample_rate_hz)
    line = int(np.argmin(np.abs(frequency - frequency_hz)))
    ratio = np.concatenate([spectra[i + 1 : i + 3, line] / spectra[i, line] for i in range(0, len(spectra), 3)])
    exact = example.accelerance(frequency[line : line + 1])[:, 0]
    assert np.abs(ratio - exact).max() < 2e-3 * np.abs(exact).max()


def test_the_accelerance_of_the_drive_side_is_positive_imaginary_at_resonance() -> None:
    """At resonance the accelerance of a real mode is i phi phi_d / (2 zeta m)."""
    example = Example(frequency_hz=(10.0,), damping_ratio=(0.01,))
    shapes = plate_shapes(example.positions_m(), 1)[0]
    value = example.accelerance(np.array([10.0]))[:, 0]
    expected = shapes[:-1] * shapes[-1] / (2 * 0.01)
    np.testing.assert_allclose(value.imag, expected, rtol=2e-4)
    assert np.abs(value.real).max() < 0.02 * np.abs(expected).max()


def test_runs_rove_two_sensors_and_keep_the_drive_point() -> None:
    campaign = Example().campaign()
    assert [len(r.channels) for r in campaign.runs] == [3, 3, 3, 3]
    assert [d.node for d in campaign.response_dofs] == list(range(1, 9))
    assert [d.node for d in campaign.reference_dofs] == [DRIVE_NODE]


def test_noise_is_seeded_and_belongs_to_its_run() -> None:
    quiet, loud = Example().campaign(), Example(noise_m_s2=0.1, seed=1).campaign()
    again, other = Example(noise_m_s2=0.1, seed=1).campaign(), Example(noise_m_s2=0.1, seed=2).campaign()
    added = [a.samples - b.samples for a, b in zip(loud.runs, quiet.runs, strict=True)]
    assert np.array_equal(loud.runs[2].samples, again.runs[2].samples)
    assert not np.array_equal(loud.runs[2].samples, other.runs[2].samples)
    assert not np.array_equal(added[0], added[1])
    np.testing.assert_allclose([a[1:].std() for a in added], 0.1, rtol=0.05)
