"""The manifest of a run folder: hashes of its files, versions and seeds, so that a result can be traced."""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from vgvt._version import __version__
from vgvt.data import InputError
from vgvt.files.atomically import replacing

MANIFEST_NAME = "manifest.json"
_PACKAGES = ("numpy", "scipy", "mujoco", "xarray", "h5netcdf")


def file_sha256(path: Path) -> str:
    """SHA-256 of a file in hexadecimal; InputError when it cannot be read."""
    try:
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise InputError(str(path), f"cannot be read: {error.strerror or error}", "check the path") from error


def versions() -> dict[str, str]:
    """Versions of the interpreter, of vgvt and of the libraries that numbers depend on, without importing them."""
    found = {"python": platform.python_version(), "vgvt": __version__}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found


def write_manifest(folder: str | Path, seeds: Mapping[str, int], facts: Mapping[str, Any] | None = None) -> Path:
    """Write ``manifest.json`` over every file in a run folder and below; returns its path.

    Keys: created, versions, platform, seeds, files (path: sha256, bytes), and ``facts``, which must be JSON.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise InputError(str(folder), "no such folder", "check the path")
    manifest = {
        **(facts or {}),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": versions(),
        "platform": platform.platform(),
        "seeds": dict(seeds),
        "files": {
            path.relative_to(folder).as_posix(): {"sha256": file_sha256(path), "bytes": path.stat().st_size}
            for path in _files(folder)
        },
    }
    target = folder / MANIFEST_NAME
    with replacing(target) as temporary:
        temporary.write_text(json.dumps(manifest, indent=2) + "\n", encoding="utf-8")
    return target


def check_manifest(folder: str | Path) -> tuple[str, ...]:
    """What differs between a run folder and its manifest, in words; empty when nothing does."""
    folder = Path(folder)
    path = folder / MANIFEST_NAME
    try:
        listed: dict[str, dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))["files"]
    except OSError as error:
        raise InputError(str(path), f"cannot be read: {error.strerror or error}", "give a run folder") from error
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(str(path), "not a manifest", "make the run again") from error
    present = {p.relative_to(folder).as_posix(): p for p in _files(folder)}
    missing = [f"{name} is missing" for name in listed if name not in present]
    added = [f"{name} is not in the manifest" for name in present if name not in listed]
    changed = [
        f"{name} has changed"
        for name, facts in listed.items()
        if name in present and file_sha256(present[name]) != facts["sha256"]
    ]
    return tuple(missing + changed + added)


def _files(folder: Path) -> list[Path]:
    return sorted(p for p in folder.rglob("*") if p.is_file() and p != folder / MANIFEST_NAME)
