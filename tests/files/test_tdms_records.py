"""Time histories in TDMS files: the numbers of their npz twin, wherever groups and channels stand."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tdms_by_nptdms import WAVEFORM, cut_sidecar, rows_of, write_tdms

from vgvt.data import Campaign, InputError
from vgvt.files import open_campaign

Edit = Callable[[str, str], Path]


@pytest.fixture
def twin(bench: Path) -> Campaign:
    """The same samples read from MAT; the sidecar is turned to TDMS behind it."""
    campaign = open_campaign(bench)
    bench.write_text(cut_sidecar(bench.read_text()))
    return campaign


def same(read: Campaign, twin: Campaign) -> None:
    for one, other in zip(read.runs, twin.runs, strict=True):
        np.testing.assert_array_equal(one.samples, other.samples, strict=True)
        assert one.channels == other.channels
        assert one.sample_rate_hz == other.sample_rate_hz


@pytest.mark.parametrize("segments", [1, 7])
def test_a_file_a_run_with_its_channels_in_one_group(
    bench: Path, volts: np.ndarray, twin: Campaign, segments: int
) -> None:
    for k in (1, 2):
        write_tdms(bench.parent / f"raw/run{k}.tdms", {"Log": rows_of(volts[k - 1])}, segments)
    same(open_campaign(bench), twin)


def test_channels_are_found_by_their_names_in_a_group_that_is_named(
    bench: Path, volts: np.ndarray, twin: Campaign, edited: Edit
) -> None:
    for k in (1, 2):
        rows = rows_of(volts[k - 1, :, [2, 0, 1]].T, ["A2", "F", "A1"])
        write_tdms(bench.parent / f"raw/run{k}.tdms", {"Other": rows_of(volts[0] * 2), "Log": rows})
    edited("[axes]", 'samples = "Log"\n\n[axes]')
    for column, name in ((1, "F"), (2, "A1"), (3, "A2")):
        edited(f"column = {column}\n", f'variable = "{name}"\n')
    same(open_campaign(bench), twin)


def test_a_channel_may_be_called_as_its_group(bench: Path, volts: np.ndarray, twin: Campaign, edited: Edit) -> None:
    for k in (1, 2):
        rows = rows_of(volts[k - 1, :, [1, 0, 2]].T, ["A1", "F", "A2"])
        write_tdms(bench.parent / f"raw/run{k}.tdms", {"F": rows})
    edited("[axes]", 'samples = "F"\n\n[axes]')
    edited("column = 1\n", 'variable = "F"\n')
    edited("column = 2\n", "column = 1\n")
    same(open_campaign(bench), twin)


def test_a_group_a_device_is_read_by_whole_paths(bench: Path, volts: np.ndarray, twin: Campaign, edited: Edit) -> None:
    for k in (1, 2):
        force, *accelerations = rows_of(volts[k - 1], ["in 0", "in 0", "it's 1"])
        write_tdms(bench.parent / f"raw/run{k}.tdms", {"Mod1": [force], "Mod2": accelerations})
    edited("columns = 3\n", "")
    for column, path in ((1, "/'Mod1'/'in 0'"), (2, "/'Mod2'/'in 0'"), (3, "/'Mod2'/'it''s 1'")):
        edited(f"column = {column}\n", f'variable = "{path}"\n')
    same(open_campaign(bench), twin)


def test_a_group_a_run_is_read_by_the_index(bench: Path, volts: np.ndarray, twin: Campaign, edited: Edit) -> None:
    write_tdms(bench.parent / "raw/all.tdms", {"first": rows_of(volts[0]), "second": rows_of(volts[1])})
    for k in (1, 2):
        edited(f'file = "run{k}.tdms"', f'file = "all.tdms"\nindex = {k}')
    same(open_campaign(bench), twin)


@pytest.mark.parametrize("gap", [False, True])
@pytest.mark.parametrize("dated", [False, True])
def test_a_time_channel_is_compared_with_the_rate(
    bench: Path, volts: np.ndarray, twin: Campaign, edited: Edit, dated: bool, gap: bool
) -> None:
    time = np.arange(500) / 100.0 + 0.05 * (gap and np.arange(500) > 300)
    if dated:
        time = np.datetime64("2024-03-01T12:00:00", "us") + (time * 1e6).round().astype("timedelta64[us]")
    edited("columns = 3", 'columns = 4\ntime_s = "Time"')
    for k in (1, 2):
        write_tdms(bench.parent / f"raw/run{k}.tdms", {"Log": [*rows_of(volts[k - 1]), ("Time", time, {})]})
    if gap:
        with pytest.raises(InputError, match=r"/'Log'/'Time' \(run 1\): the time axis steps by 0\.06 s from entry 301"):
            open_campaign(bench)
        return
    same(open_campaign(bench), twin)


def test_numbers_of_a_converter_are_scaled_as_the_file_says(
    bench: Path, volts: np.ndarray, twin: Campaign, edited: Edit
) -> None:
    """NI's linear scale; and samples that are whole numbers or single come as they are."""
    linear = {
        "NI_Scaling_Status": "unscaled",
        "NI_Number_Of_Scales": 1,
        "NI_Scale[0]_Scale_Type": "Linear",
        "NI_Scale[0]_Linear_Slope": 2.0,
        "NI_Scale[0]_Linear_Y_Intercept": -1.0,
        "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF,
    }
    for k in (1, 2):
        force, first, second = rows_of(volts[k - 1])
        raw = ("F", (force[1] + 1) / 2, WAVEFORM | linear)
        whole = ("A1", (first[1] * 1000).astype(np.int16), WAVEFORM | {"unit_string": "mV"})
        write_tdms(bench.parent / f"raw/run{k}.tdms", {"Log": [raw, whole, (*second[:1], second[1].astype("f4"), {})]})
    edited('name = "acc1"\n', 'name = "acc1"\noverrides = ["unit"]\n')
    read = open_campaign(bench)
    for one, other in zip(read.runs, twin.runs, strict=True):
        np.testing.assert_allclose(one.samples[0], other.samples[0], rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(one.samples[1], other.samples[1] * 1000, atol=1.01 * 9.80665)
        np.testing.assert_allclose(one.samples[2], other.samples[2], rtol=1e-6)


def test_an_index_beside_the_file_is_not_believed(bench: Path, volts: np.ndarray, twin: Campaign) -> None:
    """Readers that do take the samples of another day for those of this one."""
    for k in (1, 2):
        path = bench.parent / f"raw/run{k}.tdms"
        write_tdms(path, {"Log": rows_of(volts[k - 1])})
        path.with_suffix(".tdms_index").write_bytes(b"TDSh" + b"\x00" * 40)
    same(open_campaign(bench), twin)
