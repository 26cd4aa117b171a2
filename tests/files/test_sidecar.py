"""Measured records through a sidecar: right numbers in the right places, and mistakes told with their place."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io

from vgvt.data import Campaign, InputError, Quantity
from vgvt.files import open_campaign
from vgvt.files.manifest import file_sha256

Edit = Callable[[str, str], Path]


def test_volts_become_si(bench: Path, volts: np.ndarray) -> None:
    campaign = open_campaign(bench)
    record = campaign.runs[0]
    # 0.5 V/lb; 10 mV/g behind a gain of 100; 1 V/g. 1 lb = 4.4482216152605 N, 1 g = 9.80665 m/s^2.
    expected = volts[0].T * np.array([[4.4482216152605 / 0.5], [9.80665], [9.80665]])
    np.testing.assert_allclose(record.samples, expected, rtol=1e-14)
    np.testing.assert_allclose(
        [c.sensitivity_v_per_unit for c in record.channels], [0.5 / 4.4482216152605, 1 / 9.80665, 1 / 9.80665]
    )
    assert [c.quantity for c in record.channels][:2] == [Quantity.EXCITATION_FORCE, Quantity.ACCELERATION]
    assert (record.sample_rate_hz, campaign.band_hz) == (100.0, (2.0, 40.0))


def test_moving_sensors_are_where_each_run_says(bench: Path) -> None:
    labels = [[str(c.dof) for c in r.channels] for r in open_campaign(bench).runs]
    assert labels == [["100+Z", "1+Z", "2+Z"], ["100+Z", "3+Z", "4-Z"]]


def test_positions_come_out_in_aircraft_axes(bench: Path) -> None:
    geometry = open_campaign(bench).geometry
    # The table has x to the left and y aft, in mm, with the nose at x = 10: node 1 is 1 m to the right.
    np.testing.assert_allclose(geometry.position_m(1), [0.2, 1.0, 0.0])
    np.testing.assert_allclose(geometry.position_m(100), [0.05, 0.0, 0.0], atol=1e-15)


def test_rows_instead_of_columns(edited: Edit, bench: Path, volts: np.ndarray) -> None:
    plain = open_campaign(bench)
    for k, samples in enumerate(volts, start=1):
        scipy.io.savemat(bench.parent / f"raw/run{k}.mat", {"data": samples.T, "t": np.arange(500) / 100.0})
    turned = open_campaign(edited('samples = "data"', 'samples = "data"\nchannels_are = "rows"'))
    np.testing.assert_array_equal(turned.runs[1].samples, plain.runs[1].samples)


def test_matlab_7_3_files_read_the_same(bench: Path, volts: np.ndarray) -> None:
    plain = open_campaign(bench)
    for k, samples in enumerate(volts, start=1):
        path = bench.parent / f"raw/run{k}.mat"
        path.unlink()
        # MATLAB puts a 512 byte block of its own before the HDF5 file, and reverses the axes.
        with h5py.File(path, "w", userblock_size=512) as file:
            file["data"], file["t"] = samples.T, np.arange(500)[:, None] / 100.0
        with path.open("r+b") as stream:
            stream.write(b"MATLAB 7.3 MAT-file")
    np.testing.assert_array_equal(open_campaign(bench).runs[0].samples, plain.runs[0].samples)
    path.write_bytes(path.read_bytes()[:4000])
    with pytest.raises(InputError, match="truncated or damaged"):
        open_campaign(bench)


def test_text_files(edited: Edit, bench: Path, volts: np.ndarray) -> None:
    plain = open_campaign(bench)
    for k, samples in enumerate(volts, start=1):
        rows = "\n".join(";".join(repr(float(v)) for v in row) for row in samples)
        (bench.parent / f"raw/run{k}.csv").write_text(f"force;acc1;acc2\n{rows}\n")
    edited('format = "mat"', 'format = "csv"\ndelimiter = ";"\nskip_rows = 1')
    edited('samples = "data"\ntime_s = "t"\n', "")
    edited(".mat", ".csv")
    np.testing.assert_array_equal(open_campaign(bench).runs[0].samples, plain.runs[0].samples)
    edited("skip_rows = 1", "skip_rows = 0")
    with pytest.raises(InputError, match=r"run1\.csv: not a table of numbers(.|\n)*skip_rows"):
        open_campaign(bench)
    edited("skip_rows = 0", "skip_rows = 1")
    table = bench.parent / "raw/run1.csv"
    whole = table.read_text()
    table.write_text(whole[: len(whole) // 2].rpartition(";")[0])
    with pytest.raises(InputError, match=r"run1\.csv: row (\d+) of \1 has 2 columns, .* before it 3\n.*cut off there"):
        open_campaign(bench)
    table.write_text(whole.replace("\n", "\n1;", 3).replace("\n1;", "\n", 2))
    with pytest.raises(InputError, match=r"row 3 of 500 has 4 columns, and those before it 3\n.*mend that row"):
        open_campaign(bench)
    table.write_text("")
    with pytest.raises(InputError, match="no samples"):
        open_campaign(bench)


def test_several_runs_in_one_archive(edited: Edit, bench: Path, volts: np.ndarray) -> None:
    plain = open_campaign(bench)
    np.savez_compressed(bench.parent / "raw/all.npz", data=volts.astype(np.float32))
    edited('format = "mat"', 'format = "npz"')
    edited('time_s = "t"\n', "")
    edited('file = "run1.mat"', 'file = "all.npz"\nindex = 1')
    edited('file = "run2.mat"', 'file = "all.npz"\nindex = 2')
    campaign = open_campaign(bench)
    assert campaign.runs[0].samples.dtype == np.float32
    np.testing.assert_allclose(campaign.runs[1].samples, plain.runs[1].samples, rtol=1e-6)
    edited("index = 2", "index = 1")
    with pytest.raises(InputError, match=r"runs 1 and 2 are the same record \(all\.npz, index 1\)"):
        open_campaign(bench)
    edited("index = 1\nnodes = { acc1 = 3", "index = 3\nnodes = { acc1 = 3")
    with pytest.raises(InputError, match=r"run 2.*no run 3 in an array of shape \(2, 500, 3\)"):
        open_campaign(bench)
    archive = bench.parent / "raw/all.npz"
    archive.write_bytes(archive.read_bytes()[:-500])
    with pytest.raises(InputError, match=r"truncated|damaged"):
        open_campaign(bench)


def test_clipping_and_missing_samples_are_noted(bench: Path, volts: np.ndarray) -> None:
    samples = volts[0].copy()
    samples[10, 1], samples[20:25, 2] = -10.0, np.nan
    scipy.io.savemat(bench.parent / "raw/run1.mat", {"data": samples, "t": np.arange(500) / 100.0})
    record = open_campaign(bench).runs[0]
    assert record.overloaded == ("acc1",)
    assert record.notes == ("acc2: 5 of 500 samples are not finite",)
    assert np.isnan(record.samples[2, 20:25]).all()


def test_the_lowest_whole_number_is_full_scale(bench: Path, edited: Edit) -> None:
    edited("range_v = 10.0", "range_v = 32768.0")
    samples = np.ones((500, 3), dtype=np.int16)
    samples[7, 1] = -32768
    assert replace_run(bench, data=samples, t=TIME).runs[0].overloaded == ("acc1",)


def test_the_range_of_a_voltage_that_is_recorded_in_millivolts(bench: Path, edited: Edit) -> None:
    edited(
        'quantity = "acceleration"\nrole = "response"\ndirection = "+Z"\nsensitivity = "10 mV/g"\ngain = 100.0',
        'quantity = "voltage"\nrole = "drive"\nunit = "mV"',
    )
    edited("acc1 = 1, ", "")
    edited("acc1 = 3, ", "")
    for highest, clipped in ((9_999.0, ()), (10_001.0, ("acc1",))):
        samples = np.ones((500, 3))
        samples[7, 1] = highest
        assert replace_run(bench, data=samples, t=TIME).runs[0].overloaded == clipped


def test_a_force_may_be_measured_where_a_sensor_sits(edited: Edit) -> None:
    assert [str(d) for d in open_campaign(edited("acc2 = 2", "acc2 = 100")).response_dofs][:2] == ["1+Z", "100+Z"]


def replace_run(bench: Path, **variables: object) -> Campaign:
    """Open the campaign with other content in run1.mat."""
    scipy.io.savemat(bench.parent / "raw/run1.mat", variables)
    return open_campaign(bench)


TIME = np.arange(500) / 100.0


@pytest.mark.parametrize(
    ("variables", "message"),
    [
        ({"data": np.zeros((500, 2)), "t": TIME}, r"run1\.mat, run 1, 'data': 2 channels, but the sidecar speaks of 3"),
        ({"data": np.zeros((500, 4)), "t": TIME}, "4 channels, but the sidecar speaks of 3"),
        ({"data": np.zeros((3, 500)), "t": TIME}, r"500 channels(.|\n)*channels_are = 'rows'"),
        ({"dat": np.zeros((500, 3)), "t": TIME}, r"no variable 'data'(.|\n)*did you mean 'dat'"),
        ({"data": np.zeros((500, 3)), "t": TIME / 2}, "the time axis says 200 Hz, the sidecar says 100 Hz"),
        ({"data": np.zeros((0, 3)), "t": TIME}, r"no samples(.|\n)*leave this run out"),
        ({"data": np.zeros((500, 3)), "t": []}, "the time axis has 0 entries"),
        ({"data": "words", "t": TIME}, "holds no real numbers"),
        ({"data": np.zeros((500, 3), complex) + 1j, "t": TIME}, "holds no real numbers"),
        ({"data": np.zeros((5, 100, 3)), "t": TIME}, "is not samples × channels"),
    ],
)
def test_a_file_that_does_not_fit_is_named(bench: Path, variables: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        replace_run(bench, **variables)


@pytest.mark.parametrize("share", [0.0, 0.001, 0.02, 0.5, 0.9])
def test_a_truncated_mat_file_says_so(bench: Path, share: float) -> None:
    path = bench.parent / "raw/run2.mat"
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(
        InputError, match=r"run2\.mat: (the file is empty|truncated or damaged|not a MAT file|no variable)"
    ) as caught:
        open_campaign(bench)
    assert caught.value.advice


def test_a_missing_file_is_named_with_its_run(bench: Path) -> None:
    (bench.parent / "raw/run2.mat").unlink()
    with pytest.raises(InputError, match=r"run2\.mat: no such file \(run 2\)"):
        open_campaign(bench)


def test_a_hash_is_checked(edited: Edit, bench: Path, volts: np.ndarray) -> None:
    path = bench.parent / "raw/run1.mat"
    edited('file = "run1.mat"', f'file = "run1.mat"\nsha256 = "{file_sha256(path)}"')
    open_campaign(bench)
    whole = path.read_bytes()
    scipy.io.savemat(path, {"data": volts[0] * 2, "t": TIME})
    with pytest.raises(InputError, match=r"not the file that the sidecar describes(.|\n)*leave sha256 out"):
        open_campaign(bench)
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError, match="truncated or damaged"):
        open_campaign(bench)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            'name = "bench-beam"',
            'name = "bench-beam"\nbandhz = [1, 2]',
            r"bandhz: unknown key\n.*did you mean 'band_hz'",
        ),
        (
            'role = "reference"',
            'role = "referenz"',
            r"channel\[0\]\.role: (.|\n)*; counted from 0, channel\[0\] is 'force'$",
        ),
        ('unit = "mm"', 'unit = "furlong"', r"axes\.unit"),
        ('right = "-x"', 'right = "-y"', "do not use every axis once"),
        ('sensitivity = "0.5 V/lb"', 'sensitivity = "0.5 V"', r"channel\[0\].*'0.5 V' is not a sensitivity"),
        ('sensitivity = "0.5 V/lb"', 'sensitivity = "0.5 V/lbs"', r"not a unit of force\n.*did you mean 'lb"),
        ('sensitivity = "0.5 V/lb"', 'sensitivity = "0 V/lb"', "cannot be divided by"),
        ('sensitivity = "0.5 V/lb"', "", "give either sensitivity"),
        ('sensitivity = "1 V/g"', 'sensitivity = "1 V/g"\nunit = "g"', "give either sensitivity"),
        ('dof = "100+Z"', "", "give either dof"),
        ('dof = "100+Z"', 'dof = "100up"', "not a degree of freedom"),
        ('dof = "100+Z"', 'dof = "101+Z"', r"node 101, which has no position\n.*add it to \[nodes\]"),
        ("nodes = { acc1 = 1, acc2 = 2 }", "nodes = { acc1 = 1 }", "run 1: no node for acc2"),
        (
            "nodes = { acc1 = 1, acc2 = 2 }",
            "nodes = { acc1 = 1, acc2 = 2, acc3 = 3 }",
            r"run 1: nodes names \['acc3'\]",
        ),
        ("nodes = { acc1 = 1, acc2 = 2 }", "nodes = { acc1 = 1, acc2 = 77 }", "acc2 is at node 77"),
        ("run = 2", "run = 1", r"run\.run must be unique\n.*write each once, and not twice: 1"),
        ("run2.mat", "run1.mat", r"runs 1 and 2 are the same record \(run1\.mat\)"),
        ("x = [-990.0, ", "x = [", "x has 4 entries but node has 5"),
        ("node = [1, 2, 3, 4, 100]", "node = [1, 2, 3, 3, 100]", "node must be unique"),
        ("band_hz = [2.0, 40.0]", "band_hz = [40.0, 2.0]", r", band_hz: \[40\.0, 2\.0\] does not increase"),
        ("sample_rate_hz = 100.0", "sample_rate_hz = -100.0", r"records\.sample_rate_hz"),
        ("sample_rate_hz = 100.0", "", r"records\.sample_rate_hz: is missing"),
        ("column = 1", "column = 0", r"channel\[0\]\.column"),
        ("[records]", "[records", "not TOML"),
        ('quantity = "force"', 'quantity = "Force"', "'Force' is not a quantity"),
        ("column = 3", "column = 2", r"channels 'acc1' and 'acc2' are both column 2 of 'data'\n.*correct the column"),
        ('"4-Z"', '"3-Z"', r"run 2: acc1 and acc2 are both responses at 3\+Z"),
        ("acc2 = 2", "acc2 = 1", r"run 1: acc1 and acc2 are both responses at 1\+Z"),
        (
            'sensitivity = "10 mV/g"\ngain = 100.0',
            'unit = "g"',
            r"channel\[1\]: range_v is in volts, but unit = 'g' .*\n.*leave range_v out",
        ),
    ],
)
def test_a_mistake_in_the_sidecar_is_told_with_its_place(edited: Edit, old: str, new: str, message: str) -> None:
    path = edited(old, new)
    with pytest.raises(InputError, match=message) as caught:
        open_campaign(path)
    assert str(caught.value).startswith(str(path))
    assert "Traceback" not in str(caught.value)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ('names = { acc7 = "tip" }', r"run 1: names has 'acc7'\n.*the channels are force, acc1, acc2"),
        ('overloaded = ["acc7"]', r"run 1: overloaded has 'acc7'\n.*the channels are force, acc1, acc2"),
        ('names = { acc1 = "acc2" }', r"run 1: names must be unique\n.*twice: acc2"),
    ],
)
def test_a_run_names_channels_that_there_are(edited: Edit, line: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        open_campaign(edited('file = "run1.mat"\n', f'file = "run1.mat"\n{line}\n'))


def test_a_channel_may_have_another_name_and_have_clipped_in_a_run(edited: Edit) -> None:
    lines = 'names = { acc1 = "tip" }\noverloaded = ["acc1", "force"]\n'
    first, second = open_campaign(edited('file = "run1.mat"\n', f'file = "run1.mat"\n{lines}')).runs
    assert [channel.name for channel in first.channels] == ["force", "tip", "acc2"]
    assert [channel.name for channel in second.channels] == ["force", "acc1", "acc2"]
    assert (first.overloaded, second.overloaded) == (("force", "tip"), ())
