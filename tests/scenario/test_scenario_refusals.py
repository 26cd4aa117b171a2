"""Bad input: each is refused at its file and key, in words that say what to write."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from vgvt.data import InputError
from vgvt.scenario import load_scenario

_HEAD = 'extends = "quick"\nname = "mine"\nsummary = "A trial."\n'

Refused = Callable[[str], InputError]


@pytest.fixture
def refused(tmp_path: Path) -> Refused:
    """Write a scenario that differs from ``quick`` by some lines and return how it is refused."""

    def load(lines: str) -> InputError:
        file = tmp_path / "mine.toml"
        file.write_text(_HEAD + lines, encoding="utf-8")
        with pytest.raises(InputError) as caught:
            load_scenario(file)
        assert str(file) in str(caught.value) or "quick" in str(caught.value)
        return caught.value

    return load


# Lines that are wrong | key that the message must name | words of the problem | words of the advice
_MISTAKES = [
    (
        "[suspension]\nstifness_n_per_m = 3.0",
        "suspension.stifness_n_per_m",
        "not a key",
        "Did you mean stiffness_n_per_m",
    ),
    ("[suspension]\narmature_mass_kg = 3.0", "suspension.armature_mass_kg", "not a key", "belongs in [shaker]"),
    ("[shaker]\nmass = 3.0", "shaker.mass", "not a key", "armature_mass_kg"),
    ("[simulation]\nseed = 3", "simulation.seed", "not a key", "at the top of the file"),
    ("[simulation]\nqqqqqq = 3", "simulation.qqqqqq", "not a key", "engine, step_s"),
    ("[suspension]\nstiffness_n_per_m = -130.0", "suspension.stiffness_n_per_m", "is -130", "N/m"),
    (
        '[[airframe.beam]]\nname = "wing"\n[airframe.beam.stations]\nbending_stiffness_n_m2 = [316, -1, 316, 316]',
        "airframe.beam[0].stations.bending_stiffness_n_m2[1]",
        "is -1, but must be more than 0",
        "N m²",
    ),
    (
        '[[airframe.beam]]\nname = "wing"\n[airframe.beam.stations]\nmass_kg_per_m = [0.6]',
        "airframe.beam[0].stations.mass_kg_per_m",
        "has 1 entries but position_m has 4",
        "one entry a station",
    ),
    ("[transducer]\nsensitivity_v_per_n = 0", "transducer.sensitivity_v_per_n", "is 0, but must be more than 0", "V/N"),
    ('[transducer]\nmass_kg = "0.02"', "transducer.mass_kg", "without quotes", "kg"),
    ("[transducer]\nmass_kg = nan", "transducer.mass_kg", "ordinary number", "kg"),
    ("[transducer]\nend_mass_kg = 0.5", "transducer.end_mass_kg", "more than the whole transducer", "sensing element"),
    ("[excitation]\nstart_hz = 35.0", "excitation.stop_hz", "like start_hz", "two"),
    ("[excitation]\nstop_hz = 600.0", "excitation.stop_hz", "is 600, but sampled at 1000 Hz", "1200 Hz"),
    ("[acquisition]\nsample_rate_hz = 60.0", "acquisition.sample_rate_hz", "goes up to 35 Hz", "70 Hz"),
    ("[excitation]\ntaper_s = 9.0", "excitation.taper_s", "more than half", "Shorten"),
    ('[excitation]\nkind = "burst"', "excitation.kind", "must be 'linear-chirp'", "kind = "),
    ("[acquisition]\nbits = 24.5", "acquisition.bits", "whole number", "converter"),
    ("[acquisition]\nbits = true", "acquisition.bits", "is true", "converter"),
    ("[acquisition]\nruns = [[1, 77]]", "acquisition.runs[0]", "names node 77", "The grid has 1, 2"),
    ("[acquisition]\nruns = [[1, 1]]", "acquisition.runs[0]", "[1, 1]", "each node once"),
    ("[acquisition]\nruns = []", "acquisition.runs", "has 0 entries", "each run"),
    ("[shaker]\nnode = 4", "shaker.node", "also an accelerometer's", "number of its own"),
    ("[shaker]\nposition_m = [0.6, 0.1]", "shaker.position_m", "exactly 3 entries", "Drive point"),
    (
        '[shaker]\ndrive = "voltage"\ncoil_resistance_ohm = 4.0\ncoil_inductance_h = 0.6',
        "shaker.coil_inductance_h",
        "lag by 0.15 s",
        "0.6 mH is 6e-4",
    ),
    ('[shaker]\nattached_to = "wnig"', "shaker.attached_to", "not a part", "Did you mean wing"),
    (
        '[[airframe.hinged]]\nname = "loose"\nmass_kg = 0.1\nposition_m = [0.9, 1.0, 0.0]\nattached_to = "wing"',
        "airframe.hinged",
        "no hinge to hang on",
        "'control-surface'",
    ),
    ("[airframe]\nhingd = []", "airframe.hingd", "not a key", "The keys in [airframe] are name, configuration, body"),
    (
        "[accelerometers.grid]\nnode = [-1]\nx_m = [0.5]\ny_m = [0.5]",
        "accelerometers.grid.node[0]",
        "is -1, but must be at least 0",
        "number of each point",
    ),
    ("[acquisition]\nruns = [[1], [2, -3]]", "acquisition.runs[1][1]", "is -3, but must be at least 0", "nodes"),
    (
        "[hammer]\nhead_mass_kg = 0.1\ntip_stiffness_n_per_m = 5e4\npeak_force_n = 9.0\nsensitivity_v_per_n = 0.01\n"
        "nodes = [-4]",
        "hammer.nodes[0]",
        "is -4, but must be at least 0",
        "Roving hammer",
    ),
    ('[accelerometers.grid]\ndirection = ["Q"]', "accelerometers.grid.direction[0]", "'Q'", "'+Z'"),
    (
        "[accelerometers.grid]\nx_m = [0.5]",
        "accelerometers.grid.x_m",
        "has 1 entries but node has 20",
        "one entry a node",
    ),
    ("[accelerometers.noise]\ndensity = [1.0]", "accelerometers.noise.density", "has 1 entries", "a frequency"),
    ("[airframe.damping]\ndamping_ratio = 2.0", "airframe.damping.damping_ratio", "is 2", "0.02 for 2 %"),
    ('[airframe.beam]\nname = "wing"', "airframe.beam", "one table", "[[airframe.beam]]"),
    (
        '[[airframe.beam]]\nname = "wing"\nnormal = [0.3755, 0.9268, 0.0]',
        "airframe.beam[0].normal",
        "along the axis",
        "bends",
    ),
    (
        '[[airframe.item]]\nname = "brick"\nmass_kg = 1.0\nposition_m = [0.5, 0.0, 0.0]\nmirror = true',
        "airframe.item[11].position_m",
        "copies the right item",
        "y > 0",
    ),
    (
        '[[airframe.item]]\nname = "brick"\nposition_m = [0.5, 0.0, 0.0]',
        "airframe.item[11].mass_kg",
        "is missing",
        "kg",
    ),
    ("suspension = 3", "suspension", "table of keys", "[suspension]"),
    ("[airframe]\nbeam = 3", "airframe.beam", "is 3, but must be an array of tables", "Write [[airframe.beam]] as"),
    ("[airframe]\nbeam = [3]", "airframe.beam[0]", "is 3, but must be a table", "the table [[airframe.beam]]"),
    ("effect = 3", "effect", "is 3, but must be an array of tables", "Write [[effect]] as"),
    ("qqqqqq = 3", "qqqqqq", "not a key", "are extends, schema_version, name"),
    ("extendz = 3", "extendz", "not a key", "Did you mean extends?"),
    ('[simulation]\nextends = "quick"', "simulation.extends", "not a key", "extends belongs at the top of the file"),
]


@pytest.mark.parametrize(("lines", "key", "problem", "advice"), _MISTAKES, ids=[m[1] + "|" + m[2] for m in _MISTAKES])
def test_a_mistake_is_told_at_its_key(refused: Refused, lines: str, key: str, problem: str, advice: str) -> None:
    error = refused(lines)
    assert error.where.endswith(f": {key}")
    assert problem in error.problem
    assert advice.lower() in error.advice.lower()
    assert not any(jargon in str(error).lower() for jargon in ("pydantic", "input should", "validation", "traceback"))


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (
            '[[airframe.beam]]\nname = "tail"\n[airframe.beam.stations]\nbending_stiffness_n_m2 = [316, -1, 316, 316]',
            "beam[1] is 'tail' and bending_stiffness_n_m2[1] is the second",
        ),
        ("[acquisition]\nruns = [[1], [2, -3]]", "runs[1] is the second and runs[1][1] is the second in it"),
        ('[[effect]]\nname = "mains-hum"\n[[effect]]\nname = 3', "effect[1] is the second"),
        ('[[further_shaker]]\nnode = "x"', "further_shaker[0] is the second shaker"),
    ],
)
def test_the_entry_that_a_key_counts_is_told_in_words(refused: Refused, lines: str, words: str) -> None:
    """Keys count from 0, as those of a sweep do, over all that a file extends; whoever writes one counts from 1."""
    assert f"Counted from 0, {words}." in refused(lines).advice


def test_sensor_off_the_aircraft(refused: Refused) -> None:
    grid = "node = [1, 2]\nx_m = [0.5, 0.6]\ny_m = [0.5, 1.9]"
    error = refused(f"[accelerometers.grid]\n{grid}\n[acquisition]\nruns = [[1, 2]]")
    assert error.where.endswith("accelerometers.grid.x_m[1]")
    assert "sensor point 2" in error.problem
    assert "off the aircraft" in error.problem
    assert "'wing-right'" in error.problem


def test_a_sensor_on_an_edge_is_on_the_aircraft(tmp_path: Path) -> None:
    file = tmp_path / "edge.toml"
    grid = "node = [1]\nx_m = [0.842]\ny_m = [1.464]"
    file.write_text(f"{_HEAD}[accelerometers.grid]\n{grid}\n[acquisition]\nruns = [[1]]", encoding="utf-8")
    assert load_scenario(file).accelerometers.grid.node == (1,)


def test_sensor_off_the_part_that_it_names(refused: Refused) -> None:
    grid = 'node = [1]\nx_m = [0.5]\ny_m = [0.5]\nattached_to = ["wing-left"]'
    error = refused(f"[accelerometers.grid]\n{grid}\n[acquisition]\nruns = [[1]]")
    assert "off the part it is attached to, 'wing-left'" in error.problem


def test_inches_are_recognised(refused: Refused) -> None:
    grid = "node = [1]\nx_m = [19.03]\ny_m = [17.87]"
    error = refused(f"[accelerometers.grid]\n{grid}\n[acquisition]\nruns = [[1]]")
    assert "inches" in error.advice
    assert "0.4834, 0.4539" in error.advice


@pytest.mark.parametrize(
    ("lines", "key"),
    [
        ("[shaker]\nposition_m = [0.635, 0.5, 0.0]", "shaker.position_m"),
        ("[suspension]\nhook_m = [-0.5, 0.0, 0.03]", "suspension.hook_m"),
    ],
)
def test_drive_point_and_hook_off_the_aircraft(refused: Refused, lines: str, key: str) -> None:
    error = refused(lines)
    assert error.where.endswith(key)
    assert " off " in error.problem


def test_a_further_shaker_off_the_aircraft_is_told_beside_other_mistakes(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    second = load_scenario("hati-two-shakers").further_shaker[0].model_copy(update={"position_m": (9.0, 0.0, 0.0)})
    table = "".join(f"{key} = {json.dumps(value)}\n" for key, value in second.model_dump().items())
    lines = _HEAD.replace("quick", "hati-two-shakers") + f"[[further_shaker]]\n{table}"
    file.write_text(lines, encoding="utf-8")
    alone = _refusal(file)
    assert alone.where == f"{file}: further_shaker[0].position_m"
    file.write_text(lines + "[suspension]\nstiffness_n_per_m = -1.0\n", encoding="utf-8")
    both = _refusal(file)
    assert both.problem == "2 mistakes"
    assert f"further_shaker[0].position_m: {alone.problem}" in both.advice


def test_all_mistakes_are_told_at_once(refused: Refused) -> None:
    error = refused('[suspension]\nstiffness_n_per_m = -1.0\nlenght_m = 1.0\n[shaker]\ndrive = "steam"')
    assert error.problem == "3 mistakes"
    for words in ("suspension.stiffness_n_per_m: is -1", "free_length_m", "shaker.drive"):
        assert words in error.advice


def test_not_more_than_ten_mistakes_are_listed(refused: Refused) -> None:
    error = refused("[shaker]\n" + "\n".join(f"junk_{i} = 0" for i in range(13)))
    assert error.problem == "13 mistakes"
    assert error.advice.count("\n") == 10
    assert error.advice.endswith("and 3 more.")


def test_beams_that_hold_each_other(refused: Refused) -> None:
    stations = "position_m = [[0.5, 0.0, 0.0], [0.5, 0.0, 0.3]]\n" + "\n".join(
        f"{column} = [1.0, 1.0]"
        for column in ("bending_stiffness_n_m2", "torsional_stiffness_n_m2", "mass_kg_per_m", "pitch_inertia_kg_m")
    )
    beams = [
        f'[[airframe.beam]]\nname = "{a}"\nparent = "{b}"\nnormal = [0, 1, 0]\n[airframe.beam.stations]\n{stations}\n'
        for a, b in (("fin", "tail"), ("tail", "fin"))
    ]
    error = refused("".join(beams))
    assert error.where.endswith("airframe.beam[1].parent")
    assert "circle" in error.problem


# The file itself


def _refusal(path: Path | str) -> InputError:
    with pytest.raises(InputError) as caught:
        load_scenario(path)
    return caught.value


def test_missing_file_names_its_neighbours(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").touch()
    assert "mine.toml" in _refusal(tmp_path / "mien.toml").advice
    assert "does not exist" in _refusal(tmp_path / "nowhere" / "mine.toml").advice


def test_folder_in_place_of_a_file(tmp_path: Path) -> None:
    assert "folder" in _refusal(tmp_path).problem


@pytest.mark.parametrize("content", [b"", b"\n\n", b"# only a comment\n"])
def test_empty_file(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "x.toml").write_bytes(content)
    error = _refusal(tmp_path / "x.toml")
    assert "empty" in error.problem
    assert "extends" in error.advice


def test_text_that_is_not_utf_8(tmp_path: Path) -> None:
    (tmp_path / "x.toml").write_bytes(b'name = "x"\nsummary = "Sk\xf6ll"\n')
    error = _refusal(tmp_path / "x.toml")
    assert error.where.endswith("x.toml, line 2")
    assert "UTF-8" in error.problem


def test_byte_order_mark_does_no_harm(tmp_path: Path) -> None:
    (tmp_path / "x.toml").write_bytes(b"\xef\xbb\xbf" + _HEAD.encode())
    assert load_scenario(tmp_path / "x.toml").name == "mine"


@pytest.mark.parametrize(
    ("text", "line", "column"),
    [
        ('name = "x"\nseed = 1,5\n', 2, 9),
        ('name = "x"\nsummary = "y\n', 2, 13),
        ('name = "x"\n[shaker\n', 2, 8),
        ('name = "x"\nruns = [1, 2\n', 2, 13),
        ('name = "x"\nname = "y"\n', 2, 11),
        ('name = "x"\nseed\n', 2, 5),
    ],
)
def test_toml_mistakes_have_line_and_column(tmp_path: Path, text: str, line: int, column: int) -> None:
    (tmp_path / "x.toml").write_text(text, encoding="utf-8")
    error = _refusal(tmp_path / "x.toml")
    assert error.where.endswith(f"line {line}, column {column}")
    assert "not TOML" in error.problem
    assert error.advice


def test_unknown_bundled_name() -> None:
    error = _refusal("hati-unsymetric")
    assert "Did you mean hati-unsymmetric" in error.advice
    assert "quick" in _refusal("zzz").advice


def test_bare_file_has_everything_missing(tmp_path: Path) -> None:
    (tmp_path / "x.toml").write_text('name = "x"\nsummary = "y"\n[suspension]\n', encoding="utf-8")
    error = _refusal(tmp_path / "x.toml")
    assert "airframe: is missing" in error.advice
    assert "suspension.hook_m: is missing. Write hook_m" in error.advice
