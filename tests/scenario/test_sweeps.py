"""Sweeps: designs, keys, values, and refusals that name the nearest key."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.effects import effects_of
from vgvt.effects.whole_numbers import whole_parameters
from vgvt.scenario import load_scenario
from vgvt.scenario.sweeps import Axis, Design, changed, known_keys, sweep


@pytest.fixture(scope="module")
def quick():
    return load_scenario("quick")


def test_a_grid_has_every_combination_and_changes_nothing_else(quick) -> None:
    variants = sweep(quick, [Axis.parse("excitation.duration_s=8,16"), Axis.parse("airframe.beam[wing].cells=6,8,9")])
    assert [(v.scenario.excitation.duration_s, v.scenario.airframe.beam[0].cells) for v in variants] == [
        (8, 6), (8, 8), (8, 9), (16, 6), (16, 8), (16, 9),
    ]  # fmt: skip
    back = {"excitation.duration_s": quick.excitation.duration_s, "airframe.beam[wing].cells": 10}
    assert changed(variants[0].scenario, back).model_copy(update={"name": quick.name}) == quick
    assert len({v.scenario.name for v in variants}) == 6


def test_a_list_goes_in_step(quick) -> None:
    axes = [Axis.parse("excitation.duration_s=8,16"), Axis.parse("excitation.amplitude_v=2,1")]
    variants = sweep(quick, axes, "list")
    assert [tuple(v.values.values()) for v in variants] == [(8, 2), (16, 1)]
    with pytest.raises(InputError, match="different numbers"):
        sweep(quick, [axes[0], Axis.parse("excitation.amplitude_v=1,2,3")], "list")


def test_a_latin_hypercube_has_one_point_in_every_stratum(quick) -> None:
    axes = [Axis.parse("excitation.duration_s=8..24"), Axis.parse("excitation.amplitude_v=0.1..10:log")]
    with pytest.raises(InputError, match=r"KEY=values|no range|no value"):
        Axis.parse("excitation.amplitude_v=10..0.1")
    variants = sweep(quick, axes, "latin", samples=4, seed=3)
    linear = [(v.values["excitation.duration_s"] - 8) / 16 for v in variants]
    logarithmic = [np.log10(v.values["excitation.amplitude_v"] / 0.1) / 2 for v in variants]
    for fractions in (linear, logarithmic):
        assert sorted(int(4 * f) for f in fractions) == list(range(4))
    assert np.argsort(linear).tolist() != np.argsort(logarithmic).tolist()
    again = sweep(quick, axes, "latin", samples=4, seed=3)
    assert [v.values for v in again] == [v.values for v in variants]
    assert [v.values for v in sweep(quick, axes, "latin", samples=4, seed=4)] != [v.values for v in variants]


def test_a_counted_range_is_even(quick) -> None:
    assert Axis.parse("x=1..5:5").values == (1, 2, 3, 4, 5)
    assert Axis.parse("x=0.01..100:5:log").values == pytest.approx((0.01, 0.1, 1, 10, 100))


def test_lists_words_and_another_kind(quick) -> None:
    (moved,) = sweep(quick, [Axis.parse("shaker.position_m=[0.6, 0.1, 0.0]")])
    assert moved.scenario.shaker.position_m == (0.6, 0.1, 0.0)
    kinds = sweep(quick, [Axis.parse("excitation.kind=linear-chirp,logarithmic-chirp")])
    assert [v.scenario.excitation.kind for v in kinds] == ["linear-chirp", "logarithmic-chirp"]


@pytest.mark.parametrize(
    ("key", "nearest"),
    [
        ("excitation.durations", "excitation.duration_s"),
        ("duration_s", "excitation.duration_s"),
        ("airframe.beam[wing].cell", "airframe.beam[wing].cells"),
        ("airframe.beam[tail].cells", "airframe.beam[wing].cells"),
        ("shaker", "shaker."),
    ],
)
def test_an_unknown_key_is_told_its_nearest(quick, key: str, nearest: str) -> None:
    with pytest.raises(InputError) as refusal:
        sweep(quick, [Axis(key, (1.0,))])
    assert nearest in refusal.value.advice


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("excitation.duration_s", "KEY=values"),
        ("excitation.duration_s=5..1", "rising"),
        ("excitation.duration_s=0..1:3:log", "above 0"),
        ("excitation.duration_s=1..2:1", "two values"),
        ("excitation.duration_s={1", "no value"),
        ("excitation.duration_s=10..20:3:logg", r"no value\n.*low\.\.high\[:count\]\[:log\], like 10\.\.20:3:log"),
    ],
)
def test_what_is_no_axis_is_refused(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        Axis.parse(text)


def test_values_that_do_not_fit_are_refused_as_in_a_file(quick) -> None:
    with pytest.raises(InputError, match="duration_s"):
        sweep(quick, [Axis.parse("excitation.duration_s=-3")])
    with pytest.raises(InputError, match="off the part"):
        sweep(quick, [Axis.parse("shaker.position_m=[9.0, 0.0, 0.0]")])


def test_a_refused_value_says_which_entry_it_is_of(quick) -> None:
    with pytest.raises(InputError, match=r"airframe\.beam\[0\]\.cells is 0") as refused:
        changed(quick, {"airframe.beam[wing].cells": 0})
    assert "Counted from 0, beam[0] is 'wing'." in refused.value.advice


def test_every_known_key_can_be_found(quick) -> None:
    keys = known_keys(quick)
    assert len(keys) > 80
    with pytest.raises(InputError, match="is there twice"):
        sweep(quick, [Axis("seed", (1,)), Axis("seed", (2,))])
    with pytest.raises(InputError, match="is there twice"):
        sweep(quick, [Axis("shaker.model", ("a",)), Axis("shaker[model]", ("b",))])
    assert {"excitation.duration_s", "airframe.beam[wing].stations.mass_kg_per_m", "shaker.position_m"} <= set(keys)


@pytest.mark.parametrize(
    "key",
    ["name", "summary", "lesson", "schema_version", "tolerances.damping", "shaker.model", "accelerometers.model",
     "airframe.name", "airframe.configuration", "airframe.sources", "airframe.item[servo-outer].name"],
)  # fmt: skip
def test_what_no_simulation_depends_on_is_refused_and_never_proposed(quick, key: str) -> None:
    with pytest.raises(InputError, match="no simulation depends on it"):
        sweep(quick, [Axis(key, (1, 2))])
    assert key not in known_keys(quick)


def _values(scenario, *texts: str, design: Design = "grid", samples: int = 20) -> list[tuple[object, ...]]:
    variants = sweep(scenario, [Axis.parse(text) for text in texts], design, samples)
    return [tuple(variant.values.values()) for variant in variants]


@pytest.mark.parametrize(
    ("key", "text", "numbers"),
    [
        ("acquisition.bits", "8..16:3", [8, 12, 16]),
        ("airframe.beam[wing].cells", "4..7:7", [4, 5, 6, 7]),
        ("airframe.beam[wing].cells", "4..64:5:log", [4, 8, 16, 32, 64]),
    ],
)
def test_a_range_of_whole_numbers_stays_whole(quick, key: str, text: str, numbers: list[int]) -> None:
    values = [value for (value,) in _values(quick, f"{key}={text}")]
    assert values == numbers
    assert all(type(value) is int for value in values)


def test_a_latin_hypercube_of_whole_numbers_has_each_point_once(quick) -> None:
    bits = [value for (value,) in _values(quick, "acquisition.bits=8..16", design="latin", samples=60)]
    assert sorted(bits) == list(range(8, 17))
    both = _values(quick, "acquisition.bits=8..16", "excitation.duration_s=8..16", design="latin", samples=60)
    assert len(both) == 60
    assert all(type(bits) is int and type(duration_s) is float for bits, duration_s in both)


def test_a_latin_hypercube_of_as_many_samples_as_whole_numbers_has_each_once(quick) -> None:
    """The ends have strata as wide as the others, so no number is there twice and none is left out."""
    axis = Axis.parse("acquisition.repeats=1..5")
    for seed in range(40):
        numbers = [v.values[axis.key] for v in sweep(quick, [axis], "latin", 5, seed)]
        assert sorted(numbers) == [1, 2, 3, 4, 5], f"seed {seed}"
        assert all(type(number) is int for number in numbers)


@pytest.mark.parametrize("text", ["n=1..5", "n=3..40", "n=-2..2", "n=1..5:log", "n=3..40:log"])
def test_a_whole_number_of_an_axis_has_the_fractions_half_a_step_around_it(text: str) -> None:
    axis = Axis.parse(text).in_whole_numbers()
    numbers = np.arange(axis.low, axis.high + 1)
    edges = np.arange(axis.low, axis.high + 2) - 0.5
    scale = np.log if axis.log else np.asarray
    shares = np.diff(scale(edges)) / (scale(edges)[-1] - scale(edges)[0])
    fractions = (np.arange(20000) + 0.5) / 20000
    drawn = [axis.at(float(fraction)) for fraction in fractions]
    assert all(type(number) is int for number in drawn)
    assert [drawn.count(number) / 20000 for number in numbers] == pytest.approx(shares, abs=1e-4)
    assert (axis.at(0.0), axis.at(1.0)) == (axis.low, axis.high)


def test_a_range_between_other_numbers_is_left_alone(quick) -> None:
    assert _values(quick, "excitation.duration_s=8..9:3") == [(8,), (8.5,), (9,)]
    with pytest.raises(InputError, match=r"is 8\.5, but must be a whole number"):
        _values(quick, "acquisition.bits=8.5..16:3")


def test_a_parameter_of_an_effect_can_be_a_whole_number_that_its_table_leaves_out() -> None:
    spoiled = load_scenario("spoiled-payload-change")
    assert "from_run" not in spoiled.effect[0].parameters
    values = [value for (value,) in _values(spoiled, "effect[payload-change].from_run=2..4:3")]
    assert values == [2, 3, 4]
    assert all(type(value) is int for value in values)


@pytest.mark.parametrize(("text", "design"), [("2..4", "latin"), ("2..4:5", "grid"), ("2..4:4:log", "grid")])
def test_whole_parameters_of_effects_get_whole_numbers_and_the_others_do_not(text: str, design: Design) -> None:
    spoiled = load_scenario("spoiled-payload-change")
    axes = [Axis.parse(f"effect[payload-change].{key}={text}") for key in ("from_run", "mass_kg")]
    variants = sweep(spoiled, axes, design, 12, whole_of_effects=whole_parameters())
    from_run, mass_kg = ([v.values[axis.key] for v in variants] for axis in axes)
    assert set(from_run) == {2, 3, 4}
    assert all(type(value) is int for value in from_run)
    assert not all(float(value).is_integer() for value in mass_kg)
    for variant, run in zip(variants, from_run, strict=True):
        assert [effect.from_run for effect in effects_of(variant.scenario)] == [run]


def test_lists_of_lists_are_values(quick) -> None:
    assert _values(quick, "acquisition.runs=[[1,2,3],[4,5,6]],[[1,2],[3,4]]") == [
        ([[1, 2, 3], [4, 5, 6]],), ([[1, 2], [3, 4]],),
    ]  # fmt: skip
    with pytest.raises(InputError, match="is no value"):
        Axis.parse("acquisition.runs=[[1,2],[3]")


def test_a_further_shaker_off_the_aircraft_is_refused_as_in_a_file() -> None:
    two = load_scenario("hati-two-shakers")
    with pytest.raises(InputError, match=r"further_shaker\[0\]\.position_m the drive point at .* off the part"):
        sweep(two, [Axis.parse("further_shaker[0].position_m=[9.0, 0.0, 0.0]")])


@pytest.mark.parametrize(
    ("texts", "idle", "alike"),
    [
        (
            ("excitation.kind=burst-random,linear-chirp", "excitation.blocks=2,4", "excitation.burst_fraction=0.5"),
            "excitation.blocks",
            ("quick-003", "quick-004"),
        ),
        (("shaker.drive=current,voltage", "shaker.coil_resistance_ohm=1.3,2.6"), "shaker.coil_resistance_ohm",
         ("quick-001", "quick-002")),
    ],
)  # fmt: skip
def test_two_variants_that_are_the_same_test_are_refused(
    quick, texts: tuple[str, ...], idle: str, alike: tuple[str, str]
) -> None:
    with pytest.raises(InputError) as refusal:
        _values(quick, *texts)
    assert refusal.value.where == f"--set {idle}"
    assert f"changes nothing for {alike[1]}" in refusal.value.problem
    assert f"the same test as {alike[0]}" in refusal.value.problem


def test_row_by_row_a_kind_can_go_without_its_neighbours_key(quick) -> None:
    texts = ("excitation.kind=linear-chirp,burst-random,burst-random", "excitation.blocks=2,2,4",
             "excitation.burst_fraction=0.5,0.5,0.5")  # fmt: skip
    assert len(_values(quick, *texts, design="list")) == 3


def test_a_value_that_is_there_twice_is_refused(quick) -> None:
    with pytest.raises(InputError, match="is there twice"):
        _values(quick, "excitation.duration_s=8,16,8")


def test_a_key_of_no_kind_that_is_tried_is_refused(quick) -> None:
    with pytest.raises(InputError, match=r"belongs to no excitation\.kind that is tried"):
        _values(quick, "excitation.kind=linear-chirp,logarithmic-chirp", "excitation.blocks=2")
