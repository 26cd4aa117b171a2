"""Datasets of a Universal File as they are written: header, units, places, and functions as text or binary.

Fields by the descriptions of the Structural Dynamics Research Laboratory, University of Cincinnati.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray

from vgvt.data import Dof, Geometry

_END = "    -1\n"
_LINE = 80
_HEADER_LINES = 11
_LITTLE_ENDIAN, _IEEE = 1, 2
_NUMBERS_A_LINE = 8
# Not by strftime: where a program around has set a locale, months are in its language, and not in ASCII.
_MONTHS = ("JAN", "FEB", "MAR", "APR", "MAY", "JUN", "JUL", "AUG", "SEP", "OCT", "NOV", "DEC")


@dataclass(frozen=True, slots=True)
class Axis:
    """Records 8 to 10 of a dataset 58: a specific data type, its name and its unit."""

    code: int = 0
    label: str = "NONE"
    unit: str = "NONE"


@dataclass(frozen=True, slots=True, eq=False)
class Function:
    """What a dataset 58 holds: ``values`` (N,), real or complex, over an ``abscissa`` (N,) that may be uneven.

    An even one is written as its first value and its ``increment``, to six digits, as the format has it.
    """

    kind: int
    """Function type: 1 for a time response, 4 for a frequency response function."""
    identification: Sequence[str]
    values: NDArray[np.floating] | NDArray[np.complexfloating]
    start: float
    increment: float
    response: Dof | None
    reference: Dof | None
    axis: Axis
    ordinate: Axis
    denominator: Axis = Axis()
    abscissa: NDArray[np.float64] | None = None
    """(N,) where it is uneven."""


def header_151(name: str, program: str) -> bytes:
    """Dataset 151: what the file is of, and which program wrote it, now."""
    now = datetime.now(UTC)
    day = f"{now.day:02d}-{_MONTHS[now.month - 1]}-{now.year % 100:02d}"
    moment = day.ljust(10) + f"{now:%H:%M:%S}".ljust(10)
    rows = [_words(name), "NONE", _words(program), moment + f"{0:10d}{0:10d}{0:10d}", moment, _words(program), moment]
    return _dataset(151, rows)


def units_164_si() -> bytes:
    """Dataset 164: metres, newtons, kelvins."""
    one, zero = (f"{value:25.17E}".replace("E", "D") for value in (1.0, 0.0))
    return _dataset(164, [f"{1:10d}{'SI: meter (newton)':20s}{2:10d}", one * 3, zero])


def nodes_15(geometry: Geometry) -> bytes:
    """Dataset 15: node numbers and positions, to six digits, as the format has it."""
    rows = [
        f"{node:10d}{0:10d}{0:10d}{1:10d}" + "".join(f"{x:13.5E}" for x in position)
        for node, position in zip(geometry.nodes, geometry.positions_m, strict=True)
    ]
    return _dataset(15, rows)


def lines_82(geometry: Geometry) -> bytes:
    """Datasets 82, one a trace line."""
    return b"".join(
        _dataset(82, [f"{number:10d}{len(line):10d}{1:10d}", f"line {number}", *_in_rows(line)])
        for number, line in enumerate(geometry.lines, start=1)
    )


def function_58(function: Function, number: int, text: bool) -> bytes:
    """Dataset 58 (text, 13 digits) or 58b (binary, single where the values are) with its running number."""
    single = function.values.dtype in (np.float32, np.complex64) and not text and function.abscissa is None
    numbers = _numbers(function, single)
    header = "".join(f"{row:{_LINE}s}\n" for row in _header(function, number, single))
    if text:
        body = _as_text(numbers, function.abscissa is not None)
        return (_END + f"{58:6d}\n{header}{body}" + _END).encode("ascii")
    raw = np.ascontiguousarray(numbers).tobytes()
    kind = f"{58:6d}b{_LITTLE_ENDIAN:6d}{_IEEE:6d}{_HEADER_LINES:12d}{len(raw):12d}{0:6d}{0:6d}{0:12d}{0:12d}\n"
    # By the format the closing line follows the numbers at once.
    return (_END + kind + header).encode("ascii") + raw + _END.encode("ascii")


def _numbers(function: Function, single: bool) -> NDArray[np.floating]:
    """(N, numbers a sample), little-endian: abscissa where uneven, real part, imaginary part where complex."""
    columns: list[NDArray[np.floating] | NDArray[np.complexfloating]]
    columns = [] if function.abscissa is None else [function.abscissa]
    columns += [function.values.real, function.values.imag] if np.iscomplexobj(function.values) else [function.values]
    return np.stack(columns, axis=-1).astype("<f4" if single else "<f8", copy=False)


def _header(function: Function, number: int, single: bool) -> list[str]:
    """The eleven lines of text before the numbers."""
    spoken = [*map(_words, function.identification), *["NONE"] * 5][:5]
    dofs = (function.response, function.reference)
    here, there = ((0, 0) if dof is None else (dof.node, int(dof.direction)) for dof in dofs)
    ordinate = (5 if single else 6) if np.iscomplexobj(function.values) else (2 if single else 4)
    even = function.abscissa is None
    return [
        *spoken,
        f"{function.kind:5d}{number:10d}{0:5d}{0:10d} {'NONE':10s}{here[0]:10d}{here[1]:4d}"
        f" {'NONE':10s}{there[0]:10d}{there[1]:4d}",
        f"{ordinate:10d}{function.values.size:10d}{even:10d}{function.start if even else 0.0:13.5E}"
        f"{function.increment if even else 0.0:13.5E}{0.0:13.5E}",
        *(
            f"{axis.code:10d}{0:5d}{0:5d}{0:5d} {axis.label:20.20s} {axis.unit:20.20s}"
            for axis in (function.axis, function.ordinate, function.denominator, Axis())
        ),
    ]


def _as_text(numbers: NDArray[np.floating], uneven: bool) -> str:
    """Record 12 in double precision: four numbers a line, or with the abscissa one line a sample or two."""
    if not uneven:
        flat = list(map("{:20.12E}".format, numbers.ravel().tolist()))
        return "".join("".join(flat[k : k + 4]) + "\n" for k in range(0, len(flat), 4))
    form = "{:13.5E}" + "{:20.12E}" * (numbers.shape[1] - 1)
    rows = [form.format(*row) for row in numbers.tolist()]
    a_line = 1 if numbers.shape[1] == 3 else 2
    return "".join("".join(rows[k : k + a_line]) + "\n" for k in range(0, len(rows), a_line))


def _in_rows(line: Sequence[int]) -> list[str]:
    filled = [*line, *[0] * (-len(line) % _NUMBERS_A_LINE)]
    return [
        "".join(f"{node:10d}" for node in filled[k : k + _NUMBERS_A_LINE])
        for k in range(0, len(filled), _NUMBERS_A_LINE)
    ]


def _dataset(number: int, rows: Sequence[str]) -> bytes:
    return (_END + f"{number:6d}\n" + "".join(f"{row}\n" for row in rows) + _END).encode("ascii")


def _words(text: str) -> str:
    """Free text as the format takes it: one line of 80 characters of ASCII, NONE for nothing."""
    plain = " ".join(text.split()).encode("ascii", "replace").decode("ascii")
    return "".join(c if c.isprintable() else "?" for c in plain)[:_LINE] or "NONE"
