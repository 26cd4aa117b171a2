"""numpy archives."""

from __future__ import annotations

import struct
import tokenize
import zipfile
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError
from vgvt.data.suggestion import choose_one_of
from vgvt.files.storable import check_numbers

# A header is parsed as Python text, and may ask for more memory than there is.
_DAMAGE = (
    *(OSError, ValueError, EOFError, TypeError, KeyError, IndexError, OverflowError, MemoryError, RuntimeError),
    *(SyntaxError, struct.error, tokenize.TokenError, zipfile.BadZipFile, zlib.error),
)


def read_npz(path: Path, names: Sequence[str]) -> dict[str, NDArray[Any]]:
    """The numeric arrays ``names`` of an .npz file; never unpickles.

    InputError when the file is missing, truncated, of another kind, or lacks an array.
    """
    if not path.is_file():
        raise InputError(str(path), "no such file", "check the path")
    if not zipfile.is_zipfile(path):
        raise InputError(str(path), "truncated, or not an .npz archive", "copy the file again")
    try:
        with zipfile.ZipFile(path) as archive:
            members = {member.removesuffix(".npy"): member for member in archive.namelist()}
            for name in names:
                if name not in members:
                    raise InputError(str(path), f"no array {name!r}", choose_one_of(name, members))
            arrays = {name: _array(archive, members[name]) for name in names}
    except InputError:
        raise
    except _DAMAGE as error:
        raise InputError(str(path), f"damaged ({error})", "copy the file again") from error
    for name, array in arrays.items():
        if array.dtype.kind not in "fiu":
            raise InputError(str(path), f"array {name!r} holds no real numbers ({array.dtype})", "name another")
        check_numbers(array, str(path), f"numbers of array {name!r}")
    return arrays


def _array(archive: zipfile.ZipFile, member: str) -> NDArray[Any]:
    with archive.open(member) as stream:
        array = np.lib.format.read_array(stream, allow_pickle=False)
        # Reading up to the end is what makes zipfile compare the checksum.
        if stream.read(1):
            raise ValueError(f"{member} is longer than its header says")
    return np.asarray(array)
