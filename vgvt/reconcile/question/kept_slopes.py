"""Derivatives of a scenario's matrices on disk: they take seconds, and a second call asks for the same."""

from __future__ import annotations

import hashlib
import os
import stat
import tempfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.files.atomically import replacing
from vgvt.files.npz import read_npz

Array = NDArray[np.float64]
# Files that a folder keeps, some megabytes each: those of the scenarios that one works on.
_FILES, _DIGITS = 20, 24
_OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


def kept_slopes(
    folder: Path | None, text: str, names: Sequence[str], make: Callable[[], dict[str, Array]]
) -> dict[str, Array]:
    """Arrays by ``names`` that follow from a ``text``: as a file of a ``folder`` has them, else made and kept there.

    Without a folder it is one of this user's among the system's temporary files, if there is or can be one: what
    somebody else could write is not read, and where nothing can be written nothing is lost but time.
    """
    place = folder or _own_folder()
    if place is None:
        return make()
    file = place / f"slopes-{hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]}.npz"
    found = _kept(file, names)
    if found is not None:
        with suppress(OSError):  # what is used is not what was made longest ago
            os.utime(file)
        return found
    made = make()
    # A folder that was asked for is one that more is to be written to: the sooner it is told that nothing can.
    with suppress(*(() if folder is not None else (InputError, OSError))):
        with replacing(file) as part, part.open("wb") as stream:
            np.savez(stream, **made)  # type: ignore[arg-type]
        _leave_newest(place)
    return made


def _own_folder() -> Path | None:
    """A folder that nobody but this user can write to; None where that cannot be had."""
    user = os.getuid() if hasattr(os, "getuid") else None  # Windows has temporary files of each user
    try:
        folder = Path(tempfile.gettempdir()) / ("vgvt-reconcile" if user is None else f"vgvt-reconcile-{user}")
        folder.mkdir(mode=0o700, exist_ok=True)
        there = folder.lstat()  # of a link itself, which others may write to
    except OSError:
        return None
    return folder if user is None or (there.st_uid == user and not there.st_mode & _OTHERS_WRITE) else None


def _leave_newest(folder: Path) -> None:
    """Take away what was made longest ago: by other versions, or of scenarios that were edited since."""
    made: list[tuple[int, Path]] = []
    for file in folder.glob(f"slopes-{'[0-9a-f]' * _DIGITS}.npz"):
        with suppress(OSError):  # another process may take it away first
            made.append((file.stat().st_mtime_ns, file))
    for _, file in sorted(made)[:-_FILES]:
        with suppress(OSError):
            file.unlink()


def _kept(file: Path, names: Sequence[str]) -> dict[str, Array] | None:
    """The arrays that a file holds; None without one, and for one that is incomplete or no such file."""
    try:
        return read_npz(file, names)
    # A full disk or a copy that was broken off leaves such a file behind; they are computed again.
    except InputError:
        return None
