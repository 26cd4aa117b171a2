"""Derivatives kept on disk: a file that was broken off is as good as none."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from reconciled_case import small_scenario

from vgvt.reconcile.question import kept_slopes as keeping
from vgvt.reconcile.question import problem as asking
from vgvt.reconcile.question.problem import MATRICES
from vgvt.reconcile.question.structure_code import _MAKERS, structure_code

SAY = "from vgvt.reconcile.question.structure_code import structure_code as s; print(s(), end='')"


def broken_off(file: Path) -> None:
    """Half of it reached the disk."""
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) // 2])


def emptied(file: Path) -> None:
    """Nothing of it did."""
    file.write_bytes(b"")


def scribbled(file: Path) -> None:
    """Something else did."""
    file.write_bytes(b"not what was written here" * 9)


def of_other_names(file: Path) -> None:
    """A file of this kind that lacks a matrix."""
    np.savez(file, mass=np.eye(2))


def packed_otherwise(file: Path) -> None:
    """A wrong byte makes the archive ask for a compression that there is not."""
    whole = file.read_bytes()
    at = whole.index(b"PK\1\2") + 10
    file.write_bytes(whole[:at] + b"\x6c" + whole[at + 1 :])


@pytest.mark.parametrize("spoil", [broken_off, emptied, scribbled, of_other_names, packed_otherwise])
def test_a_spoilt_file_is_computed_again(tmp_path: Path, spoil: Callable[[Path], None]) -> None:
    scenario = small_scenario()
    start, _, _ = asking._hung(scenario, scenario, 60.0)
    known = asking.unknowns(scenario)[:1]
    first = asking._slopes(start.scenario, known, start.layouts, start.structure, tmp_path)
    (file,) = tmp_path.iterdir()
    spoil(file)
    again = asking._slopes(start.scenario, known, start.layouts, start.structure, tmp_path)
    assert all(np.array_equal(first[name], again[name]) for name in MATRICES)
    kept = keeping._kept(file, MATRICES)
    assert kept is not None and set(kept) == set(MATRICES)


def taken(folder: Path) -> dict[str, np.ndarray]:
    """The slopes in one unknown, with a folder to keep them in."""
    scenario = small_scenario()
    start, _, _ = asking._hung(scenario, scenario, 60.0)
    known = asking.unknowns(scenario)[:1]
    return asking._slopes(start.scenario, known, start.layouts, start.structure, folder)


def test_another_program_does_not_use_what_this_one_took(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A key of the scenario alone would serve matrices that are made otherwise by now."""
    taken(tmp_path)
    (file,) = tmp_path.iterdir()
    taken(tmp_path)
    assert list(tmp_path.iterdir()) == [file]
    monkeypatch.setattr(asking, "structure_code", lambda: "of another version")
    taken(tmp_path)
    assert len(list(tmp_path.iterdir())) == 2


def test_a_folder_keeps_what_was_used_last(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And nothing in it that is no such file is touched."""
    others = [tmp_path / f"slopes-{k:024x}.npz" for k in range(3)]
    mine = tmp_path / "slopes-mine.npz"
    for k, file in enumerate((*others, mine)):
        file.write_bytes(b"")
        os.utime(file, (k, k))
    monkeypatch.setattr(keeping, "_FILES", 3)
    taken(tmp_path)
    (fresh,) = set(tmp_path.iterdir()) - {*others, mine}
    assert set(tmp_path.iterdir()) == {others[1], others[2], mine, fresh}
    os.utime(fresh, (0, 0))
    taken(tmp_path)
    assert fresh.stat().st_mtime > 10


def twos() -> dict[str, np.ndarray]:
    """What is to be kept."""
    return {"mass": np.full(2, 2.0)}


def kept_without_a_folder() -> dict[str, np.ndarray]:
    """The same twice, of which the second time reads what the first wrote, if anything."""
    first = keeping.kept_slopes(None, "text", ("mass",), twos)
    again = keeping.kept_slopes(None, "text", ("mass",), twos)
    assert np.array_equal(first["mass"], again["mass"])
    return again


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of temporary files."""
    monkeypatch.setattr(keeping.tempfile, "gettempdir", lambda: str(tmp_path))
    return tmp_path


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="temporary files are each user's own there")
def test_nobody_keeps_anothers(temporary: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first user's folder had stopped the second one's reconcile; and what anybody can write, nobody reads."""
    kept_without_a_folder()
    (mine,) = temporary.iterdir()
    assert mine.stat().st_mode & 0o077 == 0 and len(list(mine.iterdir())) == 1
    user = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: user + 1)
    planted = temporary / f"vgvt-reconcile-{user + 1}"
    planted.mkdir()
    kept_without_a_folder()
    assert list(planted.iterdir()) == []
    assert len(list(mine.iterdir())) == 1


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="temporary files are each user's own there")
@pytest.mark.parametrize("how", ["writable", "a link"])
def test_a_folder_of_ones_own_that_others_may_fill_is_none(temporary: Path, how: str) -> None:
    mine, elsewhere = temporary / f"vgvt-reconcile-{os.getuid()}", temporary / "elsewhere"
    elsewhere.mkdir()
    if how == "writable":
        mine.mkdir()
        mine.chmod(0o777)
    else:
        mine.symlink_to(elsewhere)
    kept_without_a_folder()
    assert list(mine.iterdir()) == list(elsewhere.iterdir()) == []


def test_what_cannot_be_kept_is_made_again(temporary: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*given: object, **settings: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    assert kept_without_a_folder()["mass"].tolist() == [2.0, 2.0]
    assert [list(p.iterdir()) for p in temporary.iterdir()] == [[]]
    with pytest.raises(OSError, match="No space left"):
        keeping.kept_slopes(temporary / "asked for", "text", ("mass",), twos)
    monkeypatch.setattr(keeping.tempfile, "gettempdir", lambda: str(temporary / "gone"))
    assert kept_without_a_folder()["mass"].tolist() == [2.0, 2.0]


def test_the_program_is_known_by_its_source() -> None:
    """The same in every process; it covers what airframes are built by, and what is unknown of them."""
    asked = [
        subprocess.run([sys.executable, "-c", SAY], capture_output=True, text=True, check=True).stdout for _ in range(2)
    ]
    assert asked == [structure_code()] * 2
    names = {
        "simulation/airframe.py",
        "simulation/damping.py",
        "scenario/airframe.py",
        "reconcile/question/uncertain.py",
    }
    root = Path(asking.__file__).parents[2]
    assert all(
        (root / name).parent.relative_to(root).as_posix() in _MAKERS and (root / name).is_file() for name in names
    )
