"""Derivatives kept on disk: a file that was broken off is as good as none."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from reconciled_case import small_scenario

from vgvt.reconcile.question import problem as asking
from vgvt.reconcile.question.problem import MATRICES, _kept


def broken_off(file: Path) -> None:
    """Half of it reached the disk."""
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) // 2])


def emptied(file: Path) -> None:
    """Nothing of it did."""
    file.write_bytes(b"")


def scribbled(file: Path) -> None:
    """Something else did."""
    file.write_bytes(b"not what was written here" * 9)


def of_other_names(file: Path) -> None:
    """A file of this kind that lacks a matrix."""
    np.savez(file, mass=np.eye(2))


@pytest.mark.parametrize("spoil", [broken_off, emptied, scribbled, of_other_names])
def test_a_spoilt_file_is_computed_again(tmp_path: Path, spoil: Callable[[Path], None]) -> None:
    scenario = small_scenario()
    start, _, _ = asking._hung(scenario, scenario, 60.0)
    known = asking.unknowns(scenario)[:1]
    first = asking._slopes(start.scenario, known, start.layouts, start.structure, tmp_path)
    (file,) = tmp_path.iterdir()
    spoil(file)
    again = asking._slopes(start.scenario, known, start.layouts, start.structure, tmp_path)
    assert all(np.array_equal(first[name], again[name]) for name in MATRICES)
    kept = _kept(file)
    assert kept is not None and set(kept) == set(MATRICES)
