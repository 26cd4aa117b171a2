"""What a command writes replaces its own kind and nothing else, and its place is looked at before any work."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path

import pytest

from vgvt.cli import console, written_file
from vgvt.cli.boundary import run_command
from vgvt.cli.written_file import checked_file, is_baseline, is_claim, is_page
from vgvt.data import InputError


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run folder of the bundled quick scenario."""
    folder = tmp_path_factory.mktemp("runs") / "quick"
    assert run_command(["simulate", "quick", "--out", str(folder)]) == 0
    return folder


def identify(campaign: Path, *more: str | Path) -> int:
    return run_command(["identify", str(campaign), "--identifier", "quadrature", *map(str, more)])


@pytest.mark.parametrize("option", ["--out", "--report"])
def test_records_are_not_replaced(campaign: Path, option: str, capsys: pytest.CaptureFixture[str]) -> None:
    records = campaign / "campaign.nc"
    before = records.read_bytes()
    assert identify(campaign, option, records) == 2
    assert "is what is read, and would be replaced" in capsys.readouterr().err
    assert records.read_bytes() == before


@pytest.mark.parametrize("option", ["--out", "--report"])
def test_a_scenario_is_not_replaced(
    campaign: Path, tmp_path: Path, option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    mine = tmp_path / "mine.toml"
    mine.write_text('extends = "quick"\n', encoding="utf-8")
    assert identify(campaign, option, mine) == 2
    assert f"{mine}: is there already, and is no" in capsys.readouterr().err
    assert mine.read_text(encoding="utf-8") == 'extends = "quick"\n'


def test_a_claim_replaces_a_claim_and_a_page_a_page(campaign: Path, tmp_path: Path) -> None:
    claim, page = tmp_path / "claim.json", tmp_path / "page.html"
    assert identify(campaign, "--out", claim, "--report", page) == 0
    assert is_claim(claim) and is_page(page)
    assert not is_claim(page) and not is_page(claim)
    assert identify(campaign, "--out", claim, "--report", page, "--band", "5", "30") == 0
    assert json.loads(claim.read_text(encoding="utf-8"))["band_hz"] == [5, 30]
    assert identify(campaign, "--out", page) == 2
    assert identify(campaign, "--report", claim) == 2


def test_both_in_one_file_are_refused(campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert identify(campaign, "--out", tmp_path / "one", "--report", tmp_path / "one") == 2
    assert "give the page another name" in capsys.readouterr().err
    assert not (tmp_path / "one").exists()


@pytest.mark.parametrize(("out", "report"), [("sub/../one", "one"), ("here/one", "there/one")])
def test_one_file_by_two_names_is_one_file(
    campaign: Path, tmp_path: Path, out: str, report: str, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("sub", "there"):
        (tmp_path / name).mkdir()
    (tmp_path / "here").symlink_to(tmp_path / "there")
    assert identify(campaign, "--out", tmp_path / out, "--report", tmp_path / report) == 2
    assert "give the page another name" in capsys.readouterr().err


def test_what_is_no_campaign_is_told_as_ever(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mine = tmp_path / "mine.toml"
    mine.write_text('extends = "quick"\n', encoding="utf-8")
    for more in ((), ("--out", tmp_path / "claim.json")):
        assert identify(mine, *more) == 2
        assert "this is a scenario, not measured records" in capsys.readouterr().err
        assert identify(tmp_path / "none.toml", *more) == 2
        assert "measured campaigns: hati" in capsys.readouterr().err


def test_a_place_that_cannot_be_written_costs_no_work(
    campaign: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("vgvt.cli.soundness.sound_campaign", lambda *given: pytest.fail("it was read"))
    locked = tmp_path / "locked"
    monkeypatch.setattr(os, "access", lambda place, mode: Path(place) != locked)
    locked.mkdir()
    assert identify(campaign, "--out", locked / "claim.json") == 2
    assert "may not be written to" in capsys.readouterr().err
    # Nor a folder, nor what lies below a file.
    (tmp_path / "file").touch()
    for place in (locked, tmp_path / "file" / "claim.json"):
        assert identify(campaign, "--out", place) == 2


def test_a_baseline_replaces_a_baseline_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    known = Path(__file__).parents[2] / "scoreboard" / "baselines" / "quick.csv"
    assert is_baseline(known)
    assert checked_file(known, "baseline", is_baseline) == known
    table = tmp_path / "mine.csv"
    table.write_text("a,b\n1,2\n", encoding="utf-8")
    assert run_command(["bench", "quick", "--out", str(tmp_path / "bench"), "--baseline", str(table)]) == 2
    assert "is there already, and is no baseline" in capsys.readouterr().err
    assert not (tmp_path / "bench").exists()
    assert table.read_text(encoding="utf-8") == "a,b\n1,2\n"


def test_a_file_that_is_not_there_may_be_written_where_its_folder_is_not_either(tmp_path: Path) -> None:
    place = tmp_path / "new" / "newer" / "claim.json"
    assert checked_file(place, "claim", is_claim) == place
    assert not place.parent.exists()
    # A link that leads nowhere is somebody's.
    dangling = tmp_path / "dangling"
    dangling.symlink_to(tmp_path / "gone")
    with pytest.raises(InputError, match="is there already"):
        checked_file(dangling, "claim", is_claim)


def test_an_empty_file_is_nobodys_and_a_huge_one_is_not_read(tmp_path: Path) -> None:
    place = tmp_path / "claim.json"
    place.touch()
    assert checked_file(place, "claim", is_claim) == place
    with place.open("wb") as stream:
        stream.truncate(1 << 40)
    with pytest.raises(InputError, match="is no claim"):
        checked_file(place, "claim", lambda path: pytest.fail("it was read"))


def test_what_cannot_be_read_is_no_page(tmp_path: Path) -> None:
    assert not is_baseline(tmp_path)
    place = tmp_path / "bytes"
    place.write_bytes(b"\xff\xfe\x00<footer>vgvt ")
    assert not written_file.is_page(place)
    assert not written_file.is_page(tmp_path / "none")


def test_long_work_that_knows_no_share_says_that_it_goes_on(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(console, "_SECONDS_BETWEEN_LINES", 0.02)
    with console.waiting("identify") as say:
        say("read the records")
        time.sleep(0.2)
    said = capsys.readouterr().err
    assert "identify: read the records, 0 s so far" in said
    time.sleep(0.1)
    assert capsys.readouterr().err == ""
