"""MATLAB files: version 5 to 7 through scipy, version 7.3 (HDF5) through h5py."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.data.suggestion import choose_one_of

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
    return _read_version_5(path, names)


def _read_version_5(path: Path, names: Sequence[str]) -> dict[str, NDArray[Any]]:
    import scipy.io

    try:
        content = scipy.io.loadmat(path, variable_names=list(names), appendmat=False)
        known = [entry[0] for entry in scipy.io.whosmat(path, appendmat=False)] if set(names) - set(content) else []
    except Exception as error:  # What scipy raises of a damaged file has no common kind.
        raise InputError(
            str(path),
            f"truncated or damaged ({error})",
            "copy or download the file again; its size should be that of the original",
        ) from error
    for name in names:
        if name not in content:
            raise _missing(path, name, known)
    return {name: _numeric(path, name, content[name]) for name in names}


def _read_hdf5(path: Path, names: Sequence[str]) -> dict[str, NDArray[Any]]:
    import h5py

    try:
        with h5py.File(path, "r") as file:
            for name in names:
                if not isinstance(file.get(name), h5py.Dataset):
                    raise _missing(path, name, [k for k in file if not k.startswith("#")])
            # HDF5 holds MATLAB's column-major arrays with their axes reversed.
            return {name: _numeric(path, name, np.asarray(file[name]).T) for name in names}
    except InputError:
        raise
    except (OSError, KeyError, RuntimeError, ValueError, TypeError, OverflowError, MemoryError) as error:
        raise InputError(str(path), f"truncated or damaged ({error})", "copy or download the file again") from error


def _missing(path: Path, name: str, known: Sequence[str]) -> InputError:
    if not known:
        return InputError(str(path), f"no variable {name!r}: the file holds none", "is the file truncated?")
    return InputError(str(path), f"no variable {name!r}", choose_one_of(name, known))


def _numeric(path: Path, name: str, array: Any) -> NDArray[Any]:
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "fiu":
        kind = getattr(array, "dtype", type(array).__name__)
        raise InputError(str(path), f"variable {name!r} holds no real numbers ({kind})", "name a numeric matrix")
    return array
