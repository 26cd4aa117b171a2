"""Full scales of the instruments: what a scenario may ask for, and what a level would reach of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from vgvt.data import InputError
from vgvt.scenario import Scenario, load_scenario, to_toml
from vgvt.scenario.full_scale import expected_overloads, scales_of_acceleration, scales_of_force
from vgvt.scenario.rig import Excitation
from vgvt.scenario.used import used_tables


def written(folder: Path, text: str) -> Scenario:
    file = folder / "mine.toml"
    file.write_text(f'extends = "quick"\nname = "mine"\nsummary = "Mine."\n{text}')
    return load_scenario(file)


def test_the_bundled_instruments_end_where_the_papers_say() -> None:
    for name in ("hati-unsymmetric", "skoll-gvt1", "bff", "quick"):
        scenario = load_scenario(name)
        assert (scenario.transducer.range_n, scenario.accelerometers.range_g) == (44.5, 500.0)
    assert load_scenario("skoll-gvt2").generator.range_v == 10.0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[excitation]\namplitude_v = 15.0\n", r"amplitude_v.*\n? *is 15, but the generator gives 10 V at most"),
        (
            '[excitation]\nkind = "random"\namplitude_v = 10.5\n',
            r"is 10\.5, but the generator gives 10 V .*root mean square alone",
        ),
        ("[generator]\nrange_v = 0.5\n", r"is 1, but the generator gives 0\.5 V .*peak"),
        ("[generator]\nrange_v = 0.0\n", r"range_v"),
        ("[transducer]\nrange_n = -1.0\n", r"range_n"),
    ],
)
def test_a_level_beyond_the_generator_is_refused_with_its_place(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        written(tmp_path, text)


def test_a_hammer_has_no_level_for_a_generator_to_give() -> None:
    struck = load_scenario("teaching-beam-hammer")
    limited = struck.model_copy(update={"generator": struck.generator.model_copy(update={"range_v": 1e-3})})
    assert Scenario.model_validate(limited.model_dump()) == limited
    assert used_tables(limited) == used_tables(struck)


def test_steps_without_a_range_are_refused(tmp_path: Path) -> None:
    text = "[generator]\nbits = 16\n"
    file = tmp_path / "mine.toml"
    file.write_text(f'extends = "teaching-beam"\nname = "mine"\nsummary = "Mine."\n{text}')
    with pytest.raises(InputError, match=r"range_v.*missing, and bits divides it into steps"):
        load_scenario(file)


def test_the_keys_come_back_from_their_text(tmp_path: Path) -> None:
    text = "[generator]\nbits = 16\n[accelerometers]\nrange_g = 5.0\n[transducer]\nrange_n = 20.0\n"
    scenario = written(tmp_path, text)
    again = tmp_path / "again.toml"
    again.write_text(to_toml(scenario))
    assert load_scenario(again) == scenario
    assert (scenario.generator.bits, scenario.generator.model) == (16, "NI 9269")


def test_the_first_end_on_the_way_is_told_with_what_it_is_of() -> None:
    scenario = load_scenario("quick")
    force, acceleration = scales_of_force(scenario), scales_of_acceleration(scenario)
    assert [round(s.si, 1) for s in force] == [44.5, round(62.58 / 0.1053, 1)]
    assert [round(s.si / 9.80665, 1) for s in acceleration] == [500.0, 60.9]
    assert expected_overloads(scenario, 44.4, 60.0 * 9.8, 10.0) == ()
    told = expected_overloads(scenario, 45.0, 61.0 * 9.81, 10.1)
    assert [words.split(" is beyond ")[1].split(":")[0] for words in told] == [
        "the force transducer's ±44.5 N",
        "the converter's ±62.58 V",
        "the generator's ±10 V",
    ]


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"unrecorded_s": 120.0}, r"unrecorded_s.*leaves nothing of duration_s 120"),
        ({"unrecorded_s": 7.0, "lead_in_s": 1.0}, r"lead_in_s.*begins when the shaker has run"),
        ({"unrecorded_s": -1.0}, "unrecorded_s"),
        ({"unrecorded_s": 7.0, "kind": "stepped-sine", "points": 9, "settle_s": 1.0}, "does not belong to kind"),
        ({"unrecorded_s": 7.0, "kind": "impact", "blocks": 3}, "does not belong to kind"),
    ],
)
def test_a_record_that_cannot_begin_so_is_refused(keys: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Excitation.model_validate({"start_hz": 1.0, "stop_hz": 35.0, "duration_s": 120.0} | keys)


def test_the_papers_seven_seconds_leave_three_to_thirty_five_hertz() -> None:
    """A chirp from 1 Hz in 120 s has come to 3 Hz after 7 s; upwards, downwards, by octaves."""
    sweep = {"start_hz": 1.0, "stop_hz": 35.0, "duration_s": 120.0, "ring_down_s": 2.0, "unrecorded_s": 7.0}
    up = Excitation.model_validate(sweep)
    assert up.recorded_band_hz == pytest.approx((2.983, 35.0), abs=1e-3)
    assert (up.band_hz, up.record_s, up.whole_s) == ((1.0, 35.0), 115.0, 122.0)
    down = Excitation.model_validate(sweep | {"start_hz": 35.0, "stop_hz": 1.0})
    assert down.recorded_band_hz == pytest.approx((1.0, 33.017), abs=1e-3)
    octaves = Excitation.model_validate(sweep | {"kind": "logarithmic-chirp", "unrecorded_s": 60.0})
    assert octaves.recorded_band_hz == pytest.approx((35.0**0.5, 35.0))
    noise = Excitation.model_validate(sweep | {"kind": "random"})
    assert noise.recorded_band_hz == noise.band_hz == (1.0, 35.0)
