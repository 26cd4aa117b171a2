"""Fields of a line in fixed columns, as FORTRAN writes them."""

from __future__ import annotations

from collections.abc import Sequence


def in_columns(line: str, widths: Sequence[int]) -> list[str]:
    """The fields of a line, without the blanks around them; those beyond its end are empty."""
    fields, at = [], 0
    for width in widths:
        fields.append(line[at : at + width].strip())
        at += width
    return fields


def among_names(line: str, widths: Sequence[int], names: Sequence[int]) -> list[str]:
    """The fields of a line that holds names as well, which may hold blanks: in columns, unless a number lacks there.

    FORTRAN leaves no number out: where one is missing, the columns were missed, and blanks tell the fields.
    """
    fields, words = in_columns(line, widths), line.split()
    full = all(field for k, field in enumerate(fields) if k not in names)
    return fields if full or len(words) != len(widths) else words


def apart(line: str, widths: Sequence[int]) -> list[str]:
    """The fields of a line of numbers: between blanks where there are as many, else in columns."""
    words = line.split()
    return words if len(words) == len(widths) else in_columns(line, widths)


def whole(text: str) -> int:
    """A whole number, 0 where the field is empty; ValueError otherwise."""
    return int(text) if text else 0


def real(text: str) -> float:
    """A number, with FORTRAN's D for its exponent as well, 0 where the field is empty; ValueError otherwise."""
    return float(text.upper().replace("D", "E")) if text else 0.0
