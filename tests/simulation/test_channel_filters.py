"""Filters on channels act as on a record with silence around it, however slow they are, at no cost for quick ones."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.fft import next_fast_len

from vgvt.simulation.channel_effects import filtered

RATE_HZ = 1000.0
SAMPLES = 18000
TIME_S = np.arange(SAMPLES) / RATE_HZ
STEP = np.ones(SAMPLES)

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def high_pass(frequency_hz: Array, corner_hz: float) -> Complex:
    return np.asarray(1j * frequency_hz / (corner_hz + 1j * frequency_hz))


def resonance(frequency_hz: Array, own_hz: float, damping_ratio: float) -> Complex:
    ratio = frequency_hz / own_hz
    return np.asarray(1 / (1 - ratio**2 + 2j * damping_ratio * ratio))


@pytest.mark.parametrize("corner_hz", [0.001, 0.005, 0.02, 0.05, 0.5])
def test_a_step_through_a_slow_high_pass_decays_from_one(corner_hz: float) -> None:
    """exp(-2π f_c t); its first samples ring as band-limited steps do."""
    got = filtered(STEP, RATE_HZ, lambda f: high_pass(f, corner_hz))
    np.testing.assert_allclose(got[100:-100], np.exp(-2 * np.pi * corner_hz * TIME_S)[100:-100], atol=0.01 * corner_hz)


def test_an_oscillation_longer_than_the_record_does_not_wrap_around() -> None:
    """The step response of a lightly damped oscillator starts from nothing."""
    own_hz, damping_ratio = 1.0, 0.001
    got = filtered(STEP, RATE_HZ, lambda f: resonance(f, own_hz, damping_ratio))
    omega = 2 * np.pi * own_hz
    turning = np.exp((-damping_ratio + 1j * np.sqrt(1 - damping_ratio**2)) * omega * TIME_S)
    wanted = 1 - (turning.real + damping_ratio / np.sqrt(1 - damping_ratio**2) * turning.imag)
    np.testing.assert_allclose(got[100:-100], wanted[100:-100], atol=0.01)


@pytest.mark.parametrize("corner_hz", [0.0, 1e-7])
def test_what_is_slower_than_all_silence_wraps_little(corner_hz: float) -> None:
    """A filter that takes out the mean alone never forgets, and no computer would hold the silence it takes."""
    lines: list[int] = []

    def response(frequency_hz: Array) -> Complex:
        lines.append(frequency_hz.size)
        return np.asarray(np.where(frequency_hz == 0, 0.0, high_pass(np.maximum(frequency_hz, 1e-9), corner_hz)))

    got = filtered(STEP, RATE_HZ, response)
    np.testing.assert_allclose(got[100:-100], 1.0, atol=0.01)
    assert max(lines) < 3e6


@pytest.mark.parametrize(
    "response",
    [
        lambda f: np.full(f.shape, 1.1, dtype=complex),
        lambda f: np.exp(-2j * np.pi * f * 2e-3),
        lambda f: high_pass(f, 0.2),
        lambda f: resonance(f, 30.0, 0.02),
        lambda f: np.zeros(f.shape, dtype=complex),
    ],
    ids=["gain", "delay", "high-pass", "loose sensor", "nothing"],
)
def test_usual_filters_get_twice_the_record_of_silence(response: object) -> None:
    """And are asked once."""
    lines: list[int] = []

    def asked(frequency_hz: Array) -> Complex:
        lines.append(frequency_hz.size)
        return response(frequency_hz)  # type: ignore[operator, no-any-return]

    filtered(STEP, RATE_HZ, asked)
    assert lines == [next_fast_len(3 * SAMPLES, real=True) // 2 + 1]
