"""The segments of a TDMS file, by their lead-ins: one that ends too early is told, where its samples would be fewer.

NI, TDMS File Format Internal Structure (white paper 5696): each segment begins with a tag of four bytes, a mask, the
version, and how far it is to the next segment and to its raw data.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import BinaryIO

from vgvt.data import InputError

_LEAD_IN_BYTES = 28
_TAG, _INDEX_TAG = b"TDSm", b"TDSh"
_BIG_ENDIAN = 1 << 6
_NEVER_CLOSED = 0xFFFFFFFFFFFFFFFF
_AGAIN = "export or copy the file again"


def check_segments(path: Path) -> None:
    """InputError unless a TDMS file is there and its segments fill it from end to end."""
    try:
        size = path.stat().st_size
        with path.open("rb") as stream:
            _walk(path, stream, size)
    except OSError as error:
        raise InputError(str(path), f"cannot be read: {error.strerror or error}", "check the path") from error


def _walk(path: Path, stream: BinaryIO, size: int) -> None:
    if not size:
        raise InputError(str(path), "the file is empty", _AGAIN)
    at, place = 0, 1
    while at < size:
        stream.seek(at)
        at += _length(stream.read(_LEAD_IN_BYTES), path, place)
        if at > size:
            raise _cut_off(f"{path}, segment {place} of the file")
        place += 1


def _length(lead_in: bytes, path: Path, place: int) -> int:
    """Bytes of a segment with its lead-in."""
    where = f"{path}, segment {place} of the file"
    if place == 1 and not _TAG.startswith(lead_in[:4]):
        raise _no_tdms(path, lead_in)
    if not _TAG.startswith(lead_in[:4]):
        raise InputError(where, f"damaged: {lead_in[:4]!r} stands where a segment begins with TDSm", _AGAIN)
    if len(lead_in) < _LEAD_IN_BYTES:
        raise _cut_off(where)
    (mask,) = struct.unpack("<I", lead_in[4:8])
    _, to_next, to_samples = struct.unpack(f"{'>' if mask & _BIG_ENDIAN else '<'}IQQ", lead_in[8:])
    if to_next == _NEVER_CLOSED:
        raise InputError(
            where,
            "never closed: the program that recorded it stopped before the end",
            "open and save the file with the program that wrote it, and see where the record ends; or record again",
        )
    if to_samples > to_next:
        raise InputError(where, "damaged: its samples would begin behind its end", _AGAIN)
    return _LEAD_IN_BYTES + int(to_next)


def _no_tdms(path: Path, lead_in: bytes) -> InputError:
    if lead_in[:4] == _INDEX_TAG:
        return InputError(
            str(path), "the index of a TDMS file, which holds no samples", "give the .tdms that lies beside it"
        )
    return InputError(
        str(path),
        f"not a TDMS file: it begins with {lead_in[:16]!r}",
        "give a file that LabVIEW or DIAdem wrote as TDMS, or write a sidecar whose [records] say its format",
    )


def _cut_off(where: str) -> InputError:
    return InputError(where, "truncated: the file ends within this segment", _AGAIN)
