"""MATLAB files: version 5 to 7, and version 7.3 (HDF5) through h5py."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.data.suggestion import choose_one_of
from vgvt.files.mat_level_5 import variables_of

_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"


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
        return _read_hdf5(path, names)
    if not start.startswith(b"MATLAB"):
        raise InputError(str(path), "not a MAT file", "give a file written by MATLAB's save, or set another format")
    return _read_level_5(path, names)


def _read_level_5(path: Path, names: Sequence[str]) -> dict[str, NDArray[Any]]:
    try:
        with path.open("rb") as stream:
            found, known = variables_of(stream, names)
    except (ValueError, zlib.error, OSError, MemoryError) as error:
        raise InputError(
            str(path),
            f"truncated or damaged ({error})",
            "copy or download the file again; its size should be that of the original",
        ) from error
    for name in names:
        if name not in found:
            raise _missing(path, name, known)
    return {name: _real(path, name, found[name].numbers, found[name].kind) for name in names}


def _read_hdf5(path: Path, names: Sequence[str]) -> dict[str, NDArray[Any]]:
    import h5py

    try:
        with h5py.File(path, "r") as file:
            for name in names:
                if not isinstance(file.get(name), h5py.Dataset):
                    raise _missing(path, name, [k for k in file if not k.startswith("#")])
            # HDF5 holds MATLAB's column-major arrays with their axes reversed.
            return {name: _of_dataset(path, name, np.asarray(file[name]).T) for name in names}
    except InputError:
        raise
    except (OSError, KeyError, RuntimeError, ValueError, TypeError, OverflowError, MemoryError) as error:
        raise InputError(str(path), f"truncated or damaged ({error})", "copy or download the file again") from error


def _missing(path: Path, name: str, known: Sequence[str]) -> InputError:
    if not known:
        return InputError(str(path), f"no variable {name!r}: the file holds none", "is the file truncated?")
    return InputError(str(path), f"no variable {name!r}", choose_one_of(name, known))


def _of_dataset(path: Path, name: str, array: NDArray[Any]) -> NDArray[Any]:
    return _real(path, name, array if array.dtype.kind in "fiu" else None, str(array.dtype))


def _real(path: Path, name: str, numbers: NDArray[Any] | None, kind: str) -> NDArray[Any]:
    if numbers is None:
        raise InputError(str(path), f"variable {name!r} holds no real numbers ({kind})", "name a numeric matrix")
    return numbers
