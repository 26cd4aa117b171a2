"""``vgvt convert``: to other programs and back, and what it refuses."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyuff

from vgvt.data import Campaign
from vgvt.files import open_campaign, read_manifest, write_campaign
from vgvt.files.export.form import ENDINGS
from vgvt.signals import estimate_frf

KEYS = {"campaign", "format", "files", "sidecar", "runs", "remarks"}


def modes(vgvt, source: object) -> list[dict]:
    return vgvt("identify", source, "--json").document["modes"]


@pytest.mark.parametrize(
    ("name", "options", "accuracy"),
    [("x.uff", (), 0), ("x.unv", ("--text",), 1e-8), ("x.mat", (), 0), ("x.csv", (), 0)],
)
def test_the_modes_are_the_same_on_either_side(
    vgvt, campaign_file: Path, name: str, options: tuple[str, ...], accuracy: float
) -> None:
    document = vgvt("convert", campaign_file, f"out/{name}", *options, "--json").document
    assert set(document) == KEYS
    assert (document["campaign"], document["runs"], document["remarks"]) == ("example plate", [1, 2, 3], [])
    assert document["format"] == {".unv": "uff"}.get(Path(name).suffix, Path(name).suffix[1:])
    assert document["sidecar"] == "out/x.toml"
    assert sorted([*document["files"], "out/x.toml"]) == sorted(str(path) for path in Path("out").iterdir())
    for one, other in zip(modes(vgvt, campaign_file), modes(vgvt, "out/x.toml"), strict=True):
        for key in ("frequency_hz", "damping_ratio"):
            assert other[key] == pytest.approx(one[key], rel=accuracy, abs=0)


def test_a_sidecar_becomes_a_campaign_file(vgvt, campaign_file: Path, plate_campaign: Campaign) -> None:
    vgvt("convert", campaign_file, "x.uff")
    document = vgvt("convert", "x.toml", "back.nc", "--json").document
    assert (document["format"], document["files"], document["sidecar"]) == ("nc", ["back.nc"], None)
    back = open_campaign("back.nc")
    for one, other in zip(back.runs, plate_campaign.runs, strict=True):
        assert one.channels == other.channels
        np.testing.assert_array_equal(one.samples, other.samples)
    assert read_manifest("back.nc")["converted_from"] == "x.toml"


def test_a_copy_says_which_scenario_and_seed_it_is_of(vgvt, tmp_path: Path, plate_campaign: Campaign) -> None:
    write_campaign(tmp_path / "made.nc", plate_campaign, {"scenario": "plate", "seed": 7})
    vgvt("convert", "made.nc", "copy.nc")
    found = read_manifest("copy.nc")
    assert (found["scenario"], found["seed"], found["converted_from"]) == ("plate", 7, "made.nc")


def test_a_universal_file_describes_itself(vgvt, campaign_file: Path) -> None:
    vgvt("convert", campaign_file, "x.uff")
    Path("x.toml").unlink()
    assert vgvt("data", "describe", "x.uff", "--band", 3, 40, "--json").document["missing"] == []
    for one, other in zip(modes(vgvt, campaign_file), modes(vgvt, "x.toml"), strict=True):
        assert other["frequency_hz"] == pytest.approx(one["frequency_hz"], rel=1e-9)


def test_frequency_responses_are_those_of_the_estimator(vgvt, campaign_file: Path, plate_campaign: Campaign) -> None:
    document = vgvt("convert", campaign_file, "x.uff", "--frf", "--json").document
    assert (document["files"], document["sidecar"]) == (["x.uff"], None)
    frf = estimate_frf(plate_campaign, "auto", band_hz=plate_campaign.band_hz)
    functions = [one for one in pyuff.UFF("x.uff").read_sets() if one["type"] == 58 and one["func_type"] == 4]
    assert [(one["rsp_node"], one["ref_node"]) for one in functions] == [(node, 99) for node in range(1, 7)]
    for one, values in zip(functions, frf.values[:, 0], strict=True):
        np.testing.assert_array_equal(one["data"], values)
    vgvt("convert", campaign_file, "y.csv", "--frf", "--band", 5, 10)
    lines = np.loadtxt("y.csv", delimiter=",", skiprows=1)[:, 0]
    assert 5 <= lines.min() < lines.max() <= 10
    assert not Path("x.toml").exists() and not Path("y.toml").exists()


def test_what_an_estimate_leaves_out_is_said(vgvt, tmp_path: Path, plate_campaign: Campaign) -> None:
    first, *others = plate_campaign.runs
    samples = first.samples.copy()
    samples[1, 5] = np.nan
    write_campaign(tmp_path / "nan.nc", replace(plate_campaign, runs=(replace(first, samples=samples), *others)))
    result = vgvt("convert", "nan.nc", "x.mat", "--frf", "--json")
    assert any("run 1: a1 (1+Z) left out" in remark for remark in result.document["remarks"])
    assert "a1 (1+Z) left out" in vgvt("convert", "nan.nc", "y.mat", "--frf").err


def test_words_that_say_how_to_go_on(vgvt, campaign_file: Path) -> None:
    result = vgvt("convert", campaign_file, "x.mat")
    assert result.status == 0
    assert "wrote x-run1.mat, x-run2.mat, x-run3.mat" in result.out
    assert "vgvt inspect x.toml" in result.out


@pytest.mark.parametrize("there", ["x-run2.csv", "x.toml"])
def test_what_is_there_stays_until_it_may_go(vgvt, campaign_file: Path, there: str) -> None:
    Path(there).write_text("mine")
    result = vgvt("convert", campaign_file, "x.csv", "--json")
    assert result.status == 2
    assert result.document["error"]["where"] == there
    assert "--force" in result.document["error"]["advice"]
    assert {path.name for path in Path().iterdir()} == {there, campaign_file.name}
    assert Path(there).read_text() == "mine"
    assert vgvt("convert", campaign_file, "x.csv", "--force").status == 0
    assert Path(there).read_text() != "mine"


@pytest.mark.parametrize("options", [(), ("--force",)])
def test_two_formats_under_one_name_have_a_sidecar_each(vgvt, campaign_file: Path, options: tuple[str, ...]) -> None:
    """The second was refused, and with --force it took the first sidecar away, without which nothing reads x.uff."""
    names = {"x.uff": "x.toml", "x.mat": "x.mat.toml", "x.csv": "x.csv.toml", "x.unv": "x.unv.toml"}
    for name, sidecar in names.items():
        assert vgvt("convert", campaign_file, name, *options, "--json").document["sidecar"] == sidecar
    expected = modes(vgvt, campaign_file)
    for sidecar in names.values():
        assert [m["frequency_hz"] for m in modes(vgvt, sidecar)] == [m["frequency_hz"] for m in expected]


def test_a_sidecar_goes_with_its_own_records(vgvt, campaign_file: Path) -> None:
    """Replaced records need a new one, by the name that the old one has."""
    vgvt("convert", campaign_file, "x.mat")
    vgvt("convert", campaign_file, "x.csv")
    for name, sidecar in (("x.csv", "x.csv.toml"), ("x.mat", "x.toml")):
        refused = vgvt("convert", campaign_file, name, "--json")
        assert (refused.status, "--force" in refused.document["error"]["advice"]) == (2, True)
        assert vgvt("convert", campaign_file, name, "--force", "--json").document["sidecar"] == sidecar
    assert {path.name for path in Path().glob("*.toml")} == {"x.toml", "x.csv.toml"}


def test_what_is_read_is_never_replaced(vgvt, campaign_file: Path) -> None:
    vgvt("convert", campaign_file, "x.uff")
    before = Path("x.toml").read_text()
    assert vgvt("convert", "x.toml", "x.mat", "--force", "--json").document["sidecar"] == "x.mat.toml"
    result = vgvt("convert", "x.toml", "x.uff", "--force", "--json")
    assert result.status == 2
    assert "is what is read" in result.document["error"]["message"]
    assert Path("x.toml").read_text() == before
    assert open_campaign("x.toml").name == open_campaign("x.mat.toml").name


def test_records_that_a_sidecar_names_are_never_replaced(vgvt, campaign_file: Path) -> None:
    """Measured data may be nowhere else: --force had put frequency responses in their place."""
    vgvt("convert", campaign_file, "x.csv")
    Path("x.toml").rename("y.toml")
    before = Path("x-run2.csv").read_bytes()
    for name, options in (("x.csv", ()), ("x-run2.csv", ("--frf",))):
        result = vgvt("convert", "y.toml", name, "--force", *options, "--json")
        assert result.status == 2
        assert "is what is read" in result.document["error"]["message"]
    assert Path("x-run2.csv").read_bytes() == before


def test_the_campaign_of_a_run_folder_is_never_replaced(vgvt, campaign_file: Path) -> None:
    """It says which scenario and seed it came from, which a converted one does not."""
    Path("runs").mkdir()
    campaign_file.rename("runs/campaign.nc")
    result = vgvt("convert", "runs", "runs/campaign.nc", "--force", "--json")
    assert result.status == 2
    assert result.document["error"]["where"] == "runs/campaign.nc"
    assert "converted_from" not in read_manifest("runs/campaign.nc")


def test_a_scenario_is_never_replaced_by_a_sidecar(vgvt, campaign_file: Path) -> None:
    """Of my-wing.toml the run is runs/my-wing, and its records are soon called my-wing.uff."""
    Path("my-wing.toml").write_text('extends = "quick"\nname = "my-wing"\n')
    for options in ((), ("--force",)):
        result = vgvt("convert", campaign_file, "my-wing.uff", *options, "--json")
        assert result.status == 2
        assert result.document["error"]["message"].startswith("my-wing.toml: is a scenario")
        assert "--force" not in result.document["error"]["advice"]
    assert Path("my-wing.toml").read_text().startswith("extends")
    assert vgvt("convert", campaign_file, "my-wing.uff", "--frf").status == 0


def test_the_how_to_asks_for_nothing_that_is_refused(vgvt, campaign_file: Path) -> None:
    """Its commands one after the other, with a campaign in place of the simulated and of the measured one."""
    document = Path(__file__).resolve().parents[2] / "docs" / "how-to" / "convert.md"
    lines = [line[7:].split() for line in document.read_text(encoding="utf-8").splitlines() if line[:7] == "$ vgvt "]
    assert len([line for line in lines if line[0] == "convert"]) >= 5
    vgvt("convert", campaign_file, "my-test.uff")
    Path("runs/quick").mkdir(parents=True)
    campaign_file.rename("runs/quick/campaign.nc")
    for line in lines:
        assert vgvt(*line).status == 0, line


def test_how_to_and_help_name_every_ending(vgvt) -> None:
    document = Path(__file__).resolve().parents[2] / "docs" / "how-to" / "convert.md"
    table = [
        line.split("|")[1] for line in document.read_text(encoding="utf-8").splitlines() if line.startswith("| `.")
    ]
    helped = vgvt("convert", "--help").out
    for ending in ENDINGS:
        assert any(f"`{ending}`" in cell for cell in table), ending
        assert ending in helped


def test_a_folder_is_not_left_behind(vgvt, campaign_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vgvt.files.export.matlab._LARGEST_BYTES", 1000)
    assert vgvt("convert", campaign_file, "new/place/x.mat").status == 2
    assert [path.name for path in Path().iterdir()] == [campaign_file.name]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("plate.nc", "new/x.xls"), "no format ends in '.xls'"),
        (("plate.nc", "new/x.mat", "--text"), "--text: x.mat is no Universal File"),
        (("plate.nc", "new/x.uff", "--band", 3, 9), "--band: only frequency responses have one"),
        (("plate.nc", "new/x.nc", "--frf"), "a campaign file holds time histories alone"),
        (("plate.nc", "new/x.uff", "--frf", "--band", 9, 3), "fewer than two frequency lines in 9 to 3 Hz"),
        (("missing.nc", "new/x.uff"), "missing.nc: no such file or folder"),
        (("cut.nc", "new/x.uff"), "cut.nc: damaged"),
        (("plate.nc", "plate.nc/x.uff"), "plate.nc/x.toml: cannot be written"),
        (("plate.nc",), "Missing argument 'FILE'"),
    ],
)
def test_bad_input_is_told_and_nothing_is_written(vgvt, campaign_file: Path, arguments: tuple, words: str) -> None:
    Path("cut.nc").write_bytes(campaign_file.read_bytes()[:5000])
    result = vgvt("convert", *arguments, "--json")
    assert result.status == 2
    assert words in result.document["error"]["message"]
    assert {path.name for path in Path().iterdir()} == {"plate.nc", "cut.nc"}
