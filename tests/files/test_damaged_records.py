"""Damaged record files: told as bad input, and not parsed where their hash is already wrong."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.files import measured_records, open_campaign
from vgvt.files.delimited_text import read_delimited
from vgvt.files.npz import read_npz

Edit = Callable[[str, str], Path]


def test_a_file_with_a_wrong_hash_is_not_parsed(bench: Path, edited: Edit, monkeypatch: pytest.MonkeyPatch) -> None:
    edited('file = "run1.mat"', f'file = "run1.mat"\nsha256 = "{"0" * 64}"')
    parsed: list[object] = []
    monkeypatch.setattr(measured_records, "read_mat", lambda *given: parsed.append(given) or {})
    with pytest.raises(InputError, match=r"run1\.mat: truncated or damaged, or not the file(.|\n)*000000000000"):
        open_campaign(bench)
    assert not parsed


@pytest.mark.parametrize("packed", [False, True])
def test_no_wrong_byte_of_an_archive_gets_through(tmp_path: Path, packed: bool) -> None:
    path, numbers = tmp_path / "a.npz", np.random.default_rng(0).standard_normal((4, 3))
    (np.savez_compressed if packed else np.savez)(path, x=numbers)
    whole = path.read_bytes()
    refused = 0
    for at in range(len(whole)):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 0x2A]) + whole[at + 1 :])
        try:
            np.testing.assert_array_equal(read_npz(path, ["x"])["x"], numbers, strict=True)
        except InputError:
            refused += 1
    assert refused > 200


def test_a_header_that_is_no_python_is_damage(tmp_path: Path) -> None:
    """An archive whose checksums are right and whose array was damaged before it was packed."""
    import zipfile

    plain = tmp_path / "x.npy"
    np.save(plain, np.arange(3.0))
    for old, new in ((b"(3,)", b"(3,("), (b"(3,)", b"(2,)"), (b"(3,)", b"(9,)"), (b"NUMPY", b"NUMPI")):
        with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
            archive.writestr("x.npy", plain.read_bytes().replace(old, new))
        with pytest.raises(InputError, match=r"a\.npz: damaged"):
            read_npz(tmp_path / "a.npz", ["x"])


@pytest.mark.parametrize("delimiter", ["\\t", ", ", "#", "\n"])
def test_a_delimiter_that_cannot_be_one_is_refused(edited: Edit, tmp_path: Path, delimiter: str) -> None:
    written = delimiter.replace("\n", "\\n") if delimiter == "\n" else delimiter.replace("\\", "\\\\")
    edited('samples = "data"\ntime_s = "t"\n', "")
    path = edited('format = "mat"', f'format = "csv"\ndelimiter = "{written}"')
    with pytest.raises(InputError, match=r"records\.delimiter: .* cannot stand between columns\n.*one character"):
        open_campaign(path)
    table = tmp_path / "table.csv"
    table.write_text("1,2\n3,4\n")
    with pytest.raises(InputError, match="cannot stand between columns"):
        read_delimited(table, delimiter)


def test_columns_between_tabs_and_white_space(tmp_path: Path) -> None:
    table = tmp_path / "table.txt"
    table.write_text("1\t2\n3\t4\n")
    for delimiter in ("\t", ""):
        np.testing.assert_array_equal(read_delimited(table, delimiter), [[1, 2], [3, 4]])
