"""TDMS files that are damaged, or say something else than their sidecar: told with file, place and what to write."""

from __future__ import annotations

import builtins
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tdms_by_nptdms import WAVEFORM, cut_sidecar, rows_of, write_tdms

from vgvt.data import InputError
from vgvt.files import open_campaign

Edit = Callable[[str, str], Path]


@pytest.fixture
def tdms(bench: Path, volts: np.ndarray) -> Path:
    """The bench in one TDMS file a run, of two segments each; returns the sidecar's path."""
    bench.write_text(cut_sidecar(bench.read_text()))
    for k in (1, 2):
        write_tdms(bench.parent / f"raw/run{k}.tdms", {"Log": rows_of(volts[k - 1])}, segments=2)
    return bench


def with_first_run(tdms: Path, volts: np.ndarray, k: int, samples: Any = None, **properties: Any) -> None:
    """Run 1 with one channel that is another one."""
    rows = rows_of(volts[0])
    name, usual, stated = rows[k]
    rows[k] = (name, usual if samples is None else samples, dict(stated) | properties)
    write_tdms(tdms.parent / "raw/run1.tdms", {"Log": rows})


ACC1 = r"run1\.tdms, /'Log'/'A1' \(run 1, channel 'acc1'\): "


@pytest.mark.parametrize(
    ("properties", "words"),
    [
        ({"wf_increment": 0.02}, ACC1 + r"the file states 50 Hz .*the sidecar 100 Hz\n.*overrides"),
        ({"wf_increment": 20.0, "wf_xunit_string": "ms"}, ACC1 + r"the file states 50 Hz \(wf_increment = 0\.02 s\)"),
        ({"wf_increment": -1.0}, ACC1 + "the file states no rate"),
        ({"wf_increment": float("nan")}, ACC1 + "the file states no rate"),
        ({"wf_xunit_string": "Hz"}, ACC1 + r"a function over 'Hz' \(wf_xunit_string\), and not over time"),
        ({"unit_string": "g"}, ACC1 + r"the file says that its unit is 'g', the sidecar says volts"),
        ({"unit_string": "", "NI_UnitDescription": "mV"}, ACC1 + "the file says that its unit is 'mV'"),
        ({"wf_start_offset": 0.5}, r"do not begin together: /'Log'/'A1' \+0\.5 s after /'Log'/'F'(.|\n)*overrides"),
    ],
)
def test_what_the_file_states_otherwise_is_told(
    tdms: Path, volts: np.ndarray, properties: dict[str, Any], words: str
) -> None:
    with_first_run(tdms, volts, 1, **properties)
    with pytest.raises(InputError, match=words):
        open_campaign(tdms)


def test_starts_are_compared_by_the_clock(tdms: Path, volts: np.ndarray) -> None:
    noon = np.datetime64("2024-03-01T12:00:00", "us")
    moments = [noon, noon + np.timedelta64(4, "ms"), noon]
    rows = [(n, x, p | {"wf_start_time": t}) for (n, x, p), t in zip(rows_of(volts[0]), moments, strict=True)]
    write_tdms(tdms.parent / "raw/run1.tdms", {"Log": rows})
    assert len(open_campaign(tdms).runs) == 2
    name, samples, properties = rows[1]
    rows[1] = (name, samples, properties | {"wf_start_time": noon + np.timedelta64(7, "ms")})
    write_tdms(tdms.parent / "raw/run1.tdms", {"Log": rows})
    with pytest.raises(InputError, match=r"run 1: its channels do not begin together: /'Log'/'A1' \+0\.007 s"):
        open_campaign(tdms)


@pytest.mark.parametrize(
    ("properties", "old", "new"),
    [
        ({"wf_increment": 0.02}, "columns = 3", 'columns = 3\noverrides = ["sample_rate_hz"]'),
        ({"wf_start_offset": 0.5}, "columns = 3", 'columns = 3\noverrides = ["sample_rate_hz"]'),
        ({"unit_string": "g"}, 'name = "acc1"\n', 'name = "acc1"\noverrides = ["unit"]\n'),
    ],
)
def test_a_file_that_is_wrong_can_be_overridden(
    tdms: Path, volts: np.ndarray, edited: Edit, properties: dict[str, Any], old: str, new: str
) -> None:
    with_first_run(tdms, volts, 1, **properties)
    assert len(open_campaign(edited(old, new)).runs) == 2


@pytest.mark.parametrize("properties", [{"unit_string": "furlong"}, {"unit_string": "", "wf_increment": 0.010001}])
def test_what_says_nothing_or_the_same_fits(tdms: Path, volts: np.ndarray, properties: dict[str, Any]) -> None:
    with_first_run(tdms, volts, 1, **properties)
    assert len(open_campaign(tdms).runs) == 2


@pytest.mark.parametrize(
    ("samples", "words"),
    [
        (np.zeros(499), "has 499 samples, and channel 'force' has 500\n.*cut to one length"),
        (np.array(["a"] * 500), r"/'Log'/'A1': holds no real numbers \(object\)"),
        (np.zeros(500, complex), r"/'Log'/'A1': holds no real numbers \(complex128\)"),
    ],
)
def test_samples_that_are_none_are_refused(tdms: Path, volts: np.ndarray, samples: np.ndarray, words: str) -> None:
    with_first_run(tdms, volts, 1, samples)
    with pytest.raises(InputError, match=words):
        open_campaign(tdms)


def test_a_record_without_samples_is_refused(tdms: Path) -> None:
    empty = np.zeros(0)
    write_tdms(tdms.parent / "raw/run1.tdms", {"Log": [(name, empty, WAVEFORM) for name in ("F", "A1", "A2")]})
    with pytest.raises(InputError, match=r"run1\.tdms, run 1: the record has no samples"):
        open_campaign(tdms)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("column = 3", "column = 4", r"3 channels in its group, but channel 'acc2' is said to be column 4"),
        ("column = 2", 'variable = "A7"', r"run 1, channel 'acc1': no channel 'A7'\n.*A1"),
        ("column = 2", "variable = \"/'Lag'/'A1'\"", r"no channel \"/'Lag'/'A1'\"\n.*/'Log'/'A1'"),
        ("column = 2", 'variable = "F"', r"channels 'force' and 'acc1' are both /'Log'/'F'"),
        ("columns = 3", 'columns = 3\nsamples = "Lag"', r"no group 'Lag'\n.*Log"),
        ("columns = 3", 'columns = 3\ntime_s = "Tome"', r"run 1: no channel 'Tome'"),
        ("columns = 3", "columns = 5", r"3 channels in group 'Log', but the sidecar speaks of 5"),
        ("columns = 3", 'columns = 3\nchannels_are = "rows"', r"records: a TDMS file holds its channels one by one"),
        ('file = "run1.tdms"', 'file = "run1.tdms"\nindex = 2', r"no run 2 in a file of 1 group\n.*index = 1 to 1"),
        ("column = 2", 'column = 2\nvariable = "A1"', r"'acc1' has a column and a variable; leave|leave one of them"),
        ("column = 2", 'column = 2\noverrides = ["dof"]', r"'acc1': a file of format tdms states no dof"),
    ],
)
def test_what_the_file_does_not_have_is_told(tdms: Path, edited: Edit, old: str, new: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        open_campaign(edited(old, new))


@pytest.mark.parametrize(
    ("old", "new"),
    [("columns = 3", 'columns = 3\nsamples = "Log"'), ("column = 2", "variable = \"/'Log'/'A1'\"")],
)
def test_a_group_and_an_index_contradict_each_other(tdms: Path, edited: Edit, old: str, new: str) -> None:
    edited('file = "run1.tdms"', 'file = "run1.tdms"\nindex = 1')
    with pytest.raises(InputError, match=r"run 1 is the group of that index, and another group is named\n.*samples"):
        open_campaign(edited(old, new))


def test_several_groups_are_listed(tdms: Path, volts: np.ndarray) -> None:
    write_tdms(tdms.parent / "raw/run1.tdms", {"one": rows_of(volts[0]), "two": rows_of(volts[0])})
    with pytest.raises(InputError, match=r"2 groups, and nothing says which one: 'one', 'two'\n.*samples = 'one'"):
        open_campaign(tdms)


def test_a_file_without_channels_is_told(tdms: Path) -> None:
    write_tdms(tdms.parent / "raw/run1.tdms", {})
    with pytest.raises(InputError, match=r"run1\.tdms: holds no channels"):
        open_campaign(tdms)


def test_a_file_cut_anywhere_is_told(tdms: Path) -> None:
    """A reader that goes on to the file's end finds fewer samples, and says nothing."""
    path = tdms.parent / "raw/run1.tdms"
    whole = path.read_bytes()
    second = whole.index(b"TDSm", 1)
    for length in (1, 27, 28, 200, second - 1, second + 3, second + 20, second + 200, len(whole) - 1):
        path.write_bytes(whole[:length])
        place = 1 if length < second else 2
        with pytest.raises(InputError, match=rf"run1\.tdms, segment {place} of the file: truncated.*\n.*copy"):
            open_campaign(tdms)
    path.write_bytes(b"")
    with pytest.raises(InputError, match=r"run1\.tdms: the file is empty"):
        open_campaign(tdms)


@pytest.mark.parametrize(
    ("at", "wrong", "words"),
    [
        (0, b"RIFF", r"not a TDMS file: it begins with b'RIFF"),
        (0, b"TDSh", r"the index of a TDMS file(.|\n)*\.tdms that lies beside it"),
        (12, b"\xff" * 8, r"segment 1 of the file: never closed"),
        (20, b"\xff" * 8, r"segment 1 of the file: damaged: its samples would begin behind its end"),
        (8, struct.pack("<I", 99), r"run1\.tdms: damaged \(Unrecognised version number: 99\)"),
    ],
)
def test_a_head_that_is_wrong_is_told(tdms: Path, at: int, wrong: bytes, words: str) -> None:
    path = tdms.parent / "raw/run1.tdms"
    whole = path.read_bytes()
    path.write_bytes(whole[:at] + wrong + whole[at + len(wrong) :])
    with pytest.raises(InputError, match=words):
        open_campaign(tdms)


def test_what_npt_dms_only_warns_of_is_refused(tdms: Path, volts: np.ndarray) -> None:
    """It would leave samples unscaled."""
    scale = {"NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": "Magic"}
    with_first_run(tdms, volts, 1, **scale)
    with pytest.raises(InputError, match=r"run1\.tdms: damaged \(Unsupported scale type: Magic\)"):
        open_campaign(tdms)


def test_wrong_bytes_are_told_or_change_nothing_but_numbers(tdms: Path) -> None:
    path = tdms.parent / "raw/run1.tdms"
    whole = path.read_bytes()
    generator = np.random.default_rng(5)
    refused = 0
    headers = [*range(400), *range(whole.index(b"TDSm", 1), whole.index(b"TDSm", 1) + 100)]
    for at in generator.choice(headers, 150, replace=False):
        path.write_bytes(whole[:at] + bytes([int(generator.integers(256))]) + whole[at + 1 :])
        try:
            assert len(open_campaign(tdms).runs) == 2
        except InputError:
            refused += 1
    assert refused > 50


def test_without_nptdms_it_is_said_what_to_install(tdms: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any, **more: Any) -> Any:
        if name.split(".")[0] == "nptdms":
            raise ImportError(name)
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(InputError, match=r"run1\.tdms: .*npTDMS, which is not installed\n  pip install 'vgvt\[tdms\]'"):
        open_campaign(tdms)


def test_a_file_by_itself_is_told_to_need_a_sidecar(tdms: Path) -> None:
    with pytest.raises(InputError, match=r"run1\.tdms: a TDMS file does not say all(.|\n)*vgvt data describe .*run1"):
        open_campaign(tdms.parent / "raw/run1.tdms")
