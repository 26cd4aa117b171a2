"""The folder of a bench, a sweep or a plan: looked at before anything is computed, and what is kept in it."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

from vgvt.cli.console import log
from vgvt.data.errors import InputError

CELLS = "cells"
_ELSEWHERE = "give another place with --out FOLDER"


def checked_folder(path: Path, own: Collection[str]) -> Path:
    """The folder that results may go to, which need not be there yet; ``own`` are the names by which one is known.

    InputError where it is a file, may not be written, or holds other things and nothing of its own.
    """
    there = next(place for place in (path.absolute(), *path.absolute().parents) if os.path.lexists(place))
    if not there.is_dir():
        raise InputError(str(there), "this is a file, and results need a folder", _ELSEWHERE)
    if not os.access(there, os.W_OK | os.X_OK):
        raise InputError(str(there), "may not write here", _ELSEWHERE)
    if path.is_dir():
        names = [place.name for place in path.iterdir()]
        if names and not set(names) & set(own):
            raise InputError(
                str(path), f"holds other things ({_some(names)}) and no results of this command", _ELSEWHERE
            )
    return path


@contextmanager
def telling_what_is_kept(path: Path) -> Iterator[None]:
    """Say on Ctrl-C how many campaigns are done, and that the same command goes on behind them."""
    try:
        yield
    except (KeyboardInterrupt, SystemExit):
        cells = path / CELLS
        done = len(list(cells.glob("*.json"))) if cells.is_dir() else 0
        if done:
            log(f"stopped; {done} {'campaign is' if done == 1 else 'campaigns are'} kept in {path}, "
                "and the same command goes on behind")  # fmt: skip
        else:
            log(f"stopped; nothing was kept in {path}")
        raise


def _some(names: list[str]) -> str:
    """A few names in words."""
    shown = sorted(names)[:3]
    return ", ".join(shown) + (", …" if len(names) > len(shown) else "")
