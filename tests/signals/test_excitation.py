"""The swept sine: continuous phase, the frequency it says, silence outside."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.signals import linear_chirp, linear_chirp_frequency, linear_chirp_phase

TIME = np.arange(-2000, 72001) / 1000.0


@pytest.mark.parametrize(("start", "stop"), [(1.0, 35.0), (35.0, 1.0)])
def test_the_frequency_is_the_derivative_of_the_phase(start: float, stop: float) -> None:
    phase = linear_chirp_phase(TIME, start, stop, 60.0)
    slope = (phase[2:] - phase[:-2]) / (TIME[2:] - TIME[:-2]) / (2 * np.pi)
    # Central differences of a parabola are exact; the two kinks of the frequency lie between samples.
    kink = np.abs((stop - start) / 60.0) * 1e-3
    np.testing.assert_allclose(slope, linear_chirp_frequency(TIME, start, stop, 60.0)[1:-1], atol=kink)


@pytest.mark.parametrize(("start", "stop"), [(1.0, 35.0), (35.0, 1.0)])
def test_zero_crossings_come_where_the_swept_frequency_puts_them(start: float, stop: float) -> None:
    time = np.arange(60001) / 1000.0
    crossings = np.count_nonzero(np.diff(np.sign(linear_chirp(time, start, stop, 60.0)[1:])))
    assert crossings == pytest.approx(2 * 60 * (start + stop) / 2, abs=1)


def test_a_downward_sweep_is_an_upward_one_played_backwards() -> None:
    # 2 pi times a whole number of cycles in all: then reversal only flips the sign.
    time = np.arange(10001) / 1000.0
    up, down = linear_chirp(time, 2.0, 20.0, 10.0), linear_chirp(time, 20.0, 2.0, 10.0)
    np.testing.assert_allclose(down, -up[::-1], atol=1e-9)


def test_it_is_silent_outside_and_never_above_one() -> None:
    signal = linear_chirp(TIME, 1.0, 35.0, 60.0)
    assert not signal[(TIME < 0) | (TIME > 60)].any()
    assert 0.999 < np.abs(signal).max() <= 1.0


def test_a_taper_leaves_the_middle_and_starts_and_ends_at_rest() -> None:
    plain, tapered = (linear_chirp(TIME, 1.0, 35.0, 60.0, taper) for taper in (0.0, 2.0))
    middle = (TIME >= 2.0) & (TIME <= 58.0)
    np.testing.assert_array_equal(tapered[middle], plain[middle])
    assert np.abs(tapered).max() <= 1.0
    ends = (TIME > 59.99) & (TIME <= 60.0)
    assert np.abs(tapered[ends]).max() < 1e-3 < np.abs(plain[ends]).max()


@pytest.mark.parametrize("arguments", [(1.0, 35.0, 0.0, 0.0), (1.0, 35.0, 10.0, 6.0), (1.0, 35.0, 10.0, -1.0)])
def test_nonsense_is_refused(arguments: tuple[float, float, float, float]) -> None:
    with pytest.raises(ValueError, match="_s must"):
        linear_chirp(TIME, *arguments)
