"""Scenarios that extend another: what is taken over, what is replaced, and which file is to blame."""

from __future__ import annotations

from pathlib import Path

import pytest

from vgvt.data import InputError
from vgvt.scenario import load_scenario


def _write(folder: Path, name: str, text: str) -> Path:
    path = folder / f"{name}.toml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f'name = "{path.stem}"\nsummary = "A trial."\n{text}', encoding="utf-8")
    return path


def test_tables_merge_and_arrays_are_replaced(tmp_path: Path) -> None:
    parent = load_scenario("hati-unsymmetric")
    mine = load_scenario(
        _write(
            tmp_path,
            "mine",
            "[acquisition]\nruns = [[3]]\n[shaker]\namplifier_gain = 9.0\n".join(
                ('extends = "hati-unsymmetric"\n', "")
            ),
        )
    )
    assert mine.acquisition.runs == ((3,),)
    assert mine.acquisition.sample_rate_hz == parent.acquisition.sample_rate_hz
    assert mine.shaker == parent.shaker.model_copy(update={"amplifier_gain": 9.0})
    assert mine.airframe == parent.airframe


def test_named_entries_merge_and_new_ones_are_added(tmp_path: Path) -> None:
    parent = load_scenario("quick").airframe
    text = (
        'extends = "quick"\n[[airframe.item]]\nname = "servo-outer"\nmass_kg = 0.1\n'
        '[[airframe.item]]\nname = "camera"\nmass_kg = 0.2\nposition_m = [0.1, 0.0, 0.0]\n'
    )
    mine = load_scenario(_write(tmp_path, "mine", text)).airframe
    assert [i.name for i in mine.item] == [*(i.name for i in parent.item), "camera"]
    changed = {i.name: i for i in mine.item}["servo-outer"]
    assert changed == {i.name: i for i in parent.item}["servo-outer"].model_copy(update={"mass_kg": 0.1})


def test_words_about_a_file_are_its_own(tmp_path: Path) -> None:
    assert load_scenario(_write(tmp_path, "mine", 'extends = "quick"\n')).lesson == ""
    (tmp_path / "nameless.toml").write_text('extends = "quick"\n', encoding="utf-8")
    with pytest.raises(InputError, match="name: is missing"):
        load_scenario(tmp_path / "nameless.toml")


def test_parents_are_found_beside_the_file(tmp_path: Path) -> None:
    _write(tmp_path, "deep/base", 'extends = "quick"\nseed = 11\n')
    middle = _write(tmp_path, "deep/middle", 'extends = "base.toml"\n')
    assert load_scenario(middle).seed == 11
    assert load_scenario(_write(tmp_path, "top", 'extends = "deep/middle.toml"\n')).seed == 11


def test_the_file_that_wrote_the_mistake_is_named(tmp_path: Path) -> None:
    base = _write(tmp_path, "base", 'extends = "quick"\n[suspension]\nstiffness_n_per_m = -1.0\n')
    child = _write(tmp_path, "child", 'extends = "base.toml"\n[suspension]\nfree_length_m = 1.0\n')
    with pytest.raises(InputError) as caught:
        load_scenario(child)
    assert caught.value.where == f"{base}: suspension.stiffness_n_per_m"
    both = _write(tmp_path, "both", 'extends = "base.toml"\n[suspension]\nfree_length_m = -1.0\n')
    with pytest.raises(InputError) as caught:
        load_scenario(both)
    assert caught.value.where == str(both)
    assert f"suspension.stiffness_n_per_m (written in {base})" in caught.value.advice
    assert "suspension.free_length_m: " in caught.value.advice


def test_a_correction_clears_the_parents_mistake(tmp_path: Path) -> None:
    _write(tmp_path, "base", 'extends = "quick"\n[suspension]\nstiffness_n_per_m = -1.0\n')
    child = _write(tmp_path, "child", 'extends = "base.toml"\n[suspension]\nstiffness_n_per_m = 65.0\n')
    assert load_scenario(child).suspension.stiffness_n_per_m == 65.0


@pytest.mark.parametrize("length", [1, 2, 3])
def test_cycles_are_told(tmp_path: Path, length: int) -> None:
    for i in range(length):
        _write(tmp_path, f"s{i}", f'extends = "s{(i + 1) % length}.toml"\n')
    with pytest.raises(InputError, match=r"extend each other: s0\.toml -> "):
        load_scenario(tmp_path / "s0.toml")


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ('extends = "hati-unsymetric"', "Did you mean hati-unsymmetric"),
        ('extends = "gone.toml"', "there is no file"),
        ("extends = 3", "not a name"),
        ('extends = ""', "not a name"),
    ],
)
def test_missing_parents_are_told(tmp_path: Path, line: str, words: str) -> None:
    path = _write(tmp_path, "mine", line + "\n")
    with pytest.raises(InputError) as caught:
        load_scenario(path)
    assert caught.value.where == f"{path}: extends"
    assert words in str(caught.value)
