"""Files appear whole or not at all: written beside their place, then renamed into it."""

from __future__ import annotations

import errno
import os
import shutil
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from vgvt.data import InputError


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A temporary path in the folder of ``path`` that takes its name when the block ends well.

    On an exception the temporary file goes and whatever stood at ``path`` stays.
    Folders are made as needed. InputError when the place cannot be written, or is a folder.
    """
    final = Path(path)
    if final.is_dir():
        raise InputError(str(final), "is a folder, and a file is to be written", "give the name of a file")
    temporary = final.with_name(f".{final.name}.{uuid.uuid4().hex[:8]}.part")
    try:
        final.parent.mkdir(parents=True, exist_ok=True)
        temporary.touch(exist_ok=False)
    except OSError as error:
        raise InputError(str(final), f"cannot be written: {error.strerror or error}", "choose another place") from error
    try:
        yield temporary
        _flush_to_disk(temporary)
        temporary.replace(final)
    finally:
        temporary.unlink(missing_ok=True)


def check_space(folder: Path, needed_bytes: int) -> None:
    """OSError when the disk of a folder, which need not exist yet, has less room than that, or no file may be as large.

    ENOSPC for the first and EFBIG for the second, as a limit of the shell's makes it.
    """
    existing = next(place for place in (folder.absolute(), *folder.absolute().parents) if place.exists())
    free_bytes = shutil.disk_usage(existing).free
    if free_bytes < needed_bytes:
        raise OSError(
            errno.ENOSPC,
            f"{needed_bytes / 2**20:.1f} MiB are needed and {free_bytes / 2**20:.1f} MiB are free",
            str(folder),
        )
    largest_bytes = _largest_file_bytes()
    if largest_bytes is not None and largest_bytes < needed_bytes:
        raise OSError(
            errno.EFBIG,
            f"{needed_bytes / 2**20:.1f} MiB are needed and a file may have {largest_bytes / 2**20:.1f} MiB",
            str(folder),
        )


def _largest_file_bytes() -> int | None:
    """How large a file this process may write; None where nothing says so."""
    try:
        import resource
    except ImportError:  # Windows
        return None
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    return None if limit == resource.RLIM_INFINITY else limit


def _flush_to_disk(path: Path) -> None:
    """Without this a power cut may leave the new name with the old (no) content."""
    with path.open("rb+") as stream:
        os.fsync(stream.fileno())
