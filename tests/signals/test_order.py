"""Order tracking recovers what is at multiples of a sweep, and refuses drives that are no sine."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.signals.excitation import linear_chirp, linear_chirp_frequency, linear_chirp_phase
from vgvt.signals.order import order_envelope, track_drive

RATE_HZ, DURATION_S = 400.0, 30.0
TIME_S = np.arange(round(RATE_HZ * DURATION_S)) / RATE_HZ
INNER = slice(800, -800)


def test_the_track_follows_the_frequency_of_a_sweep() -> None:
    track = track_drive(linear_chirp(TIME_S, 3.0, 35.0, DURATION_S), RATE_HZ)
    assert track is not None
    true = linear_chirp_frequency(TIME_S, 3.0, 35.0, DURATION_S)
    np.testing.assert_allclose(track.frequency_hz[INNER], true[INNER], rtol=0.02)
    assert track.passes(19.0, RATE_HZ) == pytest.approx(15.0, abs=0.2)
    assert track.passes(60.0, RATE_HZ) is None


@pytest.mark.parametrize("order", [1, 2, 3])
def test_an_order_comes_out_with_its_amplitude_and_phase(order: int) -> None:
    """The drive is a sine, whose analytic signal lags by a quarter: cos(n (p - 90 deg))."""
    phase = linear_chirp_phase(TIME_S, 5.0, 20.0, DURATION_S)
    track = track_drive(np.sin(phase), RATE_HZ)
    assert track is not None
    signal = 1.0 * np.sin(phase) + 0.3 * np.cos(2 * phase + 0.4) + 0.1 * np.cos(3 * phase)
    envelope = order_envelope(signal, track, order, 1.0, RATE_HZ)[INNER]
    exact = {1: 1.0, 2: 0.3 * np.exp(1j * (0.4 + np.pi)), 3: 0.1 * np.exp(1.5j * np.pi)}[order]
    np.testing.assert_allclose(envelope, exact, atol=0.02)


def test_noise_and_silence_have_no_track() -> None:
    generator = np.random.default_rng(4)
    assert track_drive(generator.standard_normal(TIME_S.size), RATE_HZ) is None
    assert track_drive(np.zeros(TIME_S.size), RATE_HZ) is None
