"""Rows of the study as a table on disk that reads back as it was, and what a fresh folder adds to the baseline."""

from __future__ import annotations

import csv
from collections.abc import Container, Iterable, Sequence
from pathlib import Path
from typing import Any

from kept_documents import cut_off, read_kept
from loop_cases import SHORT
from virtual_lab import PAGES

from vgvt.data import InputError
from vgvt.files.atomically import replacing

Row = dict[str, Any]
BASELINES = PAGES.parents[1] / "scoreboard" / "baselines"
CASES = BASELINES / "closing-the-loop-cases.csv"
_TEXTS = frozenset(
    ("group", "truth", "source", "engine", "core", "verdict", "named", "answer", "place", "leads", "deviations",
     "settings", "reason")
)  # fmt: skip
_FLAGS = {"True": True, "False": False}
# What makes a case the same case, whichever version judged it.
_CASE = ("seed", "group", "truth", "draw", "size", "noise", "source", "engine", "catalogue")


def kept(folder: Path, done_again: Container[str] = ()) -> list[Row]:
    """The rows of every case in a folder, whichever plan it belongs to.

    InputError for one that is cut off, unless it is among those that are done again, which it is without a word.
    """
    rows: list[Row] = []
    for file in sorted((folder / "cells").glob("*.json")):
        try:
            rows += _rows(file)
        except InputError:
            if file.stem not in done_again:
                raise
    return rows


def _rows(file: Path) -> list[Row]:
    advice = "remove it: the case is done again when the study goes on in this folder"
    document = read_kept(file, advice)
    rows: list[Row] | None = document.get("rows") if isinstance(document, dict) else None
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise cut_off(file, advice)
    return rows


def write_rows(rows: Sequence[Row], file: Path) -> None:
    """All rows as one long table, with every column that any of them has."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    with replacing(file) as part, part.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, names, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def read_rows(file: Path) -> list[Row]:
    """The rows that :func:`write_rows` wrote: numbers, flags and texts again; an empty number is None.

    InputError for a number that is none, with its line.
    """
    with file.open(encoding="utf-8", newline="") as stream:
        found = csv.DictReader(stream)
        return [{k: _value(k, v, f"{file.name}, line {found.line_num}") for k, v in row.items()} for row in found]


def _value(name: str, text: str | None, where: str) -> str | float | bool | None:
    """What a field of the table says."""
    if name in _TEXTS:
        return text or ""
    if not text:
        return None
    if text in _FLAGS:
        return _FLAGS[text]
    try:
        number = float(text)
    except ValueError as error:
        raise InputError(where, f"{name} is {text!r}", "write a number there, or nothing") from error
    return int(number) if text.lstrip("-").isdigit() else number


def with_whole_catalogue(rows: Iterable[Row]) -> list[Row]:
    """Rows of campaigns for which every effect was to choose from, but for one that was taken out."""
    return [r for r in rows if int(r["catalogue"]) > len(SHORT)]


def merged(old: Sequence[Row], new: Sequence[Row]) -> list[Row]:
    """Old rows and new ones; a case that is there keeps its first row, as only that was judged blind.

    Rows of older versions do not say their seed; none of them is taken for a new one.
    """
    known = {_identity(row) for row in old}
    return [*old, *(row for row in new if _identity(row) not in known)]


def _identity(row: Row) -> tuple[str, ...]:
    return tuple(str(row.get(name)) for name in _CASE)
