"""Folders that a command makes on the way to its files: where it fails, it leaves none of them empty behind."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def none_left_empty(folder: Path) -> Iterator[None]:
    """On an exception, Ctrl-C included, take back a folder and its parents that were not there before, where empty."""
    # Not Path.exists, which raises where a folder on the way may not be looked into.
    new = [place for place in (folder, *folder.parents) if not os.path.exists(place)]  # noqa: PTH110
    try:
        yield
    except BaseException:
        for place in new:
            if place.is_dir() and not any(place.iterdir()):
                place.rmdir()
        raise
