"""The manifest of a run folder: every file by its hash, and the versions behind the numbers."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from pathlib import Path

import pytest

from vgvt.data import InputError
from vgvt.files import check_manifest, write_manifest


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A run folder with two files."""
    (tmp_path / "sealed").mkdir()
    (tmp_path / "campaign.nc").write_bytes(b"samples")
    (tmp_path / "sealed" / "truth.nc").write_bytes(b"truth")
    return tmp_path


def test_it_lists_hashes_versions_and_seeds(folder: Path) -> None:
    path = write_manifest(folder, {"campaign": 7}, {"scenario": "quick"})
    manifest = json.loads(path.read_text())
    assert manifest["files"]["sealed/truth.nc"]["sha256"] == hashlib.sha256(b"truth").hexdigest()
    assert set(manifest["files"]) == {"campaign.nc", "sealed/truth.nc"}
    assert manifest["seeds"] == {"campaign": 7}
    assert manifest["scenario"] == "quick"
    assert {"python", "vgvt", "numpy", "scipy", "mujoco"} <= set(manifest["versions"])


def test_what_changed_since_is_named(folder: Path) -> None:
    write_manifest(folder, {})
    assert check_manifest(folder) == ()
    (folder / "campaign.nc").write_bytes(b"other")
    (folder / "sealed" / "truth.nc").unlink()
    (folder / "new.txt").write_text("new")
    assert check_manifest(folder) == (
        "sealed/truth.nc is missing",
        "campaign.nc has changed",
        "new.txt is not in the manifest",
    )
    write_manifest(folder, {})
    assert check_manifest(folder) == ()


def test_no_manifest_is_bad_input(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"manifest\.json"):
        check_manifest(folder)
    (folder / "manifest.json").write_text("[1, 2]")
    with pytest.raises(InputError, match="not a manifest"):
        check_manifest(folder)
    with pytest.raises(InputError, match="no such folder"):
        write_manifest(tmp_path / "nowhere", {})


def test_the_files_and_signals_packages_import_nothing_heavy() -> None:
    code = (
        "import sys, vgvt.files, vgvt.files.truth, vgvt.signals\n"
        "heavy = {'scipy', 'xarray', 'h5py', 'h5netcdf', 'pandas', 'pydantic', 'mujoco', 'matplotlib'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
