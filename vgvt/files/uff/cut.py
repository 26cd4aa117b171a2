"""A Universal File cut into its datasets; one that ends too early is told, not left out."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from vgvt.data import InputError
from vgvt.files.uff.data_form import DataForm

_DELIMITER = b"    -1"
_BLANK = b" \t\r\n\x00\x1a"
_HEADER_LINES = 11
_DATA_FORM = 6  # which line of the header
_AGAIN = "export or copy the file again"


@dataclass(frozen=True, slots=True)
class Dataset:
    """One dataset: what stands between two lines that hold -1 alone."""

    number: int
    binary: bool
    place: int
    """Which dataset of the file, counted from 1."""
    identifier: str
    """The line with the dataset's number."""
    lines: tuple[str, ...]
    """Of a dataset 58 the header, of another one everything."""
    body: memoryview
    """The numbers of a dataset 58, as text or binary; empty for the others."""


def cut_file(path: Path) -> tuple[Dataset, ...]:
    """The datasets of a Universal File in order of appearance.

    InputError when the file is missing, empty, no Universal File, or ends within a dataset.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(str(path), f"cannot be read: {error.strerror or error}", "check the path") from error
    if not content:
        raise InputError(str(path), "the file is empty", _AGAIN)
    datasets: list[Dataset] = []
    at = 0
    while at < len(content):
        line, at = _line(content, at)
        if not line.strip(_BLANK):
            continue
        if line.rstrip() != _DELIMITER:
            raise _no_dataset(path, len(datasets), line)
        dataset, at = _dataset(path, content, at, len(datasets) + 1)
        datasets.append(dataset)
    if not datasets:
        raise InputError(str(path), "the file holds blank lines alone", _AGAIN)
    return tuple(datasets)


def check_start(path: Path) -> None:
    """InputError unless a file is there and begins as a Universal File does; nothing more of it is read."""
    try:
        with path.open("rb") as stream:
            line = next((line for line in stream if line.strip(_BLANK)), b"")
    except OSError as error:
        raise InputError(str(path), f"cannot be read: {error.strerror or error}", "check the path") from error
    if not line:
        raise InputError(str(path), "the file is empty", _AGAIN)
    if line.rstrip() != _DELIMITER:
        raise _no_dataset(path, 0, line.rstrip(b"\r\n"))


def _dataset(path: Path, content: bytes, at: int, place: int) -> tuple[Dataset, int]:
    """The dataset that begins at a line with its number, and where the next one begins."""
    where = f"{path}, dataset {place} of the file"
    line, at = _line(content, at)
    if at > len(content):
        raise _cut_off(where)
    number, binary = line[:6].strip(), line[6:7].lower() == b"b"
    if not number.isdigit():
        raise InputError(where, f"damaged: {_shown(line)} stands where a dataset's number belongs", _AGAIN)
    where += f" ({int(number)}{'b' * binary})"
    identifier = _text(line)
    if int(number) != 58:
        end, after = _end_of_text(content, at, where)
        lines = tuple(_text(content[at:end]).splitlines())
        return Dataset(int(number), binary, place, identifier, lines, memoryview(b"")), after
    header: list[str] = []
    for _ in range(_HEADER_LINES):
        line, at = _line(content, at)
        header.append(_text(line))
    if at > len(content):
        raise _cut_off(where)
    end, after = _end_of_numbers(content, at, header, where) if binary else _end_of_text(content, at, where)
    return Dataset(58, binary, place, identifier, tuple(header), memoryview(content)[at:end]), after


def _end_of_text(content: bytes, at: int, where: str) -> tuple[int, int]:
    """Where the line is that closes a dataset of text, and where the next one begins."""
    end = content.find(b"\n" + _DELIMITER, at - 1)
    while end >= 0:
        line, after = _line(content, end + 1)
        # Numbers of other formats may begin like it.
        if line.rstrip() == _DELIMITER:
            return end + 1, after
        end = content.find(b"\n" + _DELIMITER, end + 1)
    raise _cut_off(where)


def _end_of_numbers(content: bytes, at: int, header: list[str], where: str) -> tuple[int, int]:
    """The same for binary numbers, by the size that the header states: their bytes may look like a line's end."""
    try:
        size = DataForm.from_line(header[_DATA_FORM]).binary_bytes
    except ValueError as error:
        raise InputError(where, f"damaged: {error}", _AGAIN) from error
    # By the format the closing line follows at once; some programs put a line end before it.
    for gap in (b"", b"\n", b"\r\n"):
        if content.startswith(gap + _DELIMITER, at + size):
            line, after = _line(content, at + size + len(gap))
            if line.rstrip() == _DELIMITER:
                return at + size, after
    if len(content) < at + size + len(_DELIMITER):
        raise _cut_off(where)
    raise InputError(
        where,
        f"damaged: the {size} bytes of numbers that record 7 states are not followed by the line -1",
        f"{_AGAIN}, as text (58) where the program that wrote it offers both",
    )


def _line(content: bytes, at: int) -> tuple[bytes, int]:
    """The line that begins at a place, without its end, and where the next one begins."""
    end = content.find(b"\n", at)
    end = len(content) if end < 0 else end
    return content[at:end].rstrip(b"\r"), end + 1


def _text(line: bytes) -> str:
    """Lines are ASCII by the format; units and names in them are often not."""
    try:
        return line.decode("utf-8")
    except UnicodeDecodeError:
        return line.decode("latin-1")


def _cut_off(where: str) -> InputError:
    return InputError(where, "truncated: the file ends within this dataset", _AGAIN)


def _no_dataset(path: Path, before: int, line: bytes) -> InputError:
    if before:
        where = f"{path}, after dataset {before} of the file"
        return InputError(where, f"damaged: {_shown(line)} stands between two datasets", _AGAIN)
    return InputError(
        str(path),
        f"not a Universal File: it begins with {_shown(line)}",
        "give a file whose first line holds -1 in columns 5 and 6, or write a sidecar whose [records] say its format",
    )


def _shown(line: bytes) -> str:
    return repr(_text(line[:40]))
