"""Ctrl-C that cannot get lost: an interrupt that a library swallows is raised again at the next report of progress."""

from __future__ import annotations

import threading
from types import FrameType
from typing import NoReturn

_asked = threading.Event()


class Interrupted(KeyboardInterrupt):
    """Ctrl-C. A type of its own: a plain KeyboardInterrupt that passes code run by a C extension makes
    CPython kill the process by the signal at exit, even when it was caught in between.
    """


def on_signal(_number: int, _frame: FrameType | None) -> NoReturn:
    """The handler of SIGINT: remember that somebody asked, then interrupt as usual.

    An exception raised while a C extension is being imported or an object finalised may be dropped there.
    """
    _asked.set()
    raise Interrupted


def forget() -> None:
    """Start afresh, at the beginning of a command."""
    _asked.clear()


def raise_if_asked() -> None:
    """KeyboardInterrupt where somebody asked for it and is still waiting."""
    if _asked.is_set():
        raise Interrupted
