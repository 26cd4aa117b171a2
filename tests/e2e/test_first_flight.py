"""The spine, from the command line to the files: the embedded default scenario, simulated for real."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from vgvt.cli import main
from vgvt.files import check_manifest, read_campaign


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One run of the quick scenario with the fast engine."""
    folder = tmp_path_factory.mktemp("first-flight") / "quick"
    assert main(["run", "quick", "--engine", "linear", "--out", str(folder)]) == 0
    return folder


def test_the_modes_are_found(run_folder: Path) -> None:
    card = json.loads((run_folder / "scorecards" / "auto.json").read_text(encoding="utf-8"))
    assert card["summary"]["missed"] == 0
    assert card["summary"]["false"] == 0
    for row in card["modes"]:
        assert abs(row["frequency_error_percent"]) < 1.0
        assert row["mac"] > 0.95


def test_the_folder_is_whole(run_folder: Path) -> None:
    assert check_manifest(run_folder) == ()
    page = (run_folder / "report.html").read_text(encoding="utf-8")
    assert "auto" in page
    assert not re.search(r"<(?:script|link|img)[^>]*(?:src|href)=[\"']?(?:https?:)?//", page)


def test_the_campaign_tells_nothing_of_the_true_modes(run_folder: Path) -> None:
    campaign = read_campaign(run_folder / "campaign.nc")
    truth = json.loads((run_folder / "scorecards" / "auto.json").read_text(encoding="utf-8"))
    words = " ".join((*campaign.notes.values(), *(note for run in campaign.runs for note in run.notes)))
    for row in truth["modes"]:
        assert f"{row['true_hz']:.2f}" not in words
        assert not row["label"] or row["label"] not in words


def test_same_seed_same_records(run_folder: Path, tmp_path: Path) -> None:
    assert main(["simulate", "quick", "--engine", "linear", "--out", str(tmp_path / "again")]) == 0
    first, again = (read_campaign(folder / "campaign.nc") for folder in (run_folder, tmp_path / "again"))
    for one, other in zip(first.runs, again.runs, strict=True):
        assert (one.samples == other.samples).all()


def test_another_seed_is_another_record_of_the_same_aircraft(run_folder: Path, tmp_path: Path) -> None:
    from vgvt.files.truth import read_truth

    again = tmp_path / "again"
    assert main(["simulate", "quick", "--engine", "linear", "--seed", "99", "--out", str(again)]) == 0
    first, other = (read_campaign(folder / "campaign.nc").runs[0] for folder in (run_folder, again))
    assert (first.samples[1] != other.samples[1]).any()
    true = [read_truth(folder / "sealed" / "truth.nc").bare.natural_frequency_hz for folder in (run_folder, again)]
    assert (true[0] == true[1]).all()
