"""Columns of numbers in a text file (CSV and its relatives)."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vgvt.data import InputError

_RAGGED = re.compile(r"number of columns changed from (\d+) to (\d+) at row (\d+)")


def check_delimiter(delimiter: str) -> None:
    """ValueError, with what to write, unless columns can be told apart by it: one character, or '' for white space."""
    if len(delimiter) > 1 or delimiter in ("#", "\n", "\r"):
        raise ValueError(
            f"{delimiter!r} cannot stand between columns; write one character, like ',' or ';', "
            "\"\\t\" (in double quotes) for a tab, or '' for white space"
        )


def read_delimited(path: Path, delimiter: str = ",", skip_rows: int = 0) -> NDArray[np.float64]:
    """The table (rows, columns) of a text file; InputError when missing, ragged or not numeric.

    What follows a # is left out; ``delimiter`` is one character, '' means white space.
    """
    try:
        check_delimiter(delimiter)
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message=".*input contained no data.*", category=UserWarning)
            table = np.loadtxt(path, delimiter=delimiter or None, skiprows=skip_rows, ndmin=2, encoding="utf-8")
    except OSError as error:
        raise InputError(str(path), f"cannot be read: {error.strerror or error}", "check the path") from error
    except ValueError as error:
        ragged = _RAGGED.search(str(error))
        if ragged is not None:
            raise _changed(path, skip_rows, *(int(number) for number in ragged.groups())) from error
        raise InputError(
            str(path),
            f"not a table of numbers ({error})",
            "set skip_rows to the number of heading lines and delimiter to what stands between the columns",
        ) from error
    if not table.size:
        raise InputError(str(path), "the file holds no samples", "leave this run out, or lower skip_rows")
    return table


def _changed(path: Path, skip_rows: int, before: int, after: int, row: int) -> InputError:
    """Of a row of numbers, counted from 1 behind the heading, with other columns than those before it."""
    with path.open(encoding="utf-8") as stream:
        lines = [line for line in list(stream)[skip_rows:] if line.partition("#")[0].strip()]
    if row >= len(lines) and after < before:
        advice = "the file is cut off there: copy or export it again, or take that row out"
    else:
        advice = "mend that row, or set skip_rows to the number of heading lines and delimiter to what stands between"
    return InputError(str(path), f"row {row} of {len(lines)} has {after} columns, and those before it {before}", advice)
