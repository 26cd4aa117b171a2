"""MAT files of version 5 to 7 whose bytes are wrong are told as damaged, and never lead anywhere else."""

from __future__ import annotations

import itertools
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
import scipy.io

from vgvt.data import InputError
from vgvt.files.mat import read_mat


def test_any_wrong_byte_of_a_compressed_file_is_told_or_harmless(tmp_path: Path) -> None:
    """Its checksum knows: what is read at all is what was written."""
    written = np.random.default_rng(0).normal(size=(7, 3))
    scipy.io.savemat(tmp_path / "a.mat", {"x": written}, do_compression=True)
    content = (tmp_path / "a.mat").read_bytes()
    told = 0
    for at in range(124, len(content)):
        damaged = bytearray(content)
        damaged[at] ^= 0x55
        (tmp_path / "a.mat").write_bytes(bytes(damaged))
        try:
            np.testing.assert_array_equal(read_mat(tmp_path / "a.mat", ["x"])["x"], written)
        except InputError:
            told += 1
    assert told > 0.9 * (len(content) - 124)


def test_a_compressed_variable_without_an_end_is_told(tmp_path: Path) -> None:
    """Its checksum stands behind the end: one of 20000 single wrong bits gave other numbers, as many as announced."""
    scipy.io.savemat(tmp_path / "a.mat", {"x": np.eye(3)})
    content = (tmp_path / "a.mat").read_bytes()
    packing = zlib.compressobj()
    packed = packing.compress(content[128:]) + packing.flush(zlib.Z_SYNC_FLUSH)
    for end, told in ((packing.flush(), False), (b"", True)):
        element = struct.pack("<2I", 15, len(packed + end)) + packed + end
        (tmp_path / "a.mat").write_bytes(content[:128] + element)
        if told:
            with pytest.raises(InputError, match="a compressed variable has no end"):
                read_mat(tmp_path / "a.mat", ["x"])
        else:
            np.testing.assert_array_equal(read_mat(tmp_path / "a.mat", ["x"])["x"], np.eye(3))


def test_no_wrong_byte_of_an_uncompressed_file_leads_out_of_it(tmp_path: Path) -> None:
    """A number's type that there is not had ended the process: scipy looks it up beyond the end of a table."""
    scipy.io.savemat(tmp_path / "a.mat", {"text": "abc", "x": np.eye(3), "t": np.arange(4)})
    content = (tmp_path / "a.mat").read_bytes()
    told = 0
    for at, wrong in itertools.product(range(len(content)), (0x00, 0x08, 0x10, 0x7F, 0xFF)):
        (tmp_path / "a.mat").write_bytes(content[:at] + bytes([wrong]) + content[at + 1 :])
        try:
            read_mat(tmp_path / "a.mat", ["x", "t"])
        except InputError as error:
            told += "a.mat" in error.where and bool(error.advice)
    assert told > len(content)


def test_a_file_that_is_cut_anywhere_is_told(tmp_path: Path) -> None:
    for packed in (False, True):
        scipy.io.savemat(tmp_path / "a.mat", {"x": np.eye(3)}, do_compression=packed)
        content = (tmp_path / "a.mat").read_bytes()
        for size in range(len(content)):
            (tmp_path / "a.mat").write_bytes(content[:size])
            with pytest.raises(InputError, match=r"a\.mat: (truncated|the file is empty|not a MAT|no variable 'x')"):
                read_mat(tmp_path / "a.mat", ["x"])


def test_a_damaged_count_asks_for_no_memory(tmp_path: Path) -> None:
    """A variable of 4 GiB by its tag, in a file of 200 bytes."""
    packed = zlib.compress(struct.pack("<2I", 14, 0xFFFFFFF8) + bytes(64))
    element = struct.pack("<2I", 15, len(packed)) + packed
    (tmp_path / "a.mat").write_bytes(b"MATLAB".ljust(124) + b"\0\1IM" + element)
    with pytest.raises(InputError, match="truncated or damaged"):
        read_mat(tmp_path / "a.mat", ["x"])
