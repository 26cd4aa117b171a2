"""A file that a command is to write: looked at before anything is computed, and replacing nothing but its own kind."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

from vgvt.data.errors import InputError

_ELSEWHERE = "give FILE another name"
_LARGEST = 1 << 27  # bytes; records can be larger than memory, and no claim, page or baseline is


def checked_file(path: Path, what: str, is_one: Callable[[Path], bool], read: Sequence[Path] = ()) -> Path:
    """The place of a file that is to be written, which need not be there yet, nor its folder.

    ``what`` says what is written, and ``is_one`` whether a file is such a thing: one may replace another. ``read`` are
    the files that the command reads. InputError where one of these, or anything else, would be lost, or nothing can be
    written there: what was computed by then would be lost, too.
    """
    if path.is_dir():
        raise InputError(str(path), "is a folder, and a file is to be written", "give the name of a file")
    if path.exists() and any(one.exists() and path.samefile(one) for one in read):
        raise InputError(str(path), "is what is read, and would be replaced", _ELSEWHERE)
    if os.path.lexists(path) and not _may_go(path, is_one):
        raise InputError(str(path), f"is there already, and is no {what}", f"{_ELSEWHERE}, or remove that one")
    folder = next(place for place in path.absolute().parents if os.path.lexists(place))
    if not folder.is_dir():
        raise InputError(str(folder), "this is a file, and a folder is needed", _ELSEWHERE)
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(str(path), "cannot be written: its folder may not be written to", "choose another place")
    return path


def _may_go(path: Path, is_one: Callable[[Path], bool]) -> bool:
    if not path.is_file():
        return False
    size = path.stat().st_size
    return not size or (size < _LARGEST and is_one(path))


def is_claim(path: Path) -> bool:
    """Whether a file holds what ``vgvt identify`` says."""
    from vgvt.files.claim import read_claim

    return _reads(read_claim, path)


def is_baseline(path: Path) -> bool:
    """Whether a file is a baseline of ``vgvt bench``."""
    from vgvt.bench.guard import read_baseline

    return _reads(read_baseline, path)


def is_page(path: Path) -> bool:
    """Whether a file is a page that vgvt wrote."""
    from vgvt.view.html_page import FOOTER

    try:
        return FOOTER in path.read_text(encoding="utf-8")
    except (OSError, ValueError):
        return False


def _reads(read: Callable[[Path], object], path: Path) -> bool:
    try:
        read(path)
    except (InputError, OSError):
        return False
    return True
