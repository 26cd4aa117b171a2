"""Several bungees in a scenario: it says that the aircraft hangs on one spring, and which one stands for them."""

from __future__ import annotations

from pathlib import Path

import pytest

from vgvt.data import InputError
from vgvt.scenario import load_scenario

_HEAD = 'extends = "garteur-sm-ag19"\nname = "three"\nsummary = "Three bungees."\n'


def spring(stiffness: float, hook: str) -> str:
    return f"[[suspension]]\nstiffness_n_per_m = {stiffness}\nhook_m = {hook}\n"


def refused(tmp_path: Path, text: str) -> str:
    path = tmp_path / "three.toml"
    path.write_text(_HEAD + text)
    with pytest.raises(InputError) as caught:
        load_scenario(path)
    return str(caught.value)


def test_three_bungees_are_told_the_spring_that_stands_for_them(tmp_path: Path) -> None:
    said = refused(
        tmp_path,
        spring(1800.0, "[0.5, 0.0, 0.2]") + spring(900.0, "[1.1, 0.3, 0.2]") + spring(900.0, "[1.1, -0.3, 0.2]"),
    )
    assert "suspension: is 3 tables, but the aircraft hangs on one spring" in said
    assert "stiffness_n_per_m = 3600 and hook_m = [0.8, 0, 0.2]" in said
    assert "roll and pitch" in said


def test_without_their_numbers_it_says_how(tmp_path: Path) -> None:
    said = refused(tmp_path, "[[suspension]]\nstiffness_n_per_m = 10.0\n" * 2)
    assert "is 2 tables" in said and "Write one [suspension]: the sum of stiffness" in said


def test_one_table_under_the_heading_of_an_array(tmp_path: Path) -> None:
    assert "Write its heading as [suspension]." in refused(tmp_path, spring(3600.0, "[0.7, 0.0, 0.2]"))


def test_no_spring_and_springs_without_end(tmp_path: Path) -> None:
    assert "suspension: is an empty array, but must be one table" in refused(tmp_path, "suspension = []\n")
    said = refused(tmp_path, spring(float("inf"), "[0.5, 0.0, 0.2]") * 2)
    assert "is 2 tables" in said and "nan" not in said
