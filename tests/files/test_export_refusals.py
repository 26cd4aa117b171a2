"""What cannot be written is told, and nothing is left of it."""

from __future__ import annotations

import errno
from pathlib import Path

import numpy as np
import pytest
from rich_campaign import rich_campaign

from vgvt.data import Dof, FrequencyResponseSet, InputError
from vgvt.files import atomically
from vgvt.files.export import matlab, universal
from vgvt.files.export.campaign import export_campaign
from vgvt.files.export.responses import export_responses

FRF = FrequencyResponseSet(
    (Dof.from_label("1+Z"),), (Dof.from_label("9+Z"),), np.array([1.0, 2.0]), np.ones((1, 1, 2), complex), (1,)
)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("x.xls", r"x\.xls: no format ends in '\.xls'\n.*\.nc, \.uff, .*\.mat or \.csv"),
        ("x", r"x: its name has no ending, which says the format\n.*\.nc"),
    ],
)
def test_an_ending_that_is_no_format(tmp_path: Path, name: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        export_campaign(rich_campaign(), tmp_path / name)
    with pytest.raises(InputError, match=words):
        export_responses(FRF, tmp_path / name, "wing", rich_campaign().geometry)


def test_endings_are_written_as_people_write_them(tmp_path: Path) -> None:
    assert export_campaign(rich_campaign(), tmp_path / "X.UNV").files == (tmp_path / "X.UNV",)


def test_a_campaign_file_holds_no_frequency_responses(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"x\.nc: a campaign file holds time histories alone\n.*\.uff"):
        export_responses(FRF, tmp_path / "x.nc", "wing", rich_campaign().geometry)
    assert not list(tmp_path.iterdir())


def test_a_variable_that_is_too_large_for_matlab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(matlab, "_LARGEST_BYTES", 5 * 300 * 8)
    with pytest.raises(InputError, match=r"x-run7\.mat: a MAT file of version 5 holds 2 GiB a variable, and samples"):
        export_campaign(rich_campaign(), tmp_path / "x.mat")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["x.uff", "x.mat", "x.csv", "x.nc"])
def test_a_disk_without_room_is_told_before_anything_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    usage = type("Usage", (), {"free": 1000})
    monkeypatch.setattr(atomically.shutil, "disk_usage", lambda _: usage)
    with pytest.raises(OSError, match="MiB are free") as caught:
        export_campaign(rich_campaign(), tmp_path / name)
    assert caught.value.errno == errno.ENOSPC
    if name != "x.nc":
        large = FrequencyResponseSet(
            FRF.responses, FRF.references, np.arange(1, 21.0), np.ones((1, 1, 20), complex), FRF.runs
        )
        with pytest.raises(OSError, match="MiB are free"):
            export_responses(large, tmp_path / name, "wing", rich_campaign().geometry)
    assert not list(tmp_path.iterdir())


def test_what_breaks_off_leaves_what_was_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> bytes:
        raise KeyboardInterrupt

    for name in ("x.uff", "x.toml"):
        (tmp_path / name).write_text("mine")
    monkeypatch.setattr(universal, "function_58", broken)
    with pytest.raises(KeyboardInterrupt):
        export_campaign(rich_campaign(), tmp_path / "x.uff")
    with pytest.raises(KeyboardInterrupt):
        export_responses(FRF, tmp_path / "x.uff", "wing", rich_campaign().geometry)
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"x.uff": "mine", "x.toml": "mine"}


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    (tmp_path / "x.uff").mkdir()
    with pytest.raises(InputError, match=r"x\.uff: is a folder, and a file is to be written"):
        export_campaign(rich_campaign(), tmp_path / "x.uff")
    assert [path.name for path in tmp_path.iterdir()] == ["x.uff"]
