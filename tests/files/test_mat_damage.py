"""MAT files of version 5 to 7 whose bytes are wrong are told as damaged, whatever scipy makes of them."""

from __future__ import annotations

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


def test_whatever_scipy_raises_is_bad_input(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One wrong byte of an uncompressed file made it divide by zero."""

    def dividing(*_args: object, **_settings: object) -> None:
        raise ZeroDivisionError("integer division or modulo by zero")

    scipy.io.savemat(tmp_path / "a.mat", {"x": np.eye(2)})
    monkeypatch.setattr(scipy.io, "loadmat", dividing)
    with pytest.raises(InputError, match="truncated or damaged"):
        read_mat(tmp_path / "a.mat", ["x"])
