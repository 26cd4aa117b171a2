"""Where results of a bench, a sweep or a plan go is looked at first, and what is kept in it is told."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from coarse_beam import BEAM

from vgvt.cli.boundary import run_command
from vgvt.cli.results_folder import CELLS, checked_folder, telling_what_is_kept
from vgvt.data import InputError
from vgvt.files.atomically import replacing

COMMANDS = (
    ("bench", "quick", "--identifier", "quadrature"),
    ("sweep", "quick", "--set", "excitation.amplitude_v=1,2"),
    ("plan", "quick"),
)


@pytest.mark.parametrize("command", COMMANDS, ids=lambda c: c[0])
def test_a_file_is_refused_before_anything_is_simulated(
    command: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("vgvt.simulation.campaign.simulate", lambda *_, **__: pytest.fail("work was begun"))
    place = tmp_path / "afile"
    place.write_text("mine")
    assert run_command([*command, "--out", str(place)]) == 2
    said = capsys.readouterr().err
    assert f"{place}: this is a file" in said
    assert "--out FOLDER" in said
    assert run_command([*command, "--out", str(place / "deeper")]) == 2
    assert place.read_text() == "mine"


@pytest.mark.parametrize("command", COMMANDS, ids=lambda c: c[0])
def test_a_folder_of_other_things_is_left_alone(
    command: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "campaign.nc").write_text("mine")
    assert run_command([*command, "--out", str(tmp_path)]) == 2
    assert "holds other things (campaign.nc)" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["campaign.nc"]


def test_an_own_an_empty_and_a_new_folder_will_do(tmp_path: Path) -> None:
    assert checked_folder(tmp_path, (CELLS,)) == tmp_path
    (tmp_path / CELLS).mkdir()
    assert checked_folder(tmp_path, (CELLS,)) == tmp_path
    assert not checked_folder(tmp_path / "new" / "deep", (CELLS,)).exists()


def test_a_folder_that_may_not_be_written_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By what the system says of it: who may do anything may write anywhere."""
    monkeypatch.setattr(os, "access", lambda place, mode: Path(place) != tmp_path)
    with pytest.raises(InputError, match="may not write"):
        checked_folder(tmp_path / "new", (CELLS,))


@pytest.mark.parametrize(("done", "said"), [(0, "nothing was kept"), (1, "1 campaign is kept"), (3, "3 campaigns are")])
def test_what_is_kept_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str], done: int, said: str) -> None:
    (tmp_path / CELLS).mkdir()
    for k in range(done):
        (tmp_path / CELLS / f"{k}.json").touch()
    with pytest.raises(KeyboardInterrupt), telling_what_is_kept(tmp_path):
        raise KeyboardInterrupt
    assert said in capsys.readouterr().err


def test_a_folder_is_no_file_to_write(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is a folder"), replacing(tmp_path):
        pytest.fail("work was begun")
    assert list(tmp_path.parent.glob(f".{tmp_path.name}.*")) == []


def test_ctrl_c_in_a_pool_is_told_once(tmp_path: Path) -> None:
    """A terminal sends it to all processes: only the one that was started speaks, and nothing stays on disk."""
    temporary, out, beam = tmp_path / "temporary", tmp_path / "bench", tmp_path / "beam.toml"
    temporary.mkdir()
    beam.write_text(BEAM)
    process = subprocess.Popen(
        [sys.executable, "-m", "vgvt", "bench", str(beam), "--identifier", "quadrature", "--seeds", "400",
         "--workers", "2", "--out", str(out)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
        env={**os.environ, "TMPDIR": str(temporary)},
    )  # fmt: skip
    deadline = time.monotonic() + 120
    while not list(out.glob(f"{CELLS}/*.json")):
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.1)
    os.killpg(process.pid, signal.SIGINT)
    _, said = process.communicate(timeout=120)
    assert process.returncode == 130
    assert "Traceback" not in said
    assert f"kept in {out}, and the same command goes on" in said
    # No waiting: who was started takes away what its workers had, and ends after them.
    assert list(temporary.glob("vgvt-*")) == []
