"""Streams that are closed, full or pipes, and a home folder that no shell has put in place."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from vgvt.cli.boundary import run_command
from vgvt.files import read_campaign

needs_full = pytest.mark.skipif(not Path("/dev/full").exists(), reason="no disk that is always full")
posix = pytest.mark.skipif(os.name != "posix", reason="a shell that closes streams")


def in_a_shell(line: str) -> subprocess.CompletedProcess[str]:
    """A command line of vgvt in a shell, with what is left of its streams."""
    words = f"{sys.executable} -m vgvt {line}"
    return subprocess.run(["sh", "-c", words], capture_output=True, text=True, timeout=60, check=False)


@posix
@pytest.mark.parametrize("stderr", ["2>&-", pytest.param("2>/dev/full", marks=needs_full)])
def test_what_nobody_hears_changes_no_exit_status(stderr: str) -> None:
    done = in_a_shell(f"inspect /nowhere/at/all --json {stderr}")
    assert done.returncode == 2
    assert json.loads(done.stdout)["error"]["kind"] == "input"


@posix
def test_without_stdout_there_is_nothing_to_fail_on() -> None:
    done = in_a_shell("list effects >&-")
    assert (done.returncode, done.stderr) == (0, "")


@needs_full
@pytest.mark.parametrize("as_json", ["", "--json"])
def test_a_full_stdout_is_told_in_two_lines(as_json: str) -> None:
    done = in_a_shell(f"list effects {as_json} >/dev/full")
    assert done.returncode == 1
    assert done.stderr == "vgvt: the disk is full: No space left on device\n  make room, or write to another disk\n"


@pytest.mark.parametrize("words", [["inspect", "~/nowhere.nc"], ["identify", "--out=~/nowhere.nc", "~/nowhere.nc"]])
def test_home_is_put_in_place(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    assert run_command(words) == 2
    assert f"{tmp_path}/nowhere.nc: no such file" in capsys.readouterr().err


def test_behind_an_option_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The shell leaves `--out=~/x` alone."""
    (tmp_path / "here").mkdir()
    (tmp_path / "home").mkdir()
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.chdir(tmp_path / "here")
    (tmp_path / "own.toml").write_text(
        'extends = "quick"\nname = "own"\nsummary = "short"\n[excitation]\nduration_s = 2.0\nring_down_s = 0.0\n'
    )
    assert run_command(["simulate", str(tmp_path / "own.toml"), "--engine", "linear", "--out=~/run"]) == 0
    assert not any((tmp_path / "here").iterdir())
    assert read_campaign(tmp_path / "home" / "run" / "campaign.nc").runs
    # The library that reads netCDF would look at home for a folder of that name.
    monkeypatch.chdir(tmp_path / "home")
    (tmp_path / "home" / "run").rename("~")
    assert read_campaign(Path("~/campaign.nc")).runs


@pytest.mark.skipif(not Path("/dev/fd").exists(), reason="no files for open pipes")
def test_a_scenario_comes_through_a_pipe(tmp_path: Path) -> None:
    """It can be read once: the second time it had been empty."""
    out, into = os.pipe()
    os.write(into, b'extends = "quick"\nname = "own"\nsummary = "short"\n[excitation]\nduration_s = 2.0\n')
    os.close(into)
    try:
        words = ["simulate", f"/dev/fd/{out}", "--engine", "linear", "--seed", "3", "--out", str(tmp_path / "run")]
        assert run_command(words) == 0
    finally:
        os.close(out)
    assert (tmp_path / "run" / "sealed" / "truth.nc").is_file()


@posix
def test_a_limit_of_the_shells_is_told_before_anything_is_written(tmp_path: Path) -> None:
    """HDF5 does not survive one that it meets: the process had crashed."""
    code = f"""
from pathlib import Path
from vgvt.cli import boundary
from vgvt.files.atomically import check_space
check_space(Path({str(tmp_path)!r}), 1000)
boundary._dispatch = lambda arguments: check_space(Path({str(tmp_path)!r}), 100_000)
raise SystemExit(boundary.run_command([]))
"""
    line = ["sh", "-c", f'ulimit -f 20; exec {sys.executable} -c "$0"', code]
    done = subprocess.run(line, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith("vgvt: a file would be too large: 0.1 MiB are needed and a file may have 0.0 MiB\n")
