"""``vgvt run`` and its parts on a campaign with a known answer: contract, folder, resume, refuse."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

MODE_KEYS = {"frequency_hz", "frequency_std_hz", "damping_ratio", "damping_ratio_std", "shape", "label", "flags"}
SCORE_KEYS = {
    "true_hz",
    "claimed_hz",
    "frequency_error_percent",
    "true_damping_ratio",
    "damping_error_percent",
    "mac",
    "status",
}
FILES = {
    "scenario.toml",
    "campaign.nc",
    "sealed/truth.nc",
    "claims/auto.json",
    "scorecards/auto.json",
    "report.html",
    "manifest.json",
}


def files_in(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def interrupted(*_: object, **__: object) -> None:
    raise KeyboardInterrupt


def test_run_keeps_the_contract(vgvt, simulations) -> None:
    result = vgvt("run", "quick", "--json")
    assert result.status == 0
    document = result.document
    assert {"scenario", "folder", "truth", "identifiers", "timing_s"} <= set(document)
    assert document["scenario"] == "quick"
    assert set(document["truth"]) == {"bare", "as_tested"}
    for mode in (*document["truth"]["bare"], *document["truth"]["as_tested"]):
        assert set(mode) >= MODE_KEYS
        assert set(mode["shape"][0]) == {"dof", "real", "imag"}
    card = document["identifiers"]["auto"]
    assert {"modes", "missed", "false", "summary"} <= set(card)
    assert all(set(row) >= SCORE_KEYS and row["status"] in ("found", "missed", "false") for row in card["modes"])
    assert all(value >= 0 for value in document["timing_s"].values())


def test_the_contract_s_page_lists_every_key(vgvt, simulations) -> None:
    page = (Path(__file__).parents[2] / "docs/reference/json-contract.md").read_text(encoding="utf-8")
    rows = {row.split(" | ")[0]: row.split(" | ", 1)[1] for row in page.splitlines() if row.startswith("| `vgvt ")}
    keys = re.findall(r"`(\w+)`", re.sub(r"\([^()]*\)", "", rows["| `vgvt run`"]))
    assert set(vgvt("run", "quick", "--json").document) == set(keys)
    assert "the first eight of these and `timing_s`" in rows["| `vgvt simulate`"]
    assert set(vgvt("simulate", "quick", "--json").document) == {*keys[:8], "timing_s"}


def test_run_finds_the_plate_and_writes_the_whole_folder(vgvt, simulations) -> None:
    result = vgvt("run", "quick")
    assert result.status == 0
    folder = Path("runs/quick")
    assert files_in(folder) == FILES
    assert "2 found, 0 missed, 0 false" in result.out
    card = json.loads((folder / "scorecards/auto.json").read_text())
    assert [row["status"] for row in card["modes"]] == ["found", "found"]
    for row in card["modes"]:
        assert abs(row["frequency_error_percent"]) < 0.1
        assert row["mac"] > 0.99
    from vgvt.files import check_manifest

    assert check_manifest(folder) == ()


def test_the_resolved_scenario_is_the_scenario(vgvt, simulations) -> None:
    from vgvt.scenario import load_scenario

    assert vgvt("run", "quick", "--seed", 7, "--engine", "linear", "--no-report", "--out", "here").status == 0
    again = load_scenario(Path("here/scenario.toml"))
    assert again.seed == 7
    assert again.simulation.engine == "linear"
    assert again.airframe == load_scenario("quick").airframe


def test_same_scenario_resumes(vgvt, simulations) -> None:
    first = vgvt("run", "quick", "--no-report", "--json").document
    second = vgvt("run", "quick", "--no-report", "--json").document
    assert simulations == ["quick"]
    assert (first["resumed"], second["resumed"]) == (False, True)
    assert first["identifiers"] == second["identifiers"]


def test_resume_simulates_again_when_the_campaign_was_damaged(vgvt, simulations) -> None:
    vgvt("run", "quick", "--no-report")
    campaign = Path("runs/quick/campaign.nc")
    campaign.write_bytes(campaign.read_bytes()[:1000])
    assert vgvt("run", "quick", "--no-report").status == 0
    assert simulations == ["quick", "quick"]


def test_another_scenario_is_refused_unless_forced(vgvt, simulations) -> None:
    assert vgvt("run", "quick", "--no-report", "--out", "here").status == 0
    before = Path("here/campaign.nc").read_bytes()
    refused = vgvt("run", "quick", "--no-report", "--out", "here", "--seed", 5)
    assert refused.status == 2
    assert "another scenario" in refused.err
    assert "--force" in refused.err
    assert Path("here/campaign.nc").read_bytes() == before
    assert vgvt("run", "quick", "--no-report", "--out", "here", "--seed", 5, "--force").status == 0
    assert simulations == ["quick", "quick"]


def test_force_leaves_no_claim_about_the_campaign_before(vgvt, simulations) -> None:
    vgvt("run", "quick", "--no-report", "--out", "here")
    assert vgvt("simulate", "quick", "--out", "here", "--seed", 5, "--force").status == 0
    assert files_in(Path("here")) == {"scenario.toml", "campaign.nc", "sealed/truth.nc", "manifest.json"}


def test_default_folders_do_not_collide(vgvt, simulations) -> None:
    folders = {
        vgvt("simulate", "quick", *options, "--json").document["folder"]
        for options in ((), ("--seed", 5), ("--engine", "linear"))
    }
    assert folders == {str(Path("runs") / name) for name in ("quick", "quick-seed5", "quick-linear")}


def test_a_folder_with_other_things_in_it_is_refused(vgvt, simulations) -> None:
    Path("here").mkdir()
    Path("here/thesis.txt").write_text("precious")
    result = vgvt("run", "quick", "--out", "here")
    assert result.status == 2
    assert "not empty" in result.err
    assert files_in(Path("here")) == {"thesis.txt"}
    assert simulations == []


def test_a_run_whose_manifest_is_lost_is_told_of_it(vgvt, simulations) -> None:
    vgvt("run", "quick", "--no-report", "--out", "here")
    Path("here/manifest.json").unlink()
    result = vgvt("run", "quick", "--no-report", "--out", "here")
    assert result.status == 2
    assert "manifest.json: is missing beside campaign.nc, scenario.toml, sealed" in result.err
    assert "put it back" in result.err
    assert "--force" in result.err
    assert "holds no run" not in result.err
    assert vgvt("run", "quick", "--no-report", "--out", "here", "--force").status == 0
    assert vgvt("run", "quick", "--no-report", "--out", "here").status == 0


def test_a_file_in_the_way_is_refused(vgvt, simulations) -> None:
    Path("here").write_text("precious")
    result = vgvt("run", "quick", "--out", "here")
    assert result.status == 2
    assert Path("here").read_text() == "precious"


def test_a_misspelt_identifier_costs_no_simulation(vgvt, simulations) -> None:
    result = vgvt("run", "quick", "--identifier", "quadratur")
    assert result.status == 2
    assert "'quadrature'" in result.err
    assert simulations == []


def test_an_interrupt_keeps_nothing_half_done(vgvt, monkeypatch) -> None:
    monkeypatch.setattr("vgvt.simulation.simulate", interrupted)
    result = vgvt("run", "quick", "--json")
    assert result.status == 130
    assert result.document["error"]["kind"] == "interrupted"
    assert "nothing was kept" in result.err
    assert not Path("runs/quick").exists()


def test_an_interrupt_takes_back_every_folder_that_was_made_on_the_way(vgvt, monkeypatch) -> None:
    monkeypatch.setattr("vgvt.simulation.simulate", interrupted)
    Path("mine").mkdir()
    for place in ("new/and/deep", "mine/new"):
        assert vgvt("run", "quick", "--out", place).status == 130
    assert [path.name for path in Path().rglob("*")] == ["mine"]


def test_an_interrupt_after_the_simulation_keeps_the_campaign(vgvt, simulations, monkeypatch) -> None:
    with monkeypatch.context() as patch:
        patch.setattr("vgvt.view.write_report", interrupted)
        result = vgvt("run", "quick")
    assert result.status == 130
    assert "kept in" in result.err
    assert vgvt("run", "quick").status == 0
    assert simulations == ["quick"]


def test_simulate_then_identify_then_score(vgvt, simulations) -> None:
    document = vgvt("simulate", "quick", "--json").document
    assert {"scenario", "folder", "truth", "timing_s"} <= set(document)
    claim = vgvt("identify", document["folder"], "--identifier", "quadrature", "--out", "claim.json", "--json")
    assert claim.status == 0
    assert set(claim.document) >= {"identifier", "band_hz", "outcome", "modes"}
    assert json.loads(Path("claim.json").read_text()) == claim.document
    card = vgvt("score", "claim.json", Path(document["folder"]) / "sealed/truth.nc", "--json")
    assert card.status == 0
    assert card.document["summary"]["found"] == 2


def test_score_of_a_run_folder_is_the_score_of_the_run(vgvt, simulations) -> None:
    ran = vgvt("run", "quick", "--no-report", "--json").document["identifiers"]["auto"]
    scored = vgvt("score", "runs/quick", "--json").document
    assert [row["status"] for row in scored["modes"]] == [row["status"] for row in ran["modes"]]
    for ours, theirs in zip(scored["modes"], ran["modes"], strict=True):
        assert ours["claimed_hz"] == pytest.approx(theirs["claimed_hz"], rel=1e-12)
        assert ours["mac"] == pytest.approx(theirs["mac"], abs=1e-12)
    assert vgvt("score", "runs/quick/claims/auto.json").status == 0


def contents(folder: Path) -> dict[str, bytes]:
    return {name: (folder / name).read_bytes() for name in files_in(folder)}


def full_disk(*_: object) -> object:
    from collections import namedtuple

    return namedtuple("Usage", "total used free")(1 << 20, 1 << 20, 0)


def test_an_interrupt_while_writing_leaves_the_old_run_whole(vgvt, simulations, monkeypatch) -> None:
    vgvt("run", "quick", "--no-report", "--out", "here")
    before = contents(Path("here"))
    with monkeypatch.context() as patch:
        patch.setattr("vgvt.files.write_campaign", interrupted)
        result = vgvt("run", "quick", "--no-report", "--out", "here", "--seed", 5, "--force")
    assert result.status == 130
    assert "stopped while writing; here is as it was" in result.err
    assert contents(Path("here")) == before
    assert vgvt("run", "quick", "--no-report", "--out", "here").status == 0
    assert simulations == ["quick", "quick"]


def test_a_swap_stopped_half_way_is_never_taken_for_a_run(vgvt, simulations, monkeypatch) -> None:
    vgvt("run", "quick", "--no-report", "--out", "here")
    rename = Path.replace

    def stop_at_campaign(self: Path, target: Path) -> Path:
        if self.parent.name.endswith(".part") and self.name == "campaign.nc":
            raise KeyboardInterrupt
        return rename(self, target)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", stop_at_campaign)
        result = vgvt("run", "quick", "--no-report", "--out", "here", "--seed", 5, "--force")
    assert result.status == 1
    assert "as it was" not in result.err
    assert "--force" in result.err
    assert vgvt("run", "quick", "--no-report", "--out", "here").status == 2


def test_a_full_disk_is_said_before_anything_is_written(vgvt, simulations, monkeypatch) -> None:
    monkeypatch.setattr("shutil.disk_usage", full_disk)
    result = vgvt("run", "quick")
    assert result.status == 1
    assert "disk is full" in result.err
    assert "--out" in result.err
    assert "stopped while writing; nothing was kept" in result.err
    assert not Path("runs/quick").exists()


def test_settings_reach_the_identifier_they_name(vgvt, simulations) -> None:
    used = ("run", "quick", "--no-report", "--out", "here")
    assert vgvt(*used, "--setting", "auto.false_alarm=0.01").status == 0
    manifest = json.loads(Path("here/manifest.json").read_text())
    assert float(manifest["identifiers"]["auto"]["false_alarm"]) == 0.01
    refused = vgvt(*used, "--setting", "other.false_alarm=0.01")
    assert refused.status == 2
    assert "'other'" in refused.err


def test_overloads_are_said(vgvt, simulations, monkeypatch) -> None:
    import vgvt.simulation as simulation

    whole = simulation.simulate

    def clipped(*arguments: object, **options: object) -> simulation.SimulationResult:
        result = whole(*arguments, **options)
        first = result.campaign.runs[0]
        name = first.channels[0].name
        marked = replace(first, overloaded=(name,), notes=(f"{name}: reached its end",))
        runs = (marked, *result.campaign.runs[1:])
        return replace(result, campaign=replace(result.campaign, runs=runs))

    monkeypatch.setattr(simulation, "simulate", clipped)
    result = vgvt("run", "quick", "--no-report", "--json")
    ((run, channels),) = result.document["overloaded"].items()
    assert f"run {run}: {channels[0]} overloaded ({channels[0]}: reached its end)" in result.err


def test_a_resumed_run_keeps_no_old_simulation_time(vgvt, simulations) -> None:
    vgvt("run", "quick", "--no-report")
    assert "simulate" in json.loads(Path("runs/quick/manifest.json").read_text())["timing_s"]
    vgvt("run", "quick", "--no-report")
    assert "simulate" not in json.loads(Path("runs/quick/manifest.json").read_text())["timing_s"]


def test_a_folder_given_as_truth_is_called_a_folder(vgvt, simulations) -> None:
    vgvt("run", "quick", "--no-report")
    result = vgvt("score", "runs/quick", "runs/quick")
    assert result.status == 2
    assert "folder" in result.err
    assert "sealed" in result.err


def test_identify_writes_the_page_of_a_campaign_without_truth(vgvt, campaign_file) -> None:
    assert vgvt("identify", campaign_file, "--report", "page.html").status == 0
    assert "</html>" in Path("page.html").read_text(encoding="utf-8")


def test_every_mode_with_a_sigma_peak_states_it_as_a_number(vgvt, campaign_file) -> None:
    modes = vgvt("identify", campaign_file, "--identifier", "quadrature", "--json").document["modes"]
    assert modes
    for mode in modes:
        flag = next(flag for flag in mode["flags"] if flag.startswith("sigma_peak_hz="))
        assert mode["sigma_peak_hz"] == float(flag.partition("=")[2])
