"""Excitations beside the linear chirp: the spectrum they promise, one function of time, silence outside."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from vgvt.signals import (
    burst_random,
    continuous_random,
    logarithmic_chirp,
    multisine,
    multisine_lines,
    stepped_frequencies,
    stepped_sine,
)

Array = NDArray[np.float64]
LOW, HIGH, LENGTH = 3.0, 35.0, 20.0
RATE = 500.0
TIME = np.arange(-int(2 * RATE), int((LENGTH + 2) * RATE) + 1) / RATE


def stream(seed: int = 5) -> np.random.Generator:
    return np.random.default_rng(seed)


KINDS: dict[str, Callable[[Array], Array]] = {
    "logarithmic": lambda t: logarithmic_chirp(t, LOW, HIGH, LENGTH, 0.5),
    "stepped": lambda t: stepped_sine(t, LOW, HIGH, LENGTH, 40, 0.5),
    "random": lambda t: continuous_random(t, stream(), LOW, HIGH, LENGTH, 0.5),
    "burst": lambda t: burst_random(t, stream(), LOW, HIGH, LENGTH, 4, 0.6, 0.2),
    "multisine": lambda t: multisine(t, stream(), LOW, HIGH, LENGTH, 4, "odd", 0, 0.5),
}


@pytest.mark.parametrize("kind", KINDS)
def test_it_is_silent_outside_its_duration(kind: str) -> None:
    signal = KINDS[kind](TIME)
    assert signal.shape == TIME.shape
    assert not signal[(TIME < 0) | (TIME > LENGTH)].any()
    assert np.abs(signal).max() > 0.5


@pytest.mark.parametrize("kind", KINDS)
def test_it_is_one_function_of_time_whatever_the_instants(kind: str) -> None:
    """The engines ask at different rates, and must hear the same command."""
    fine = KINDS[kind](np.arange(int(LENGTH * 4 * RATE) + 1) / (4 * RATE))
    coarse = KINDS[kind](np.arange(int(LENGTH * RATE) + 1) / RATE)
    np.testing.assert_allclose(fine[::4], coarse, atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_its_power_lies_in_the_band(kind: str) -> None:
    signal = KINDS[kind](TIME)
    power = np.abs(np.fft.rfft(signal)) ** 2
    frequency = np.fft.rfftfreq(TIME.size, 1 / RATE)
    inside = (frequency > LOW - 1) & (frequency < HIGH + 1)
    assert power[inside].sum() / power.sum() > 0.99
    # Nor does any third of the band go short of half of its share (by octaves where the sweep goes by them).
    edges = np.geomspace(LOW, HIGH, 4) if kind == "logarithmic" else np.linspace(LOW, HIGH, 4)
    thirds = [power[(frequency >= a) & (frequency < b)].sum() for a, b in pairwise(edges)]
    assert min(thirds) > 0.5 * np.mean(thirds)


def instantaneous_hz(signal: Array, at_s: float, around_s: float = 0.4) -> float:
    """Frequency from the zero crossings around an instant, interpolated."""
    near = np.abs(TIME - at_s) <= around_s
    time, x = TIME[near], signal[near]
    before = np.flatnonzero(np.diff(np.sign(x)) != 0)
    crossing = time[before] - x[before] * (time[before + 1] - time[before]) / (x[before + 1] - x[before])
    return float(0.5 * (crossing.size - 1) / (crossing[-1] - crossing[0]))


@pytest.mark.parametrize(("start", "stop"), [(LOW, HIGH), (HIGH, LOW)])
def test_a_logarithmic_sweep_passes_equal_octaves_in_equal_times(start: float, stop: float) -> None:
    signal = logarithmic_chirp(TIME, start, stop, LENGTH)
    for part in (0.25, 0.5, 0.75):
        assert instantaneous_hz(signal, part * LENGTH) == pytest.approx(start * (stop / start) ** part, rel=0.02)


def test_a_stepped_sine_dwells_at_its_frequencies_without_a_jump() -> None:
    points = 8
    signal = stepped_sine(TIME, LOW, HIGH, LENGTH, points)
    dwell = LENGTH / points
    for k, frequency in enumerate(stepped_frequencies(LOW, HIGH, points)):
        assert instantaneous_hz(signal, (k + 0.5) * dwell, 0.45 * dwell) == pytest.approx(frequency, rel=2e-3)
    inside = (TIME >= 0) & (TIME <= LENGTH)
    assert np.abs(np.diff(signal[inside])).max() <= 2 * np.pi * HIGH / RATE


def test_random_noise_has_unit_power_a_gaussian_shape_and_no_memory_of_its_start() -> None:
    time = np.arange(int(400 * RATE)) / RATE
    noise = continuous_random(time, stream(1), LOW, HIGH, 400.0)
    # 2 B T = 25 600 independent values: the variance is known to 0.9 %, kurtosis to 0.03.
    assert noise.var() == pytest.approx(1.0, abs=0.03)
    assert (noise**4).mean() / noise.var() ** 2 == pytest.approx(3.0, abs=0.15)
    halves = noise.reshape(2, -1)
    assert abs(np.corrcoef(halves)[0, 1]) < 0.03


def test_another_stream_is_another_noise_and_the_same_stream_the_same() -> None:
    first, again, other = (continuous_random(TIME, stream(s), LOW, HIGH, LENGTH) for s in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert abs(np.corrcoef(first, other)[0, 1]) < 0.2


def test_bursts_are_followed_by_silence_and_differ() -> None:
    blocks, fraction = 4, 0.6
    signal = burst_random(TIME, stream(), LOW, HIGH, LENGTH, blocks, fraction, 0.1)
    block = LENGTH / blocks
    since = TIME % block
    inside = (TIME >= 0) & (TIME < LENGTH)
    assert not signal[inside & (since > fraction * block)].any()
    assert signal[inside & (since < fraction * block)].std() == pytest.approx(1.0, abs=0.15)
    begin, samples = np.flatnonzero(TIME == 0)[0], int(fraction * block * RATE)
    first, second = (signal[begin + int(k * block * RATE) :][:samples] for k in (0, 1))
    assert abs(np.corrcoef(first, second)[0, 1]) < 0.3


@pytest.mark.parametrize("lines", ["full", "odd"])
def test_a_multisine_repeats_and_excites_its_lines_and_no_other(lines: str) -> None:
    periods = 4
    time = np.arange(int(LENGTH * RATE)) / RATE
    signal = multisine(time, stream(), LOW, HIGH, LENGTH, periods, lines)  # type: ignore[arg-type]
    first = signal.reshape(periods, -1)
    np.testing.assert_allclose(first[1:], np.broadcast_to(first[0], first[1:].shape), atol=1e-6)
    assert signal.std() == pytest.approx(1.0, rel=1e-6)
    size = np.abs(np.fft.rfft(first[0])) * 2 / first.shape[1]
    period = LENGTH / periods
    excited = multisine_lines(LOW, HIGH, period, lines)  # type: ignore[arg-type]
    step = 2 if lines == "odd" else 1
    np.testing.assert_array_equal(np.diff(excited), step)
    assert all(excited % 2 == 1) or lines == "full"
    np.testing.assert_allclose(size[excited], np.sqrt(2 / excited.size), rtol=1e-5)
    rest = np.delete(size, excited)
    assert rest.max() < 1e-5 * size.max()


def test_crest_optimisation_lowers_the_peak_and_keeps_the_spectrum() -> None:
    time = np.arange(int(5 * RATE)) / RATE
    plain, optimised = (multisine(time, stream(), LOW, HIGH, 5.0, 1, "full", n) for n in (0, 200))
    assert np.abs(optimised).max() < 0.75 * np.abs(plain).max()
    # Schroeder's phases reach 1.7 for a flat spectrum; swapping comes near it, a sine has 1.41.
    assert np.abs(optimised).max() < 1.9
    np.testing.assert_allclose(*(np.abs(np.fft.rfft(x))[15:176] for x in (plain, optimised)), rtol=1e-5)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: logarithmic_chirp(TIME, 0.0, HIGH, LENGTH), "positive"),
        (lambda: logarithmic_chirp(TIME, LOW, HIGH, LENGTH, 11.0), "taper_s must"),
        (lambda: stepped_sine(TIME, LOW, HIGH, LENGTH, 1), "two points"),
        (lambda: continuous_random(TIME, stream(), 3.0, 3.01, LENGTH), "fewer than two"),
        (lambda: burst_random(TIME, stream(), LOW, HIGH, LENGTH, 2, 1.5), "burst_fraction"),
        (lambda: multisine(TIME, stream(), 3.0, 3.25, LENGTH, 4, "odd"), "fewer than two"),
    ],
)
def test_nonsense_is_refused(call: Callable[[], Array], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        call()
