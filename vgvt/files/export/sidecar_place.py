"""Where the sidecar of converted records goes: beside them, and never in the place of other records' sidecar."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path


def sidecar_place(path: Path, files: Sequence[Path]) -> Path:
    """The name of the sidecar of ``files``, written for the name ``path``: x.toml for x.uff.

    Where that is the sidecar of other records, as of x.mat, those would be unreadable without it: x.uff.toml then.
    """
    place = path.with_suffix(".toml")
    described = _described(place)
    theirs = bool(described) and described.isdisjoint(file.resolve() for file in files)
    return path.with_name(f"{path.name}.toml") if theirs else place


def _described(sidecar: Path) -> frozenset[Path]:
    """The record files that a sidecar names, there or not; empty where this is none that can be read."""
    try:
        table = tomllib.loads(sidecar.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return frozenset()
    runs, records = table.get("run"), table.get("records")
    if not isinstance(runs, list) or not isinstance(records, dict):
        return frozenset()
    # Those of a data set lie elsewhere: whatever is beside the sidecar, it is not what is described.
    folder = sidecar.parent / str(records.get("dataset", "")) / str(records.get("folder", ""))
    return frozenset((folder / str(run["file"])).resolve() for run in runs if isinstance(run, dict) and "file" in run)
