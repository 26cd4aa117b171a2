"""Whatever a person names, it opens or says what to do."""

from __future__ import annotations

from pathlib import Path

import pytest

from vgvt.data import InputError
from vgvt.files import measured_names, open_campaign
from vgvt.files.open import shipped_sidecar
from vgvt.files.sidecar import Sidecar
from vgvt.files.strict import load_table


def test_a_mistyped_name_gets_a_suggestion() -> None:
    with pytest.raises(InputError, match=r"no such file, folder or measured campaign(.|\n)*mean 'hati-2015-09-24"):
        open_campaign("hati-2015-9-24")


def test_a_path_that_is_not_there_is_called_a_path(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file or folder"):
        open_campaign(tmp_path / "campaign.nc")
    with pytest.raises(InputError, match=r"the folder holds no campaign\.nc"):
        open_campaign(tmp_path)


@pytest.mark.parametrize("name", ["hati-2015-09-24", "hati-2015-09-24-200hz"])
def test_absent_records_come_with_the_ways_to_get_them(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str
) -> None:
    monkeypatch.setenv("VGVT_DATA", str(tmp_path))
    with pytest.raises(InputError, match=r"not on this machine(.|\n)*vgvt data get(.|\n)*VGVT_DATA"):
        open_campaign(name)


@pytest.mark.parametrize("name", measured_names())
def test_the_shipped_sidecars_are_sound(name: str) -> None:
    sidecar = load_table(shipped_sidecar(name), Sidecar)
    assert sidecar.name == name
    assert len(sidecar.run) == 10
    assert all(run.sha256 for run in sidecar.run)
    positions = sidecar.axes.to_aircraft_m(sidecar.nodes.table)
    at = dict(zip(sidecar.nodes.node, positions, strict=True))
    # Points 1 to 10 are on the right wing, the shaker 25 in aft and 4.5 in to the right.
    assert all(at[n][1] > 0 for n in range(1, 11))
    assert all(at[n][1] < 0 for n in range(11, 21))
    assert at[100] == pytest.approx([0.635, 0.1143, 0.0])
    assert at[1] == pytest.approx([0.483362, 0.453898, 0.0])
    for odd in range(1, 21, 2):
        assert at[odd][0] < at[odd + 1][0], "the odd points are the forward row"


def test_the_data_folder_may_be_the_data_set_itself(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from vgvt.files.locate import find_dataset

    (tmp_path / "set" / "raw").mkdir(parents=True)
    (tmp_path / "set" / "raw" / "a.mat").touch()
    for folder in (tmp_path, tmp_path / "set"):
        monkeypatch.setenv("VGVT_DATA", str(folder))
        assert find_dataset("set", "raw/a.mat") == tmp_path / "set"
