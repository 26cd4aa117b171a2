"""MATLAB files: version 5 to 7, and version 7.3 (HDF5) through h5py; version 4 is told."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.data.suggestion import choose_one_of
from vgvt.files import mat_hdf5, mat_level_5
from vgvt.files.mat_level_5 import MatVariable

_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_LEVEL_5 = (b"\0\1IM", b"\1\0MI")  # version and order of bytes; the text before them is free
_LEVEL_4_BYTES, _LONGEST_NAME = 20, 64


def read_mat(path: Path, names: Sequence[str]) -> dict[str, NDArray[Any]]:
    """The numeric variables ``names`` of a MAT file, as MATLAB shows them.

    InputError when the file is missing, truncated, no MAT file, or lacks a variable (then it lists those it has).
    """
    try:
        with path.open("rb") as stream:
            start = stream.read(520)
    except OSError as error:
        raise InputError(str(path), f"cannot be read: {error.strerror or error}", "check the path") from error
    if not start:
        raise InputError(str(path), "the file is empty", "copy or download the file again")
    if start.startswith(_HDF5_SIGNATURE) or start[512:520] == _HDF5_SIGNATURE:
        found, known = _read_hdf5(path, names)
    elif start.startswith(b"MATLAB") or start[124:128] in _LEVEL_5:
        found, known = _read_level_5(path, names)
    else:
        raise _no_mat(path, start)
    for name in names:
        if name not in found:
            raise _missing(path, name, known)
    return {name: _real(path, name, found[name].numbers, found[name].kind) for name in names}


def _read_level_5(path: Path, names: Sequence[str]) -> tuple[dict[str, MatVariable], list[str]]:
    try:
        with path.open("rb") as stream:
            return mat_level_5.variables_of(stream, names)
    except (ValueError, zlib.error, OSError, MemoryError) as error:
        raise InputError(
            str(path),
            f"truncated or damaged ({error})",
            "copy or download the file again; its size should be that of the original",
        ) from error


def _read_hdf5(path: Path, names: Sequence[str]) -> tuple[dict[str, MatVariable], list[str]]:
    try:
        return mat_hdf5.variables_of(path, names)
    except (OSError, KeyError, RuntimeError, ValueError, TypeError, OverflowError, MemoryError) as error:
        raise InputError(str(path), f"truncated or damaged ({error})", "copy or download the file again") from error


def _no_mat(path: Path, start: bytes) -> InputError:
    if _is_level_4(start):
        return InputError(
            str(path), "a MAT file of version 4, which is not read", "load it in MATLAB, and save it again with '-v7'"
        )
    return InputError(str(path), "not a MAT file", "give a file written by MATLAB's save, or set another format")


def _is_level_4(start: bytes) -> bool:
    """Whether a variable of version 4 begins there: its type in four decimal digits, two sizes, a flag, a length."""
    if len(start) < _LEVEL_4_BYTES:
        return False
    for order in "<>":
        kind, rows, columns, is_complex, name_bytes = struct.unpack(f"{order}5i", start[:_LEVEL_4_BYTES])
        machine, zero, stored, matrix = (kind // 10**k % 10 for k in (3, 2, 1, 0))
        plausible = 0 <= kind < 5000 and machine <= 4 and zero == 0 and stored <= 5 and matrix <= 2
        if plausible and min(rows, columns) >= 0 and is_complex in (0, 1) and 0 < name_bytes <= _LONGEST_NAME:
            return True
    return False


def _missing(path: Path, name: str, known: Sequence[str]) -> InputError:
    if not known:
        return InputError(str(path), f"no variable {name!r}: the file holds none", "is the file truncated?")
    return InputError(str(path), f"no variable {name!r}", choose_one_of(name, known))


def _real(path: Path, name: str, numbers: NDArray[Any] | None, kind: str) -> NDArray[Any]:
    if numbers is None:
        raise InputError(str(path), f"variable {name!r} holds no real numbers ({kind})", "name a numeric matrix")
    return numbers
