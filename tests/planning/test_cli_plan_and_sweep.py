"""``vgvt plan`` and ``vgvt sweep`` at the shell: files, JSON contract, exit statuses."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree

import pytest

from vgvt.bench.table import read_table
from vgvt.cli.boundary import run_command
from vgvt.scenario import load_scenario
from vgvt.simulation.attitude import attitudes_deg


def test_a_plan_is_written_and_can_be_run(tmp_path, capsys) -> None:
    out = tmp_path / "plan"
    arguments = ["plan", "quick", "--free", "level,sweep-time", "--minutes", "8", "--max-volts", "3", "--seeds", "0"]
    assert run_command([*arguments, "--out", str(out), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["verdict"] == "better"
    assert document["gain"] > 3
    assert document["budget"]["minutes"] == 8
    best = document["plans"][0]
    assert best["minutes"] <= 8
    assert best["excitation"]["amplitude_v"] == 3
    assert {"label", "frequency_std_hz", "damping_ratio_std", "loading_percent"} <= set(best["modes"][0])
    planned = load_scenario(out / "plan.toml")
    assert planned.excitation.duration_s == best["excitation"]["duration_s"]
    drawing = ElementTree.fromstring((out / "plan.svg").read_text(encoding="utf-8"))
    texts = {element.text for element in drawing.iter("{http://www.w3.org/2000/svg}text")}
    assert {str(node) for node in planned.acquisition.runs[0]} <= texts
    card = (out / "card.html").read_text(encoding="utf-8")
    assert "25.0 in aft, 4.5 in right (0.635 m, 0.114 m)" in card
    roll, pitch = attitudes_deg(planned)[0]
    assert document["hangs_at_roll_pitch_deg"] == [pytest.approx([roll, pitch])]
    # The transducer hangs on the right wing, and the nose is light.
    assert f"right wing down by {-roll:.1f}° and nose up by {pitch:.1f}°" in card
    assert "http" not in card.replace("http://www.w3.org/2000/svg", "").replace("http-equiv", "")


def test_nothing_to_gain_is_said_and_nothing_written(tmp_path, capsys) -> None:
    out = tmp_path / "plan"
    assert run_command(["plan", "quick", "--free", "level", "--seeds", "0", "--out", str(out)]) == 0
    assert "Nothing to gain" in capsys.readouterr().out
    assert not out.exists()


def test_a_sweep_is_a_table_with_the_keys_in_front(tmp_path, capsys) -> None:
    arguments = ["sweep", "quick", "--set", "excitation.duration_s=6,8", "--workers", "0", "--out", str(tmp_path)]
    assert run_command([*arguments, "--csv", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [v["values"] for v in document["variants"]] == [{"excitation.duration_s": d} for d in (6, 8)]
    assert document["rows"] == 6
    assert [row["excitation.duration_s"] for row in document["summary"]] == [6, 8]
    tables = [read_table(tmp_path / f"sweep.{ending}") for ending in ("parquet", "csv")]
    for table in tables:
        assert list(table.columns[:2]) == ["scenario", "excitation.duration_s"]
        assert table["excitation.duration_s"].tolist() == [6] * 3 + [8] * 3
    done = {path: path.stat().st_mtime_ns for path in (tmp_path / "cells").iterdir()}
    assert run_command([*arguments, "--json"]) == 0
    assert {path: path.stat().st_mtime_ns for path in (tmp_path / "cells").iterdir()} == done
    assert json.loads(capsys.readouterr().out)["summary"] == document["summary"]


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["plan", "quick", "--free", "shakr"], "shaker"),
        (["plan", "quick", "--modes", "eight"], "8.2,15.8"),
        (["plan", "quick", "--identifier", "quadratur"], "quadrature"),
        (["plan", "quick", "--identifier", "informd"], "did you mean 'informed'?"),
        (["plan", "quikc"], "quick"),
        (["plan", "quick", "--free", "level", "--max-volts", "2", "--minutes", "1"], "vgvt: --minutes: is 1,"),
        (["plan", "quick", "--free", "sweep-time", "--sensors", "2"], "add sensors to --free"),
        (["sweep", "quick", "--set", "excitation.durations=1"], "excitation.duration_s"),
        (["sweep", "quick", "--set", "excitation.duration_s=8", "--design", "cube"], "latin"),
        (["sweep", "quick", "--set", "excitation.duration_s"], "KEY=values"),
        (["sweep", "quick", "--set", "excitation.duration_s=1..5"], "low..high:count"),
    ],
)
def test_bad_input_says_what_to_write(arguments, word, capsys, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert run_command(arguments) == 2
    assert word in capsys.readouterr().err


@pytest.mark.parametrize(
    ("option", "value", "said"),
    [
        ("--minutes", "inf", "has no end"), ("--setup-minutes", "inf", "has no end"), ("--max-volts", "inf", "no end"),
        ("--minutes", "1e6", "8 GB of samples"), ("--seeds", "1", "no scatter"), ("--modes", "nan", "no frequencies"),
        ("--modes", ",", "no frequencies"), ("--modes", "-8", "no frequencies"),
    ],
)  # fmt: skip
def test_what_cannot_be_planned_is_told_by_its_option(tmp_path, capsys, option, value, said) -> None:
    """Without end, too large for any campaign, of no use, or no number: at once, and nothing is written."""
    arguments = ["plan", "quick", "--free", "sensors", "--minutes", "6", "--seeds", "0", option, value]
    assert run_command([*arguments, "--out", str(tmp_path / "plan")]) == 2
    told = " ".join(capsys.readouterr().err.split())
    assert option in told and said in told
    assert not (tmp_path / "plan").exists()


def test_more_accelerometers_than_places_are_as_many_as_there_are_places(tmp_path) -> None:
    arguments = ["plan", "quick", "--free", "sensors", "--minutes", "6", "--seeds", "0", "--sensors", "500"]
    assert run_command([*arguments, "--out", str(tmp_path / "plan")]) == 0


def test_an_earlier_plan_is_kept_or_told_of(tmp_path, capsys) -> None:
    """One that somebody has edited is not lost, and one of another order does not pass for the answer to this one."""
    out = tmp_path / "plan"
    better = [
        "plan",
        "quick",
        "--free",
        "level",
        "--minutes",
        "8",
        "--max-volts",
        "3",
        "--seeds",
        "0",
        "--out",
        str(out),
    ]
    assert run_command(better) == 0
    written = (out / "plan.toml").read_text(encoding="utf-8")
    assert run_command(better) == 0
    assert sorted(p.name for p in out.iterdir()) == ["card.html", "plan.svg", "plan.toml"]
    for _ in range(2):
        (out / "plan.toml").write_text("# mine\n" + written, encoding="utf-8")
        assert run_command(better) == 0
    assert (out / "plan-earlier.toml").read_text(encoding="utf-8").startswith("# mine")
    assert (out / "plan-earlier-2.toml").exists() and (out / "plan.toml").read_text(encoding="utf-8") == written
    capsys.readouterr()
    assert run_command(["plan", "quick", "--free", "level", "--seeds", "0", "--out", str(out)]) == 0
    said = capsys.readouterr()
    assert "of an earlier plan" in " ".join(said.err.split())
