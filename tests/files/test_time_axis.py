"""A time axis beside the samples: rounding is no fault, a gap and a drift are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import scipy.io

from vgvt.data import InputError
from vgvt.files import open_campaign
from vgvt.files.time_axis import check_time_axis

RATE_HZ = 2000.0
EVEN = np.arange(120_001) / RATE_HZ


@pytest.mark.parametrize(
    "time_s",
    [
        pytest.param(EVEN, id="even"),
        pytest.param(EVEN + 1.7e9, id="seconds since 1970"),
        pytest.param(EVEN.astype(np.float32), id="single precision"),
        pytest.param((EVEN + 3000).astype(np.float32), id="single precision after most of an hour"),
        pytest.param(np.cumsum(np.full(EVEN.size, 1 / RATE_HZ, dtype=np.float32)), id="steps added up in single"),
        pytest.param(np.round(EVEN, 4), id="rounded to 0.1 ms"),
        pytest.param(EVEN * (1 + 5e-4), id="a clock that is half a thousandth slow"),
        pytest.param(EVEN + np.random.default_rng(0).uniform(-1e-4, 1e-4, EVEN.size), id="jitter of 0.2 samples"),
    ],
)
def test_an_axis_as_real_recorders_write_it_is_taken(time_s: np.ndarray) -> None:
    check_time_axis(time_s.astype(float), EVEN.size, RATE_HZ, "here")


def lost(at: int, count: int) -> np.ndarray:
    """The even axis without ``count`` entries."""
    return np.delete(EVEN, slice(at, at + count))


@pytest.mark.parametrize(
    ("time_s", "words"),
    [
        (lost(60_000, 1), r"steps by 0\.001 s from entry 60000 to entry 60001, 0\.0005 s is one sample \(1 such"),
        (lost(3, 1), "from entry 3 to entry 4"),
        (np.insert(EVEN, 500, EVEN[500])[:-1], r"steps by 0 s from entry 501"),
        (np.where(np.arange(EVEN.size) == 77, np.nan, EVEN), r"steps by nan s .*\(2 such"),
        (EVEN + 0.02 * np.sin(2 * np.pi * EVEN / 60), "is not even: entry"),
        (EVEN[::-1], "says -2000 Hz"),
        (EVEN / 2, "says 4000 Hz, the sidecar says 2000 Hz"),
        (EVEN * 0, "says nan Hz"),
        (np.round(EVEN, 3), r"steps by 0 s from entry 1"),
    ],
)
def test_a_gap_or_a_drift_is_told_with_its_place(time_s: np.ndarray, words: str) -> None:
    with pytest.raises(InputError, match=words):
        check_time_axis(time_s, time_s.size, RATE_HZ, "here")


@pytest.mark.parametrize("entries", [1000, 495])
def test_an_axis_of_another_length_is_refused(bench: Path, volts: np.ndarray, entries: int) -> None:
    scipy.io.savemat(bench.parent / "raw/run2.mat", {"data": volts[1], "t": np.arange(entries) / 100.0})
    with pytest.raises(InputError, match=rf"run 2: the time axis has {entries} entries for 500 samples"):
        open_campaign(bench)


def test_a_gap_in_a_file_is_refused(bench: Path, volts: np.ndarray) -> None:
    left = np.delete(np.arange(500), slice(250, 253))
    scipy.io.savemat(bench.parent / "raw/run2.mat", {"data": volts[1, left], "t": left / 100.0})
    with pytest.raises(InputError, match=r"run2\.mat, run 2: the time axis steps by 0\.04 s from entry 250"):
        open_campaign(bench)
