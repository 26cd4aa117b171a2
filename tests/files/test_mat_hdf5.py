"""MAT files of version 7.3: what MATLAB says of a variable counts, and not alone how HDF5 holds it."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io

from vgvt.data import InputError
from vgvt.files.mat import read_mat


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A file as ``save -v7.3`` writes it, with the attributes that MATLAB gives each class."""
    path = tmp_path / "a.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        held: list[tuple[str, np.ndarray, str, dict[str, object]]] = [
            ("x", np.arange(6.0).reshape(2, 3), "double", {}),
            ("flag", np.array([[1, 0]], np.uint8), "logical", {"MATLAB_int_decode": np.int32(1)}),
            ("words", np.array([[104], [105]], np.uint16), "char", {"MATLAB_int_decode": np.int32(2)}),
            ("none", np.array([3, 0], np.uint64), "double", {"MATLAB_empty": np.uint8(1)}),
            ("pairs", np.zeros((2, 2), [("real", "f8"), ("imag", "f8")]), "double", {}),
            ("wrong", np.array([3, 2], np.uint64), "double", {"MATLAB_empty": np.uint8(1)}),
        ]
        for name, array, matlab_class, attributes in held:
            file[name] = array
            file[name].attrs.update({"MATLAB_class": np.bytes_(matlab_class), **attributes})
        for name, attributes in (("thin", {"MATLAB_sparse": np.uint64(3)}), ("tree", {})):
            group = file.create_group(name)
            group.attrs.update({"MATLAB_class": np.bytes_("double" if attributes else "struct"), **attributes})
            group["data"] = np.eye(2)
        file["#refs#/a"] = np.eye(2)
        cells = file.create_dataset("cells", (1, 2), dtype=h5py.ref_dtype)
        cells.attrs["MATLAB_class"] = np.bytes_("cell")
        file["plain"] = np.arange(4.0)
    content = bytearray(path.read_bytes())
    content[:128] = b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM"
    path.write_bytes(content)
    return path


def test_numbers_are_as_matlab_shows_them(path: Path) -> None:
    found = read_mat(path, ["x", "flag", "none", "plain"])
    np.testing.assert_array_equal(found["x"], [[0, 3], [1, 4], [2, 5]])
    np.testing.assert_array_equal(found["flag"], [[1], [0]])
    np.testing.assert_array_equal(found["plain"], np.arange(4.0))
    assert found["none"].shape == (3, 0)  # had been the numbers 3 and 0


@pytest.mark.parametrize(
    ("name", "kind"),
    [("words", "char"), ("thin", "sparse"), ("tree", "struct"), ("cells", "cell"), ("pairs", ".*real.*imag.*")],
)
def test_what_holds_no_real_numbers_is_told_in_matlabs_words(path: Path, name: str, kind: str) -> None:
    """A text had been its characters' numbers, and of a structure it was said that there is none of its name."""
    with pytest.raises(InputError, match=rf"variable '{name}' holds no real numbers \({kind}\)"):
        read_mat(path, [name])


def test_what_is_not_there_and_what_contradicts_itself(path: Path) -> None:
    with pytest.raises(InputError, match=r"no variable 'y'(.|\n)*choose one of: cells, flag(.|\n)*wrong, x"):
        read_mat(path, ["x", "y"])
    with pytest.raises(InputError, match=r"a\.mat: truncated or damaged \(.*is called empty.*\(3, 2\)"):
        read_mat(path, ["wrong"])


@pytest.mark.parametrize("swapped", [False, True])
def test_version_4_is_told_with_what_to_do(tmp_path: Path, swapped: bool) -> None:
    scipy.io.savemat(tmp_path / "a.mat", {"samples": np.eye(3)}, format="4")
    if swapped:  # as a machine with the other order of bytes writes it
        content = (tmp_path / "a.mat").read_bytes()
        numbers = np.frombuffer(content[:20], "<i4") + np.array([1000, 0, 0, 0, 0])
        (tmp_path / "a.mat").write_bytes(numbers.astype(">i4").tobytes() + content[20:])
    with pytest.raises(InputError, match=r"a\.mat: a MAT file of version 4, which is not read\n.*'-v7'"):
        read_mat(tmp_path / "a.mat", ["samples"])
    (tmp_path / "a.mat").write_text("0.1 0.2 0.3 0.4\n0.1 0.2 0.3 0.4\n")
    with pytest.raises(InputError, match=r"a\.mat: not a MAT file"):
        read_mat(tmp_path / "a.mat", ["samples"])
