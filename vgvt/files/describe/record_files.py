"""The record files of one campaign: where they lie, seen from a sidecar, and that none is given twice."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from vgvt.data import InputError
from vgvt.files.manifest import file_sha256
from vgvt.files.storable import check_file_name


@dataclass(frozen=True, slots=True, eq=False)
class RecordFiles:
    """Files, and how a sidecar names them."""

    folder: Path
    """The one that all of them lie in."""
    relative: str
    """That folder, seen from the sidecar; empty where it is the same."""
    names: dict[Path, str]
    """By the path that was given, relative to the folder."""

    def hashes(self) -> dict[str, str]:
        """SHA-256 by name."""
        return {name: file_sha256(path) for path, name in self.names.items()}


def record_files(files: Sequence[Path], sidecar: Path) -> RecordFiles:
    """How a sidecar names some files; InputError where one of them is given twice, or has a name that is not UTF-8."""
    places = [_absolute(path) for path in files]
    twice = [str(path) for path, place in zip(files, places, strict=True) if places.count(place) > 1]
    if twice:
        raise InputError(twice[0], "is given twice, and its runs would count twice", "give it once")
    folder = Path(os.path.commonpath([place.parent for place in places]))
    relative = Path(os.path.relpath(folder, _absolute(sidecar).parent)).as_posix()
    names = {path: place.relative_to(folder).as_posix() for path, place in zip(files, places, strict=True)}
    for path, name in ((sidecar, sidecar.name), *names.items(), (folder, relative)):
        check_file_name(path, name)
    return RecordFiles(folder, "" if relative == "." else relative, names)


def _absolute(path: Path) -> Path:
    """The path from the root on; a link in place of the file itself keeps its name."""
    return path.parent.resolve() / path.name
