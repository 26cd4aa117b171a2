"""A folder that one process works in: another one is told so at once, before it takes away what the first has made."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from vgvt.data.errors import InputError

# What a lock that another process holds is answered with; any other answer means that locks do not work here.
_HELD = (errno.EACCES, errno.EAGAIN)


@contextmanager
def alone_in(folder: Path, lock: Path, command: str) -> Iterator[None]:
    """The block with ``folder`` to itself; InputError where another process holds ``lock``, which is made as needed.

    The file stays, and says nothing: what counts is held by the process and goes with it, however it ends. Of a
    record lock, and not of ``flock``, a forked helper that outlives its parent has no part. Where a system or a disk
    knows no such locks the block goes on without.
    """
    try:
        lock.parent.mkdir(parents=True, exist_ok=True)
        held = os.open(lock, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:
        raise InputError(str(lock), f"cannot be made ({error.strerror})", "give another folder with --out") from None
    try:
        if _taken(held):
            raise InputError(
                str(folder),
                f"another {command} works in this folder",
                "wait until it has ended, or give another folder with --out",
            )
        yield
    finally:
        os.close(held)


def _taken(descriptor: int) -> bool:
    """Whether another process holds the lock of an open file; it is this one's otherwise."""
    try:
        import fcntl
    except ImportError:
        return False
    try:
        fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno in _HELD
    return False
