"""A sidecar written from TDMS files: what they state stands in it, and when its gaps are filled it reads them."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tdms_by_nptdms import WAVEFORM, Row, write_tdms

from vgvt.data import Campaign, InputError
from vgvt.files import open_campaign
from vgvt.files.describe.draft import Description
from vgvt.files.tdms.describe import describe_tdms

NOON = np.datetime64("2024-03-01T12:00:00", "us")
UNITS = {"F": "N", "A1": "m/s^2", "A2": "m/s^2"}


def rows(samples: np.ndarray, names: Sequence[str] = ("F", "A1", "A2"), **properties: Any) -> list[Row]:
    """One run of samples (N, channels) at 100 Hz in the units of UNITS, else without."""
    return [
        (name, samples[:, k], WAVEFORM | {"unit_string": UNITS.get(name, "")} | properties)
        for k, name in enumerate(names)
    ]


def described(folder: Path, groups: Mapping[str, Sequence[Row]], **options: Any) -> tuple[Description, str]:
    """What is said of one file, and the sidecar's text."""
    write_tdms(folder / "log.tdms", groups)
    description = describe_tdms([folder / "log.tdms"], folder / "log.toml", **options)
    return description, (folder / "log.toml").read_text(encoding="utf-8")


def filled(sidecar: Path, **edits: str) -> Campaign:
    """The campaign, with all that is missing written as a person would: the n-th channel at node n, along +Z."""
    text = sidecar.read_text(encoding="utf-8")
    gaps = text.count("# dof =")
    for node in range(1, gaps + 1):
        text = text.replace("# dof =  # MISSING", f'dof = "{node}+Z"  # WAS', 1)
    text = text.replace("# node = [1]  # MISSING", f"node = {list(range(1, gaps + 1))}")
    for axis in "xyz":
        text = text.replace(f"# {axis} = [0.0]  # MISSING", f"{axis} = {[0.5 * k for k in range(gaps)]}  # WAS")
    for key, value in edits.items():
        text = re.sub(rf"# {key} =.*", f"{key} = {value}", text)
    sidecar.write_text(text, encoding="utf-8")
    return open_campaign(sidecar)


def test_what_the_file_states_stands_in_the_sidecar(tmp_path: Path, volts: np.ndarray) -> None:
    description, text = described(tmp_path, {"Log": rows(volts[0])}, band_hz=(2.0, 30.0))
    assert description.missing == (
        "F: its DOF, which the file does not state",
        "A1: its DOF, which the file does not state",
        "A2: its DOF, which the file does not state",
        "positions of the nodes",
    )
    assert description.remarks == ("log.tdms: taken as one run",)
    assert text.count("MISSING:") == 6  # three places, and x, y and z
    assert text.count("CHECK:") == 1  # the axes
    with pytest.raises(InputError, match=r"log\.toml"):
        open_campaign(tmp_path / "log.toml")
    campaign = filled(tmp_path / "log.toml")
    (run,) = campaign.runs
    assert (campaign.name, campaign.band_hz, run.sample_rate_hz) == ("log", (2.0, 30.0), 100.0)
    assert [(c.name, str(c.dof), c.role) for c in run.channels] == [
        ("F", "1+Z", "reference"),
        ("A1", "2+Z", "response"),
        ("A2", "3+Z", "response"),
    ]
    np.testing.assert_array_equal(run.samples, volts[0].T)


@pytest.mark.parametrize("change", [{"F": "F"}, {"F": "other F"}])
def test_a_file_a_run_by_names_else_by_columns(tmp_path: Path, volts: np.ndarray, change: Mapping[str, str]) -> None:
    """Names that are the same in every run tell the channels in any order; others do not."""
    (tmp_path / "raw").mkdir()
    files = [tmp_path / f"raw/run{k}.tdms" for k in (1, 2)]
    write_tdms(files[0], {"a": rows(volts[0])})
    second = [(change.get(name, name), *rest) for name, *rest in rows(volts[1])]
    write_tdms(files[1], {"b": second if change["F"] != "F" else second[::-1]})
    describe_tdms(files, tmp_path / "mine.toml")
    content = tomllib.loads((tmp_path / "mine.toml").read_text())
    assert content["records"]["folder"] == "raw"
    assert [channel.get("column") for channel in content["channel"]] == (
        [None, None, None] if change["F"] == "F" else [1, 2, 3]
    )
    assert not any("index" in run for run in content["run"])
    for run, samples in zip(filled(tmp_path / "mine.toml").runs, volts, strict=True):
        np.testing.assert_array_equal(run.samples, samples.T)
    write_tdms(files[1], {"b": rows(volts[1], ("A1", "F"))})
    with pytest.raises(InputError, match=r"run2\.tdms, 'b': its channels are not those of the first run: 'A1', 'F'"):
        describe_tdms(files, tmp_path / "other.toml")


def test_groups_of_the_same_names_are_runs(tmp_path: Path, volts: np.ndarray) -> None:
    note = [("T", np.zeros(3), {})]
    groups = {"first": rows(volts[0]), "notes": note, "second": rows(volts[1])}
    description, text = described(tmp_path, groups)
    assert description.remarks[:2] == (
        "CHECK: log.tdms: taken as 2 runs, one a group; --columns 7 takes all groups as one run",
        "log.tdms: left out group 'notes'",
    )
    assert [(run.index, run.first, run.last) for run in description.runs] == [(1, 1, 3), (3, 5, 7)]
    assert re.search(r"index = 3 +# group 'second'", text)
    for run, samples in zip(filled(tmp_path / "log.toml").runs, volts, strict=True):
        np.testing.assert_array_equal(run.samples, samples.T)


@pytest.mark.parametrize(
    ("seconds", "runs"), [(0.0, 1), (0.002, 1), (60.0, 2), (None, 2)], ids=["at once", "nearly", "a minute on", "unset"]
)
def test_clocks_tell_devices_from_runs(tmp_path: Path, volts: np.ndarray, seconds: float | None, runs: int) -> None:
    """A recorder whose clock was never set says 1904, of every run."""
    first = NOON if seconds is not None else np.datetime64("1904-01-01", "us")
    second = first + np.timedelta64(round((seconds or 0) * 1e6), "us")
    names = ("ai0", "ai1", "ai2")
    groups = {
        "Mod1": rows(volts[0], names, wf_start_time=first),
        "Mod2": rows(volts[1], names, wf_start_time=second),
    }
    description, _ = described(tmp_path, groups)
    assert len(description.runs) == runs
    if runs == 1:
        assert description.remarks[0] == "log.tdms: its 2 groups are taken as one run"
        assert description.channels[3].variable == "/'Mod2'/'ai0'"
        assert [channel.name for channel in description.channels[2:4]] == ["Mod1/ai2", "Mod2/ai0"]
        campaign = filled(tmp_path / "log.toml", quantity='"acceleration"', unit='"g"')
        np.testing.assert_allclose(campaign.runs[0].samples, 9.80665 * np.hstack([*volts]).T)


def test_the_number_of_channels_tells_what_is_a_run(tmp_path: Path, volts: np.ndarray) -> None:
    groups = {"Mod1": rows(volts[0]), "Mod2": rows(volts[1])}
    assert len(described(tmp_path, groups, columns=6)[0].runs) == 1
    assert described(tmp_path, groups, columns=3)[0].remarks == ("log.tdms: taken as 2 runs, one a group",)
    with pytest.raises(InputError, match=r"no group has 4 channels, nor have all .*'Mod1' has 3, 'Mod2' has 3"):
        described(tmp_path, groups, columns=4)


def test_one_group_of_several_is_named(tmp_path: Path, volts: np.ndarray) -> None:
    groups = {"Slow": [("T", np.zeros(5), {"wf_increment": 1.0, "unit_string": "degC"})], "Log": rows(volts[0])}
    description, text = described(tmp_path, groups)
    assert 'samples = "Log"' in text
    assert (
        "log.tdms: left out /'Slow'/'T': it has 5 samples at 1 Hz, and the others 500 samples at 100 Hz"
        in description.remarks
    )
    np.testing.assert_array_equal(filled(tmp_path / "log.toml").runs[0].samples, volts[0].T)


def test_many_slow_channels_do_not_outweigh_what_moved(tmp_path: Path, volts: np.ndarray) -> None:
    slow = [(f"T{k}", np.zeros(5), {"wf_increment": 1.0, "unit_string": "degC"}) for k in range(7)]
    description, _ = described(tmp_path, {"Log": [*slow, *rows(volts[0])]})
    assert [channel.name for channel in description.channels] == ["F", "A1", "A2"]


@pytest.mark.parametrize("dated", [False, True])
def test_a_time_channel_tells_the_rate(tmp_path: Path, volts: np.ndarray, dated: bool) -> None:
    time = np.arange(500) / 51.2
    moments = NOON + (time * 1e6).round().astype("timedelta64[us]")
    bare = [(name, samples, {"unit_string": UNITS[name]}) for name, samples, _ in rows(volts[0])]
    description, _ = described(tmp_path, {"Log": [("Time", moments if dated else time, {}), *bare]})
    (run,) = filled(tmp_path / "log.toml").runs
    assert run.sample_rate_hz == 51.2
    assert tomllib.loads((tmp_path / "log.toml").read_text())["records"]["time_s"] == "Time"
    assert [channel.name for channel in description.channels] == ["F", "A1", "A2"]
    time[300:] += 0.5
    description, text = described(tmp_path, {"Log": [("Time", time, {"unit_string": "s"}), *bare]})
    assert any("left out /'Log'/'Time': the time axis steps by" in remark for remark in description.remarks)
    assert "time_s" not in text


def test_without_rate_or_band_these_are_gaps(tmp_path: Path, volts: np.ndarray) -> None:
    bare = [(name, samples, {}) for name, samples, _ in rows(volts[0])]
    description, text = described(tmp_path, {"Log": bare})
    assert description.band_hz is None
    assert description.missing[:2] == (
        "the band that was excited",
        "the sample rate, which the file does not state",
    )
    assert "F: its quantity, which the file does not state" in description.missing
    assert "no channel states a unit of force: frequency responses need one" in description.remarks
    assert '"acceleration", "velocity"' in text
    edits = {"band_hz": "[2.0, 40.0]", "sample_rate_hz": "100.0", "quantity": '"force"', "unit": '"N"'}
    (tmp_path / "log.toml").write_text(text.replace('role = "response"', 'role = "reference"', 1))
    np.testing.assert_array_equal(filled(tmp_path / "log.toml", **edits).runs[0].samples, volts[0].T)


def test_volts_may_be_of_any_sensor(tmp_path: Path, volts: np.ndarray) -> None:
    description, text = described(tmp_path, {"Log": rows(volts[0], unit_string="V")})
    assert description.missing[:3] == (
        "F: its quantity, which the file does not state",
        "F: its sensitivity, since the file holds volts",
        "F: its DOF, which the file does not state",
    )
    assert text.count('CHECK: "reference" for a force, "drive"') == 3
    (run,) = filled(tmp_path / "log.toml", quantity='"force"', sensitivity='"2 V/N"').runs
    np.testing.assert_allclose(run.samples, volts[0].T / 2)


@pytest.mark.parametrize(
    ("samples", "properties", "words"),
    [
        (np.array(["a"] * 500), {}, "left out /'Log'/'A1': it holds no real numbers"),
        (np.zeros(0), {}, "left out /'Log'/'A1': it has no samples"),
        (None, {"wf_xunit_string": "Hz"}, "left out /'Log'/'A1': a function over 'Hz' .*not over time"),
        (None, {"wf_increment": -1.0}, "CHECK: /'Log'/'A1': the file states no rate .*overrides"),
        (None, {"wf_start_offset": 0.5}, r"CHECK: log\.tdms: its channels do not begin together: /'Log'/'A1'"),
    ],
)
def test_what_does_not_belong_is_said(
    tmp_path: Path, volts: np.ndarray, samples: np.ndarray | None, properties: dict[str, Any], words: str
) -> None:
    log = rows(volts[0])
    log[1] = ("A1", log[1][1] if samples is None else samples, WAVEFORM | {"unit_string": "g"} | properties)
    description, _ = described(tmp_path, {"Log": log})
    assert any(re.search(words, remark) for remark in description.remarks)
    kept = [channel.name for channel in description.channels]
    assert kept == (["F", "A2"] if words.startswith("left out") else ["F", "A1", "A2"])


def test_a_unit_that_changes_from_run_to_run_is_marked(tmp_path: Path, volts: np.ndarray) -> None:
    groups = {"one": rows(volts[0]), "two": [*rows(volts[1])[:2], ("A2", volts[1][:, 2], {"unit_string": "g"})]}
    description, _ = described(tmp_path, groups)
    assert "CHECK: the unit of A2 changes from run to run: 'm/s^2', 'g'" in description.remarks


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "the file is empty"),
        (b"TDSh" + bytes(40), "the index of a TDMS file, which holds no samples"),
        (b"PK\x03\x04" + bytes(40), "not a TDMS file: it begins with"),
    ],
)
def test_a_file_of_another_kind_leaves_no_sidecar(tmp_path: Path, content: bytes, words: str) -> None:
    (tmp_path / "log.tdms").write_bytes(content)
    with pytest.raises(InputError, match=rf"log\.tdms: {words}"):
        describe_tdms([tmp_path / "log.tdms"], tmp_path / "log.toml")
    assert not (tmp_path / "log.toml").exists()


def test_a_file_without_histories_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"log\.tdms: holds no channels"):
        described(tmp_path, {})
    with pytest.raises(InputError, match=r"log\.tdms: holds no time history\n.*'A1': it has no samples"):
        described(tmp_path, {"Log": [("A1", np.zeros(0), {})]})


def test_names_of_groups_and_channels_are_only_names(tmp_path: Path, volts: np.ndarray) -> None:
    names = ('a "b" \n[run]\\ é', "/'Log'/'x'", "=")
    groups = {"Log\n[[run]]": rows(volts[0], names, unit_string="N"), "two": rows(volts[1], names, unit_string="N")}
    described(tmp_path, groups)
    for run, samples in zip(filled(tmp_path / "log.toml").runs, volts, strict=True):
        np.testing.assert_array_equal(run.samples, samples.T)
