"""A file's own last bytes say what all others are, so that damage is known before a library parses it.

libhdf5 runs for ever over some damage (an empty object in a heap), and no content's hash is reached then.
HDF5 reads no byte beyond the end that a file states, so sealed files are files like any other to it.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from vgvt.data import InputError

_MARK = b"sealed by SHA256"
_SEAL_BYTES = len(_MARK) + hashlib.sha256().digest_size
_BLOCK_BYTES = 1 << 20
_END_AT = slice(40, 48)  # of a superblock of version 0, with addresses of eight bytes
_VERSION_0 = (8, 0)


def seal(path: Path) -> None:
    """Append the SHA-256 of an HDF5 file, at most once."""
    digest = _digest(path, path.stat().st_size)
    with path.open("ab") as stream:
        stream.write(_MARK + digest)


def check_seal(path: Path) -> None:
    """InputError where a file's bytes are not those that were sealed; a file without a seal is taken as it is."""
    size = path.stat().st_size
    with path.open("rb") as stream:
        start = stream.read(_END_AT.stop)
        stream.seek(max(0, size - _SEAL_BYTES))
        end = stream.read(_SEAL_BYTES)
    if end.startswith(_MARK):
        whole = end[len(_MARK) :] == _digest(path, size - _SEAL_BYTES)
    else:
        stated = _stated_size(start)
        whole = stated is None or not 0 < size - stated <= _SEAL_BYTES  # else a seal that is itself damaged
    if not whole:
        raise InputError(
            str(path),
            "damaged: its bytes are not those that were written (SHA-256)",
            "copy it again from where it came, or make it again",
        )


def _digest(path: Path, size: int) -> bytes:
    digest = hashlib.sha256()
    with path.open("rb") as stream:
        while size > 0 and (block := stream.read(min(size, _BLOCK_BYTES))):
            digest.update(block)
            size -= len(block)
    return digest.digest()


def _stated_size(start: bytes) -> int | None:
    """Where an HDF5 file ends by its own superblock; None where that has another form."""
    if len(start) < _END_AT.stop or (start[13], start[8]) != _VERSION_0:
        return None
    return int.from_bytes(start[_END_AT], "little")
