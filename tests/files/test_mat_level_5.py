"""MAT files of version 5 to 7 are read as scipy reads them, and by their specification where scipy writes none."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
import scipy.io
import scipy.sparse

from vgvt.data import InputError
from vgvt.files.mat import read_mat

_TYPES = ("f8", "f4", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "?")


@pytest.mark.parametrize("packed", [False, True])
def test_every_numeric_class_reads_as_scipy_writes_it(tmp_path: Path, packed: bool) -> None:
    rng = np.random.default_rng(0)
    written = {f"x{k}": (90 * rng.random((3, 1 + k))).astype(kind) for k, kind in enumerate(_TYPES)}
    written |= {"row": np.arange(5.0)[None], "block": rng.random((2, 3, 4)), "none": np.zeros((0, 3)), "one": np.eye(1)}
    scipy.io.savemat(tmp_path / "a.mat", written, do_compression=packed)
    for name, array in written.items():
        read = read_mat(tmp_path / "a.mat", [name])[name]
        np.testing.assert_array_equal(read, array)
        assert read.dtype == (np.uint8 if array.dtype == bool else array.dtype)
    assert list(read_mat(tmp_path / "a.mat", ["block", "x0"])) == ["block", "x0"]


@pytest.mark.parametrize("packed", [False, True])
def test_what_holds_no_real_numbers_is_told_in_matlabs_words(tmp_path: Path, packed: bool) -> None:
    others = {
        "cell": np.array([np.eye(2), "a"], dtype=object),
        "struct": {"a": 1.0},
        "char": "words",
        "sparse": scipy.sparse.csc_matrix(np.eye(3)),
        "complex float64": np.eye(2) * 1j,
    }
    scipy.io.savemat(tmp_path / "a.mat", {name[:7]: value for name, value in others.items()}, do_compression=packed)
    for kind in others:
        with pytest.raises(InputError, match=rf"variable '{kind[:7]}' holds no real numbers \({kind}\)"):
            read_mat(tmp_path / "a.mat", [kind[:7]])
    with pytest.raises(InputError, match=r"no variable 'celt'(.|\n)*'cell'"):
        read_mat(tmp_path / "a.mat", ["celt"])


def test_the_text_at_the_start_is_free(tmp_path: Path) -> None:
    """Other programs than MATLAB write their own; version and order of bytes behind it say what the file is."""
    scipy.io.savemat(tmp_path / "a.mat", {"x": np.eye(3)})
    content = (tmp_path / "a.mat").read_bytes()
    (tmp_path / "a.mat").write_bytes(b"Data logger 12, MAT-file of version 5".ljust(124) + content[124:])
    np.testing.assert_array_equal(read_mat(tmp_path / "a.mat", ["x"])["x"], np.eye(3))
    (tmp_path / "a.mat").write_bytes(b"Data logger 12".ljust(400))
    with pytest.raises(InputError, match=r"a\.mat: not a MAT file"):
        read_mat(tmp_path / "a.mat", ["x"])


@pytest.mark.parametrize(("order", "mark"), [("<", b"IM"), (">", b"MI")])
def test_doubles_in_small_types_and_either_order_of_bytes(tmp_path: Path, order: str, mark: bytes) -> None:
    """MATLAB stores doubles that are whole as whole numbers, and up to four bytes within their tag."""
    start = struct.pack(f"{order}2I2I", 6, 8, 6, 0) + struct.pack(f"{order}2I2i", 5, 8, 3, 2)
    name = struct.pack(f"{order}I", 1 << 16 | 1) + b"x\0\0\0"
    numbers = struct.pack(f"{order}2I6h4x", 3, 12, 1, -2, 3, 4, 5, 600)
    matrix = start + name + numbers
    element = struct.pack(f"{order}2I", 14, len(matrix)) + matrix
    version = struct.pack(f"{order}H", 0x100)
    (tmp_path / "a.mat").write_bytes(b"MATLAB".ljust(124) + version + mark + element)
    read = read_mat(tmp_path / "a.mat", ["x"])["x"]
    np.testing.assert_array_equal(read, [[1.0, 4.0], [-2.0, 5.0], [3.0, 600.0]])
    assert read.dtype == np.float64
