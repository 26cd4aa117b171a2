"""``vgvt bench`` at the shell: files, JSON contract, exit statuses."""

from __future__ import annotations

import json

import pytest

from vgvt.cli.boundary import run_command


@pytest.fixture(scope="module")
def benched(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bench")
    arguments = ["bench", "quick", "--identifier", "quadrature", "--seeds", "2", "--workers", "0", "--out", str(folder)]
    return folder, arguments


def test_it_writes_the_table_and_the_page_and_says_so(benched, capsys) -> None:
    folder, arguments = benched
    assert run_command([*arguments, "--csv", "--baseline", str(folder / "base.csv"), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["rows"] == 6
    assert document["failures"] == []
    assert document["summary"][0]["found"] == 3
    for name in ("bench.parquet", "bench.csv", "scoreboard.html", "base.csv"):
        assert (folder / name).is_file()


def test_against_its_own_baseline_nothing_changed(benched, capsys) -> None:
    folder, arguments = benched
    assert run_command([*arguments, "--against", str(folder / "base.csv"), "--no-page"]) == 0
    assert "0 worse, 0 better" in capsys.readouterr().out


def test_a_regression_ends_with_status_one(benched, capsys) -> None:
    folder, arguments = benched
    lines = (folder / "base.csv").read_text().splitlines()
    at = lines[0].split(",").index("frequency_error_percent")
    fields = [line.split(",") for line in lines[1:]]
    for line in fields:
        line[at] = f"{float(line[at]) / 100:.6g}"
    (folder / "better.csv").write_text("\n".join([lines[0], *(",".join(line) for line in fields)]) + "\n")
    assert run_command([*arguments, "--against", str(folder / "better.csv"), "--no-page", "--json"]) == 1
    document = json.loads(capsys.readouterr().out)
    worse = [row for row in document["against"] if row["verdict"] == "worse"]
    assert [row["measure"] for row in worse] == ["frequency_error_percent"]


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["bench", "quikc"], "quick"),
        (["bench", "quick", "--identifier", "quadratur"], "quadrature"),
        (["bench", "quick", "--identifier", "quadrature:prominence"], "key=value"),
        (["bench", "quick", "--engine", "warp"], "linear"),
        (["bench", "quick", "teaching-beam", "quick"], "2 scenarios of this bench are called so"),
        (["bench", "quick", "--against", "none.csv"], "no such baseline"),
        (["bench", "quick", "--cluster", "somewhere"], "tcp://"),
    ],
)
def test_bad_input_says_what_to_write(arguments, word, capsys, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert run_command(arguments) == 2
    assert word in capsys.readouterr().err
