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
