"""A folder that one process works in: another one is told so at once, before it takes away what the first has made."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from vgvt.data.errors import InputError

# What a lock that another process holds is answered with; any other answer means that locks do not work here.
_HELD = (errno.EACCES, errno.EAGAIN)


@contextmanager
def alone_in(folder: Path, lock: Path, command: str) -> Iterator[None]:
    """The block with ``folder`` to itself; InputError where another process holds ``lock``, which is made as needed.

    The file stays, and says nothing: what counts is held by the process and goes with it, however it ends. One that
    this call has made goes with an exception, too, for then the folder may hold nothing else. Of a record lock, and not
    of ``flock``, a forked helper that outlives its parent has no part. Where a system or a disk knows no such locks the
    block goes on without.
    """
    new = not lock.exists()
    held = _held(folder, lock, command)
    try:
        yield
    except BaseException:
        if new:
            # Before it is closed: nobody else holds it then. Where an open file cannot be removed it stays.
            with suppress(OSError):
                lock.unlink()
        raise
    finally:
        os.close(held)


def _held(folder: Path, lock: Path, command: str) -> int:
    """The descriptor of the lock, which is this process's; InputError where it is another one's."""
    while True:
        try:
            lock.parent.mkdir(parents=True, exist_ok=True)
            held = os.open(lock, os.O_RDWR | os.O_CREAT, 0o666)
        except OSError as error:
            raise InputError(
                str(lock), f"cannot be made ({error.strerror})", "give another folder with --out"
            ) from None
        taken = _taken(held)
        # Another process may have removed it in between: then what is locked is nobody's, and the next one makes anew.
        if not taken and _still_there(held, lock):
            return held
        os.close(held)
        if taken:
            raise InputError(
                str(folder),
                f"another {command} works in this folder",
                "wait until it has ended, or give another folder with --out",
            )


def _still_there(descriptor: int, lock: Path) -> bool:
    """Whether an open file is the one that has the lock's name."""
    try:
        return os.path.samestat(os.fstat(descriptor), lock.stat())
    except FileNotFoundError:
        return False


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
