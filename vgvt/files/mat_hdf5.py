"""MAT files of version 7.3, which are HDF5: what MATLAB's attributes say of a variable, before its numbers count."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vgvt.files.mat_level_5 import DamagedMatError, MatVariable

if TYPE_CHECKING:
    import h5py

_CLASS, _EMPTY, _SPARSE = "MATLAB_class", "MATLAB_empty", "MATLAB_sparse"
_NUMERIC = {"double", "single", "logical", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))}


def variables_of(path: Path, names: Collection[str]) -> tuple[dict[str, MatVariable], list[str]]:
    """The variables among ``names``, and the names of all that the file holds.

    What h5py raises of damage, OSError and ValueError among it, passes through.
    """
    import h5py

    with h5py.File(path, "r") as file:
        known = [name for name in file if not name.startswith("#")]
        return {name: _variable(item) for name in names if (item := file.get(name)) is not None}, known


def _variable(item: Any) -> MatVariable:
    import h5py

    called = item.attrs.get(_CLASS)
    matlab_class = called.decode("ascii", "replace") if isinstance(called, bytes) else str(called or "")
    if not isinstance(item, h5py.Dataset):
        return MatVariable("sparse" if _SPARSE in item.attrs else matlab_class or "struct")
    # Text lies there as the whole numbers of its characters, and a file without classes is another program's.
    if matlab_class and matlab_class not in _NUMERIC:
        return MatVariable(matlab_class)
    if item.attrs.get(_EMPTY):
        return MatVariable("empty", _empty(item))
    # HDF5 holds MATLAB's column-major arrays with their axes reversed.
    array = np.asarray(item).T
    return MatVariable(str(array.dtype), array if array.dtype.kind in "fiu" else None)


def _empty(item: h5py.Dataset) -> Any:
    """An array without entries, in whose place its shape stands."""
    shape = tuple(int(length) for length in np.ravel(item))
    if 0 not in shape:
        raise DamagedMatError(f"variable {item.name!r} is called empty, and has the shape {shape}")
    return np.empty(shape)
