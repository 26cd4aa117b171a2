"""Where measured data lie for somebody without a home folder, or who names one that is not there."""

from __future__ import annotations

from pathlib import Path
from typing import NoReturn

import pytest

from vgvt.data import InputError
from vgvt.files import locate


@pytest.fixture
def homeless(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """A user of a container: no HOME, no line in /etc/passwd, no variable of ours."""

    def nowhere() -> NoReturn:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", nowhere)
    for name in ("VGVT_DATA", "XDG_DATA_HOME"):
        monkeypatch.delenv(name, raising=False)
    return monkeypatch


def installed(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    """As if the package lay in a folder, with no checkout around it."""
    monkeypatch.setattr(locate, "__file__", str(folder / "vgvt" / "files" / "locate.py"))


def test_without_a_home_folder_the_ways_out_are_named(homeless: pytest.MonkeyPatch, tmp_path: Path) -> None:
    installed(homeless, tmp_path)
    for ask in (locate.default_data_folder, locate.data_folders, lambda: locate.find_dataset("set", "a.mat")):
        with pytest.raises(InputError, match="no home folder") as told:
            ask()
        assert "HOME, XDG_DATA_HOME or VGVT_DATA" in told.value.advice


@pytest.mark.parametrize("variable", ["VGVT_DATA", "XDG_DATA_HOME"])
def test_each_way_out_is_one(homeless: pytest.MonkeyPatch, tmp_path: Path, variable: str) -> None:
    homeless.setenv(variable, str(tmp_path))
    assert locate.default_data_folder().is_relative_to(tmp_path)
    assert locate.default_data_folder() in locate.data_folders()


def test_what_lies_beside_a_checkout_is_found_without_a_home_folder(
    homeless: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    installed(homeless, tmp_path / "checkout")
    (tmp_path / "checkout").mkdir()
    (tmp_path / "checkout" / "pyproject.toml").touch()
    (tmp_path / "shared" / "data" / "set").mkdir(parents=True)
    (tmp_path / "shared" / "data" / "set" / "a.mat").touch()
    assert locate.find_dataset("set", "a.mat") == tmp_path / "shared" / "data" / "set"


def test_a_home_folder_of_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VGVT_DATA", "~nobody-of-this-name/x")
    for ask in (locate.default_data_folder, locate.data_folders):
        with pytest.raises(InputError, match="VGVT_DATA: ~nobody-of-this-name/x: there is no such home folder"):
            ask()
