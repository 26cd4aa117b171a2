"""Every command: one JSON object on stdout, the keys of the contract, exit statuses, no traceback."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from vgvt.data import Campaign
from vgvt.files import write_campaign

DOCUMENTS = [
    (("list", "scenarios"), ("items",)),
    (("list", "identifiers"), ("items",)),
    (("list", "effects"), ("items",)),
    (("data", "list"), ("items",)),
    (("data", "where"), ("searched", "fetched_into", "variable")),
    (("schema",), ("$schema", "$defs", "properties")),
    (("cite",), ("entries",)),
]


@pytest.mark.parametrize(("arguments", "keys"), DOCUMENTS, ids=lambda value: " ".join(value))
def test_one_object_with_its_keys(vgvt, arguments: tuple[str, ...], keys: tuple[str, ...]) -> None:
    result = vgvt(*arguments, "--json")
    assert result.status == 0
    assert set(keys) <= set(result.document)


@pytest.mark.parametrize("arguments", [a for a, _ in DOCUMENTS] + [("--help",), ("--version",), ()], ids=" ".join)
def test_words_for_people(vgvt, arguments: tuple[str, ...]) -> None:
    result = vgvt(*arguments)
    assert result.status == 0
    assert result.out.strip()


def test_items_have_a_name_and_a_sentence(vgvt) -> None:
    for what in ("scenarios", "identifiers"):
        items = vgvt("list", what, "--json").document["items"]
        assert items
        for item in items:
            assert item["name"]
            assert item["summary"]
    assert "quick" in {item["name"] for item in vgvt("list", "scenarios", "--json").document["items"]}
    assert "quadrature" in {item["name"] for item in vgvt("list", "identifiers", "--json").document["items"]}


def test_inspect(vgvt, campaign_file: Path) -> None:
    document = vgvt("inspect", campaign_file, "--json").document
    assert [run["run"] for run in document["runs"]] == [1, 2, 3]
    assert document["references"] == ["99+Z"]
    force = document["runs"][0]["channels"][0]
    assert (force["quantity"], force["unit"], force["overloaded"]) == ("excitation_force", "N", False)
    assert 0 < force["rms"] <= force["peak"] <= 2.0 + 1e-12  # the plate is driven with 2 N
    assert "99+Z" in vgvt("inspect", campaign_file).out


def test_inspect_says_at_which_instrument_a_channel_ended(vgvt, tmp_path: Path, plate_campaign: Campaign) -> None:
    first, *others = plate_campaign.runs
    note = f"{first.channels[0].name}: reached the force transducer's ±44.5 N"
    marked = replace(first, overloaded=(first.channels[0].name,), notes=(note,))
    write_campaign(tmp_path / "marked.nc", replace(plate_campaign, runs=(marked, *others)))
    assert f"run {first.run}: {note}" in vgvt("inspect", tmp_path / "marked.nc").out


def test_identify(vgvt, campaign_file: Path) -> None:
    result = vgvt("identify", campaign_file, "--identifier", "quadrature", "--band", 5, 10, "--json")
    assert result.status == 0
    document = result.document
    assert document["identifier"] == "quadrature"
    assert document["band_hz"] == [5.0, 10.0]
    assert document["outcome"] == "found"
    (mode,) = document["modes"]
    assert mode["frequency_hz"] == pytest.approx(6.3, rel=1e-3)
    assert {point["dof"] for point in mode["shape"]} == {f"{node}+Z" for node in range(1, 7)}
    assert "6.3" in vgvt("identify", campaign_file).out


def test_identify_finds_nothing_where_there_is_nothing(vgvt, campaign_file: Path) -> None:
    result = vgvt("identify", campaign_file, "--band", 8, 11, "--json")
    assert result.status == 0
    assert result.document["modes"] == []
    assert result.document["outcome"] == "nothing_found"
    assert result.document["advice"]


def test_settings_reach_the_identifier(vgvt, campaign_file: Path) -> None:
    items = vgvt("list", "identifiers", "--json").document["items"]
    settings = next(item["settings"] for item in items if item["name"] == "quadrature")
    key = next(s for s in settings if s["type"] == "float")["name"]
    chosen = ("--identifier", "quadrature", "--setting", f"{key}=3.5")
    document = vgvt("identify", campaign_file, *chosen, "--json").document
    assert float(document["settings"][key]) == 3.5


def test_score_of_a_perfect_claim_is_perfect(vgvt, simulations) -> None:
    vgvt("simulate", "quick", "--out", "here")
    truth = vgvt("simulate", "quick", "--out", "here", "--json").document["truth"]["as_tested"]
    for mode in truth:
        mode["shape"] = [point for point in mode["shape"] if point["dof"] != "99+Z"]
    Path("claim.json").write_text(json.dumps({"identifier": "oracle", "band_hz": [3.0, 40.0], "modes": truth}))
    document = vgvt("score", "claim.json", "here/sealed/truth.nc", "--json").document
    assert (document["missed"], document["false"], document["summary"]["found"]) == (0, 0, 2)
    for row in document["modes"]:
        assert row["frequency_error_percent"] == pytest.approx(0, abs=1e-9)
        assert row["damping_error_percent"] == pytest.approx(0, abs=1e-9)
        assert row["mac"] == pytest.approx(1, abs=1e-9)
    assert vgvt("score", "claim.json", "here/sealed/truth.nc").status == 0


def test_cite_names_what_a_run_used(vgvt, simulations) -> None:
    vgvt("run", "quick", "--no-report")
    keys = {entry["key"] for entry in vgvt("cite", "runs/quick", "--json").document["entries"]}
    assert {"vgvt", "todorov2012mujoco"} <= keys
    assert keys == {entry["key"] for entry in vgvt("cite", "auto", "--json").document["entries"]}


def test_doctor(vgvt) -> None:
    result = vgvt("doctor", "--json")
    document = result.document
    checks = {check["check"]: check for check in document["checks"]}
    assert {"python", "packages", "threads", "physics", "rendering", "scenarios", "identifiers", "writing"} <= set(
        checks
    )
    assert all(check["status"] in ("ok", "warn", "fail") for check in checks.values())
    assert all(check["advice"] for check in checks.values() if check["status"] == "warn")
    assert result.status == (1 if document["status"] == "fail" else 0)
    assert checks["physics"]["status"] == "ok"


def test_doctor_fails_when_a_check_breaks(vgvt, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vgvt.cli.doctor._in_process", lambda *_: "no such library")
    result = vgvt("doctor", "--json")
    assert result.status == 1
    status = {check["check"]: check["status"] for check in result.document["checks"]}
    assert (status["physics"], status["rendering"]) == ("fail", "warn")


def test_an_unexpected_failure_is_one_line(vgvt, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("first line\nsecond line")

    monkeypatch.setattr("vgvt.simulation.simulate", broken)
    result = vgvt("run", "quick", "--json")
    assert result.status == 1
    assert result.document["error"]["kind"] == "failure"
    assert "ZeroDivisionError: first line" in result.err
    assert "VGVT_TRACEBACK=1" in result.err
    assert "second line" not in result.err
    assert not Path("runs/quick").exists()


def test_a_diverged_simulation_is_a_failure_with_advice(vgvt, monkeypatch: pytest.MonkeyPatch) -> None:
    def diverged(*_: object, **__: object) -> None:
        raise FloatingPointError("the simulation diverged at 0.30 s")

    monkeypatch.setattr("vgvt.simulation.simulate", diverged)
    result = vgvt("run", "quick", "--json")
    assert result.status == 1
    assert result.document["error"]["problem"] == "the simulation diverged at 0.30 s"
    assert "VGVT_TRACEBACK" not in result.err
    assert not Path("runs/quick").exists()


def test_the_traceback_can_be_had(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from vgvt.cli import main

    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError

    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("VGVT_TRACEBACK", "1")
    monkeypatch.setattr("vgvt.simulation.simulate", broken)
    with pytest.raises(ZeroDivisionError):
        main(["run", "quick"])


def test_a_failed_download_is_a_failure_with_advice(vgvt, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from vgvt.files.fetch import DownloadError

    def offline(*_: object) -> Path:
        raise DownloadError("the connection failed")

    monkeypatch.setattr("vgvt.files.fetch.fetch_measured", offline)
    result = vgvt("data", "get", "--json")
    assert result.status == 1
    assert "connection failed" in result.document["error"]["problem"]
    assert result.document["error"]["advice"]


def test_a_warning_is_a_line(vgvt, monkeypatch: pytest.MonkeyPatch) -> None:
    import warnings

    def warned() -> tuple[str, ...]:
        warnings.warn("something is odd", UserWarning, stacklevel=1)
        return ()

    monkeypatch.setattr("vgvt.scenario.bundled_scenarios", warned)
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        result = vgvt("list", "scenarios", "--json")
    assert result.document == {"items": []}
    assert result.err.strip() == "vgvt: warning: something is odd"


def test_defaults_of_settings_are_numbers_where_they_are_numeric(vgvt) -> None:
    items = {item["name"]: item for item in vgvt("list", "identifiers", "--json").document["items"]}
    assert all("setting" not in item for item in items.values())
    defaults = {setting["name"]: setting["default"] for setting in items["quadrature"]["settings"]}
    assert isinstance(defaults["prominence_db"], float | int)


def test_an_empty_mat_file_is_called_empty(tmp_path: Path) -> None:
    from vgvt.data import InputError
    from vgvt.files.mat import read_mat

    path = tmp_path / "empty.mat"
    path.touch()
    with pytest.raises(InputError, match="empty"):
        read_mat(path, ["x"])
