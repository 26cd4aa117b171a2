"""What a file cannot hold of a campaign is told before anything is written: where it is, and what to write instead."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from vgvt.data import Campaign, Geometry, InputError, Record

_HALF = re.compile("[\ud800-\udfff]")
# Doubles hold whole numbers up to here.
_WHOLE = 2**53
_SINGLE_DOUBLE = "use 32 or 64 bit floats: numpy's astype(float) rounds to these"


def check_numbers(array: NDArray[Any], where: str, what: str) -> None:
    """InputError where an array (of any shape) of real numbers would not be the same in 64 bit."""
    kind, size = array.dtype.kind, array.dtype.itemsize
    if kind not in "fiub":
        problem = "complex" if kind == "c" else f"of type {array.dtype}"
        raise InputError(where, f"{what} are {problem}, and no real numbers", "write real numbers")
    if kind == "f" and size > 8:
        problem = f"{what} of type {array.dtype} cannot be stored without loss"
        raise InputError(where, problem, _SINGLE_DOUBLE)
    if kind in "iu" and size > 4 and array.size and not -_WHOLE <= int(array.min()) <= int(array.max()) <= _WHOLE:
        problem = f"{what} are whole numbers beyond 2**53, which cannot be stored without loss"
        raise InputError(where, problem, _SINGLE_DOUBLE)


def check_samples(campaign: Campaign, path: Path) -> None:
    """InputError where samples of a run would not be the same in 64 bit floats."""
    for record in campaign.runs:
        check_numbers(record.samples, f"{path}: run {record.run}", "samples")


def check_texts(campaign: Campaign, path: Path) -> None:
    """InputError where a text, or the file's name, cannot be written in a sidecar."""
    check_file_name(path, path.name)
    for place, text in _texts(campaign):
        check_text(text, f"{path}: {place}")


def check_labels(campaign: Campaign, path: Path) -> None:
    """InputError where the name of a campaign, or of a channel, cannot be written in a netCDF-4 file; notes all can."""
    for place, text in _labels(campaign):
        check_text(text, f"{path}: {place}")
        if "\0" in text:
            advice = f"leave it out: {text.replace(chr(0), '')!r}"
            raise InputError(f"{path}: {place}", f"{text!r} holds a NUL, which ends a text in such a file", advice)


def check_text(text: str, where: str) -> None:
    """InputError for half a character, as names of files leave it whose bytes are not UTF-8: no file holds it."""
    half = _HALF.search(text)
    if half:
        problem = f"{text!r} holds U+{ord(half[0]):04X}, half a character, which no text file can hold"
        raise InputError(where, problem, f"write another text, like {_HALF.sub('?', text)!r}")


def check_file_name(path: Path, name: str) -> None:
    """InputError for a file or folder whose ``name`` a sidecar cannot say."""
    if _HALF.search(name):
        raise InputError(str(path), f"its name {name!r} is not in UTF-8, and no sidecar could say it", "rename it")


def check_nodes(geometry: Geometry, path: Path, largest: int, what: str) -> None:
    """InputError where a node's number is beyond the ``largest`` that a format, called ``what``, has room for."""
    beyond = [node for node in geometry.nodes if abs(node) > largest]
    if beyond:
        problem = f"node {beyond[0]}: {what} has room for numbers up to {largest}"
        raise InputError(str(path), problem, "number the nodes otherwise, or write another format")


def _labels(campaign: Campaign) -> Iterator[tuple[str, str]]:
    yield "name", campaign.name
    for record in campaign.runs:
        for k, channel in enumerate(record.channels, start=1):
            yield f"run {record.run}, name of channel {k}", channel.name
            yield f"run {record.run}, unit of channel {k}", channel.unit


def _texts(campaign: Campaign) -> Iterator[tuple[str, str]]:
    """Every text, and where it is."""
    yield from _labels(campaign)
    for key, note in campaign.notes.items():
        yield f"name of note {key!r}", key
        yield f"note {key!r}", note
    for record in campaign.runs:
        yield from _notes(record)


def _notes(record: Record) -> Iterator[tuple[str, str]]:
    yield from ((f"run {record.run}, overloaded", name) for name in record.overloaded)
    yield from ((f"run {record.run}, note {k}", note) for k, note in enumerate(record.notes, start=1))
