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


def test_what_is_missing_is_missing_from_the_file_that_asks_for_it(tmp_path: Path) -> None:
    """The parent, whole by itself, had been blamed: a bundled file, that nobody should edit."""
    random = _write(tmp_path, "random", 'extends = "quick"\n[excitation]\nkind = "burst-random"\n')
    above = _write(tmp_path, "above", 'extends = "random.toml"\nseed = 3\n')
    for scenario in (random, above):
        with pytest.raises(InputError) as caught:
            load_scenario(scenario)
        assert caught.value.where == f"{random}: excitation.blocks"


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


def _effect(channels: str) -> str:
    return f'[[effect]]\nname = "sign-flip"\nchannels = "{channels}"\n'


@pytest.mark.parametrize(
    ("parent", "channels"),
    [("spoiled-base", ["1+Z", "5+Z"]), ("spoiled-sign-flip", ["1+Z", "5+Z"]), ("spoiled-sign-flip", ["5+Z"])],
)
def test_effects_of_one_name_stay_as_many_as_are_written(tmp_path: Path, parent: str, channels: list[str]) -> None:
    text = f'extends = "{parent}"\n' + "".join(map(_effect, channels))
    effects = load_scenario(_write(tmp_path, "mine", text)).effect
    assert [e.parameters["channels"] for e in effects] == channels


def test_the_second_effect_of_a_name_changes_the_parents_second(tmp_path: Path) -> None:
    _write(tmp_path, "base", 'extends = "spoiled-base"\n' + _effect("1+Z") + _effect("5+Z"))
    child = _write(tmp_path, "child", 'extends = "base.toml"\n' + _effect("1+Z") + _effect("10+Z") + _effect("5+Z"))
    assert [e.parameters["channels"] for e in load_scenario(child).effect] == ["1+Z", "10+Z", "5+Z"]


@pytest.mark.parametrize("name", ["servo-outer", "camera"])
def test_an_item_that_a_file_names_twice_is_refused(tmp_path: Path, name: str) -> None:
    item = f'[[airframe.item]]\nname = "{name}"\nmass_kg = 0.1\nposition_m = [0.1, 0.0, 0.0]\n'
    path = _write(tmp_path, "mine", f'extends = "quick"\n{item}{item}')
    with pytest.raises(InputError, match=f"is '{name}', which is taken") as caught:
        load_scenario(path)
    assert caught.value.where == f"{path}: airframe.item[1].name"


def test_a_beam_that_a_file_names_twice_is_refused(tmp_path: Path) -> None:
    beam = '[[airframe.beam]]\nname = "wing"\ncells = {}\n'
    path = _write(tmp_path, "mine", f'extends = "quick"\n{beam.format(6)}{beam.format(8)}')
    with pytest.raises(InputError, match="is 'wing', which is taken") as caught:
        load_scenario(path)
    assert caught.value.where == f"{path}: airframe.beam[1].name"


def _shaker(node: int, x_m: float) -> str:
    return (
        f"[[shaker]]\nnode = {node}\nposition_m = [{x_m}, 0.0, 0.0]\ncoil_resistance_ohm = 1.3\n"
        "force_factor_n_per_a = 30.0\narmature_mass_kg = 0.2\nflexure_stiffness_n_per_m = 2000.0\n"
        "flexure_damping_n_s_per_m = 20.0\n"
    )


def test_an_array_of_shakers_replaces_all_that_are_inherited(tmp_path: Path) -> None:
    text = 'extends = "hati-two-shakers"\n'
    two = load_scenario(_write(tmp_path, "two", text + _shaker(100, 0.6) + _shaker(101, 0.7)))
    assert [s.position_m[0] for s in two.shakers] == [0.6, 0.7]
    assert two.excitation.shakers == "uncorrelated"
    further = _shaker(102, 0.7).replace("[[shaker]]", "[[further_shaker]]")
    mixed = load_scenario(_write(tmp_path, "mixed", text + _shaker(100, 0.6) + further))
    assert [s.node for s in mixed.shakers] == [100, 102]


@pytest.mark.parametrize("shakers", [_shaker(100, 0.6), "further_shaker = []\n"])
def test_a_file_that_leaves_one_shaker_of_several_drops_what_only_several_have(tmp_path: Path, shakers: str) -> None:
    """The parent states ``excitation.shakers``, which no file that extends it could unset."""
    text = 'extends = "hati-two-shakers"\n' + shakers
    parent = load_scenario("hati-two-shakers")
    one = load_scenario(_write(tmp_path, "one", text))
    assert parent.excitation.shakers == "uncorrelated"
    assert len(one.shakers) == 1
    assert one.excitation == parent.excitation.model_copy(update={"shakers": None})
    own = _write(tmp_path, "own", text + '[excitation]\nshakers = "orthogonal"\n')
    with pytest.raises(InputError, match="is for several shakers, and there is one") as caught:
        load_scenario(own)
    assert caught.value.where == f"{own}: excitation.shakers"
    assert load_scenario(_write(tmp_path, "of-one", 'extends = "one.toml"\n')).excitation == one.excitation


def test_a_table_of_one_shaker_changes_the_first_of_an_array(tmp_path: Path) -> None:
    base = 'extends = "hati-two-shakers"\n' + _shaker(100, 0.6) + _shaker(101, 0.7)
    _write(tmp_path, "base", base)
    child = load_scenario(_write(tmp_path, "child", 'extends = "base.toml"\n[shaker]\namplifier_gain = 3.0\n'))
    assert [(s.position_m[0], s.amplifier_gain) for s in child.shakers] == [(0.6, 3.0), (0.7, 1.0)]


def test_the_file_that_wrote_a_further_shaker_is_named(tmp_path: Path) -> None:
    base = _write(tmp_path, "base", 'extends = "hati-two-shakers"\n' + _shaker(100, 0.6) + _shaker(100, 0.7))
    child = _write(tmp_path, "child", 'extends = "base.toml"\nseed = 3\n')
    with pytest.raises(InputError, match="is 100, which is taken") as caught:
        load_scenario(child)
    assert caught.value.where == f"{base}: further_shaker[0].node"
