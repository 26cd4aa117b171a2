"""MAT files of version 5 to 7, element by element: no byte of theirs can lead outside the file.

Source: MathWorks, MAT-File Format, "Level 5 MAT-File Format".
"""

from __future__ import annotations

import math
import os
import struct
import zlib
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

_HEADER_BYTES = 128
_ORDERS = {b"IM": "<", b"MI": ">"}
_MATRIX, _COMPRESSED = 14, 15
_FLAGS, _DIMENSIONS, _NAMES = (6,), (5, 6), (1, 2, 16)
_STORED = dict(
    zip((1, 2, 3, 4, 5, 6, 7, 9, 12, 13), ["i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8", "i8", "u8"], strict=True)
)
_CLASSES = dict(enumerate(["cell", "struct", "object", "char", "sparse"], start=1)) | {
    16: "function handle",
    17: "object",
}
_NUMERIC = dict(enumerate(["f8", "f4", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8"], start=6))
_OPAQUE = 17
_COMPLEX = 0x800
# Flags, dimensions and name of a variable lie within these of its first bytes.
_START_BYTES = 4096
_LARGEST_RATIO = 1100  # deflate reaches 1032


class DamagedMatError(ValueError):
    """What the file holds is not what a MAT file holds there."""


@dataclass(frozen=True, slots=True)
class MatVariable:
    """A variable: ``numbers`` as MATLAB shows them where it holds real ones, and in words what it holds."""

    kind: str
    numbers: NDArray[Any] | None = None


def variables_of(stream: BinaryIO, names: Collection[str]) -> tuple[dict[str, MatVariable], list[str]]:
    """The variables among ``names``, and the names of those that the file holds, up to the last that is asked for.

    The stream stands at the start of the file. ValueError and zlib.error say what is wrong with it.
    """
    order = _byte_order(stream.read(_HEADER_BYTES))
    found: dict[str, MatVariable] = {}
    known: list[str] = []
    for element in _elements(stream, order):
        name = _Matrix.of(element.start(), order).name
        if not name:
            continue  # MATLAB's own, of function handles
        known.append(name)
        if name in names and name not in found:
            found[name] = _Matrix.of(element.whole(), order).variable(order, name)
        if len(found) == len(set(names)):
            break
    return found, known


def _byte_order(header: bytes) -> str:
    if len(header) < _HEADER_BYTES:
        raise DamagedMatError(f"its header has {len(header)} bytes of {_HEADER_BYTES}")
    if header[126:128] not in _ORDERS:
        raise DamagedMatError("its header does not say in which order bytes stand")
    return _ORDERS[header[126:128]]


@dataclass(frozen=True, slots=True)
class _Element:
    """One element of the outermost level: where its content lies, and whether it is compressed."""

    stream: BinaryIO
    order: str
    at: int
    size: int
    compressed: bool

    def start(self) -> bytes:
        """The first bytes of the matrix, without its tag."""
        if not self.compressed:
            return self._read(_START_BYTES)
        return self._unpacked(zlib.decompressobj().decompress(self._read(_START_BYTES), _START_BYTES))[0]

    def whole(self) -> bytes:
        """The bytes of the matrix, without its tag; a wrong checksum is damage."""
        if not self.compressed:
            return self._read(self.size)
        size = self._unpacked(zlib.decompressobj().decompress(self._read(_START_BYTES), 8))[1]
        unpacking = zlib.decompressobj()
        content = unpacking.decompress(self._read(self.size), 8 + size + 1)[8:]
        if len(content) != size:
            raise DamagedMatError(f"{len(content)} bytes unpacked where {size} are announced")
        if not unpacking.eof:  # only at its end the checksum is compared
            raise DamagedMatError("a compressed variable has no end")
        return content

    def _read(self, size: int) -> bytes:
        self.stream.seek(self.at)
        return self.stream.read(min(size, self.size))

    def _unpacked(self, start: bytes) -> tuple[bytes, int]:
        """What follows the tag of a matrix, and the size of the whole by its tag."""
        if len(start) < 8:
            raise DamagedMatError("a compressed variable is cut off")
        kind, size = struct.unpack(f"{self.order}2I", start[:8])
        if kind != _MATRIX or size > _LARGEST_RATIO * self.size:
            raise DamagedMatError("a compressed variable does not unpack to a matrix")
        return start[8:], size


def _elements(stream: BinaryIO, order: str) -> Iterator[_Element]:
    end = stream.seek(0, os.SEEK_END)
    at = _HEADER_BYTES
    while at < end:
        stream.seek(at)
        tag = stream.read(8)
        if len(tag) < 8:
            raise DamagedMatError(f"it is cut off at byte {end}, in the tag of a variable")
        kind, size = struct.unpack(f"{order}2I", tag)
        if kind not in (_MATRIX, _COMPRESSED):
            raise DamagedMatError(f"no variable stands at byte {at}")
        if size > end - at - 8:
            raise DamagedMatError(f"a variable at byte {at} has {size} bytes, of which the file holds {end - at - 8}")
        yield _Element(stream, order, at + 8, size, kind == _COMPRESSED)
        at += 8 + size


@dataclass(frozen=True, slots=True)
class _Matrix:
    """A matrix by its first sub-elements; ``rest`` is where the numbers begin."""

    content: bytes
    class_number: int
    is_complex: bool
    shape: tuple[int, ...]
    name: str
    rest: int

    @classmethod
    def of(cls, content: bytes, order: str) -> _Matrix:
        flags, at = _part(content, 0, order, _FLAGS, "flags")
        if len(flags) != 8:
            raise DamagedMatError(f"a variable has {len(flags)} bytes of flags")
        word = struct.unpack(f"{order}I", flags[:4])[0]
        class_number, shape = word & 0xFF, memoryview(b"")
        if class_number not in _CLASSES and class_number not in _NUMERIC:
            raise DamagedMatError(f"a variable is of class {class_number}, which there is not")
        if class_number != _OPAQUE:
            shape, at = _part(content, at, order, _DIMENSIONS, "dimensions")
        name, at = _part(content, at, order, _NAMES, "name")
        if len(shape) % 4:
            raise DamagedMatError(f"a variable has {len(shape)} bytes of dimensions")
        return cls(
            content=content,
            class_number=class_number,
            is_complex=bool(word & _COMPLEX),
            shape=struct.unpack(f"{order}{len(shape) // 4}i", shape),
            name=bytes(name).rstrip(b"\0").decode("utf-8", "replace"),
            rest=at,
        )

    def variable(self, order: str, name: str) -> MatVariable:
        """What the variable holds, with its numbers where they are real."""
        if self.class_number not in _NUMERIC:
            return MatVariable(_CLASSES[self.class_number])
        kind = np.dtype(_NUMERIC[self.class_number])
        if self.is_complex:
            return MatVariable(f"complex {kind}")
        stored, count = _numbers(self.content, self.rest, order, name), math.prod(self.shape)
        if min(self.shape, default=0) < 0 or stored.size != count:
            shape = " × ".join(map(str, self.shape)) or "no"
            raise DamagedMatError(f"variable {name!r} has {stored.size} numbers for {shape} places")
        if kind.kind != "f" and stored.dtype.kind == "f":
            raise DamagedMatError(f"variable {name!r} holds fractions, and is of whole numbers")
        # Numbers are stored in the smallest type that holds them.
        return MatVariable(str(kind), stored.astype(kind).reshape(self.shape, order="F"))


def _numbers(content: bytes, at: int, order: str, name: str) -> NDArray[Any]:
    stored, _ = _part(content, at, order, tuple(_STORED), f"numbers of {name!r}")
    dtype = np.dtype(order + _STORED[_tag(content, at, order)[0]])
    if len(stored) % dtype.itemsize:
        raise DamagedMatError(f"variable {name!r} has {len(stored)} bytes of numbers of {dtype.itemsize}")
    return np.frombuffer(stored, dtype)


def _tag(content: bytes, at: int, order: str) -> tuple[int, int, int]:
    """Type, size in bytes and place of what a sub-element holds; up to four bytes lie within the tag."""
    if at + 8 > len(content):
        raise DamagedMatError("a variable ends too early")
    kind, size = struct.unpack(f"{order}2I", content[at : at + 8])
    return (kind & 0xFFFF, kind >> 16, at + 4) if kind >> 16 else (kind, size, at + 8)


def _part(content: bytes, at: int, order: str, kinds: tuple[int, ...], what: str) -> tuple[memoryview, int]:
    """The bytes of a sub-element of one of these types, and where the next begins."""
    kind, size, begin = _tag(content, at, order)
    if kind not in kinds:
        raise DamagedMatError(f"the {what} of a variable are of type {kind}")
    room = 4 if begin == at + 4 else len(content) - begin
    if size > room:
        raise DamagedMatError(f"the {what} of a variable have {size} bytes where {room} are")
    end = at + 8 if begin == at + 4 else begin + size + -size % 8
    return memoryview(content)[begin : begin + size], end
