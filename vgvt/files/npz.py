"""numpy archives."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.data.suggestion import choose_one_of


def read_npz(path: Path, names: Sequence[str]) -> dict[str, NDArray[Any]]:
    """The numeric arrays ``names`` of an .npz file; never unpickles.

    InputError when the file is missing, truncated, of another kind, or lacks an array.
    """
    if not path.is_file():
        raise InputError(str(path), "no such file", "check the path")
    if not zipfile.is_zipfile(path):
        raise InputError(str(path), "truncated, or not an .npz archive", "copy the file again")
    try:
        with np.load(path, allow_pickle=False) as archive:
            for name in names:
                if name not in archive:
                    raise InputError(str(path), f"no array {name!r}", choose_one_of(name, archive.files))
            arrays = {name: archive[name] for name in names}
    except InputError:
        raise
    except (OSError, ValueError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise InputError(str(path), f"damaged ({error})", "copy the file again") from error
    for name, array in arrays.items():
        if array.dtype.kind not in "fiu":
            raise InputError(str(path), f"array {name!r} holds no real numbers ({array.dtype})", "name another")
    return arrays
