"""The measuring chain's factor: the AC coupling's corner, wherever a trial step puts it."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import scipy.signal

from vgvt.reconcile.prediction.chain import high_pass

RATE_HZ = 200.0
FREQUENCY_HZ = np.linspace(0.5, 80.0, 50)


@pytest.mark.parametrize("corner_hz", [0.0, 0.1, 3.0, 60.0])
def test_it_is_the_filter_that_the_acquisition_applies(corner_hz: float) -> None:
    """Scipy's own first-order high-pass."""
    wanted = np.ones(FREQUENCY_HZ.size, dtype=complex)
    if corner_hz > 0:
        coefficients = scipy.signal.butter(1, corner_hz, "highpass", fs=RATE_HZ)
        wanted = scipy.signal.freqz(*coefficients, worN=FREQUENCY_HZ, fs=RATE_HZ)[1]
    assert high_pass(corner_hz, FREQUENCY_HZ, RATE_HZ) == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("corner_hz", [99.0, 100.0, 250.0, 1e300, np.inf])
def test_a_corner_past_half_the_rate_passes_hardly_anything(corner_hz: float) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = high_pass(corner_hz, FREQUENCY_HZ, RATE_HZ)
    assert np.isfinite(found).all()
    assert np.abs(found[:10]).max() < 0.02
    assert np.abs(found).max() < np.abs(high_pass(60.0, FREQUENCY_HZ, RATE_HZ)).max()
