"""The excitation table by kind, repeated runs, and what the newer scenarios say."""

from __future__ import annotations

from pathlib import Path

import pytest

from vgvt.data import InputError
from vgvt.scenario import Scenario, load_scenario, to_toml
from vgvt.scenario.library import library_folder
from vgvt.scenario.rig import KIND_KEYS

_HEAD = 'extends = "quick"\nname = "mine"\nsummary = "A trial."\n[excitation]\n'

# Lines that are right, for each kind; start, stop and duration (3 to 35 Hz, 16 s) are inherited.
_KINDS = {
    "linear-chirp": "",
    "logarithmic-chirp": "",
    "stepped-sine": "points = 20\nsettle_s = 0.4",
    "random": "",
    "burst-random": "blocks = 4\nburst_fraction = 0.6",
    "multisine": 'blocks = 4\nlines = "odd"\ncrest_iterations = 10',
}


def _load(folder: Path, lines: str) -> Scenario:
    file = folder / "mine.toml"
    file.write_text(_HEAD + lines, encoding="utf-8")
    return load_scenario(file)


@pytest.mark.parametrize("kind", _KINDS)
def test_every_kind_loads_and_survives_writing(tmp_path: Path, kind: str) -> None:
    scenario = _load(tmp_path, f'kind = "{kind}"\n{_KINDS[kind]}')
    assert scenario.excitation.kind == kind
    assert scenario.excitation.band_hz == (3.0, 35.0)
    assert scenario.excitation.record_s == 18.0
    (tmp_path / "again.toml").write_text(to_toml(scenario), encoding="utf-8")
    assert load_scenario(tmp_path / "again.toml") == scenario


@pytest.mark.parametrize("kind", _KINDS)
def test_the_band_of_every_kind_must_lie_below_nyquist(tmp_path: Path, kind: str) -> None:
    with pytest.raises(InputError) as caught:
        _load(tmp_path, f'kind = "{kind}"\nstop_hz = 500.0\n{_KINDS[kind]}')
    assert caught.value.where.endswith("excitation.stop_hz")
    assert "500 Hz" in caught.value.problem


# Lines that are wrong | key that the message must name | words of the problem | words of the advice
_MISTAKES = [
    ('kind = "random"\npoints = 20', "points", "does not belong to kind 'random'", "'stepped-sine'"),
    ('kind = "linear-chirp"\nblocks = 2', "blocks", "does not belong", "'burst-random' or 'multisine'"),
    (
        'kind = "multisine"\nblocks = 2\nlines = "full"\nburst_fraction = 0.5',
        "burst_fraction",
        "belong",
        "burst-random",
    ),
    ('kind = "stepped-sine"\nsettle_s = 0.1', "points", "is missing", "points = "),
    ('kind = "stepped-sine"\npoints = 20\nsettle_s = 0.6', "settle_s", "0.6 cycles at 3 Hz", "settle less"),
    ('kind = "stepped-sine"\npoints = 1\nsettle_s = 0.1', "points", "at least 2", "stepped-sine"),
    ('kind = "logarithmic-chirp"\nstart_hz = 0.0', "start_hz", "no octave", "above 0 Hz"),
    ('kind = "burst-random"\nblocks = 4\nburst_fraction = 1.5', "burst_fraction", "less than 1", "burst-random"),
    (
        'kind = "burst-random"\nblocks = 4\nburst_fraction = 0.5\ntaper_s = 1.5',
        "taper_s",
        "half of a burst's length",
        "Shorten",
    ),
    ('kind = "multisine"\nblocks = 4\nlines = "even"', "lines", "must be 'full' or 'odd'", "multisine"),
    ('kind = "multisine"\nblocks = 400\nlines = "full"', "blocks", "too short", "0.125 s"),
    ('kind = "random"\nstop_hz = 3.1', "duration_s", "too short", "widen the band"),
    ('kind = "burst"', "kind", "'burst-random'", "kind = "),
]


@pytest.mark.parametrize(
    ("lines", "key", "problem", "advice"), _MISTAKES, ids=[m[0].replace("\n", " ") for m in _MISTAKES]
)
def test_a_mistake_is_told_at_its_key(tmp_path: Path, lines: str, key: str, problem: str, advice: str) -> None:
    with pytest.raises(InputError) as caught:
        _load(tmp_path, lines)
    assert caught.value.where.endswith(f": excitation.{key}")
    assert problem in caught.value.problem
    assert advice in caught.value.advice


def test_the_catalogue_tells_every_kind_and_its_own_keys() -> None:
    text = (library_folder() / "README.md").read_text(encoding="utf-8").split("## The excitation")[1]
    rows = [line.strip("|").split("|") for line in text.split("\n\n")[2].splitlines()[2:]]
    told = {kind.strip(): set(keys.replace("`", "").replace(" ", "").split(",")) - {""} for kind, keys, _ in rows}
    assert told == {kind: set(keys) for kind, keys in KIND_KEYS.items()}


def test_a_changed_kind_leaves_the_old_kinds_keys_behind(tmp_path: Path) -> None:
    (tmp_path / "stepped.toml").write_text(
        _HEAD + 'kind = "stepped-sine"\npoints = 20\nsettle_s = 0.4', encoding="utf-8"
    )
    (tmp_path / "noise.toml").write_text(
        'extends = "stepped.toml"\nname = "noise"\nsummary = "A trial."\n[excitation]\nkind = "random"',
        encoding="utf-8",
    )
    noise = load_scenario(tmp_path / "noise.toml").excitation
    assert (noise.kind, noise.points, noise.settle_s, noise.duration_s) == ("random", None, None, 16.0)


def test_repeats_multiply_the_runs_set_by_set(tmp_path: Path) -> None:
    scenario = _load(tmp_path, "amplitude_v = 1.0\n[acquisition]\nrepeats = 2\nruns = [[1, 2], [3]]")
    assert scenario.acquisition.run_nodes == ((1, 2), (1, 2), (3,), (3,))
    (tmp_path / "again.toml").write_text(to_toml(scenario), encoding="utf-8")
    assert load_scenario(tmp_path / "again.toml").acquisition.run_nodes == scenario.acquisition.run_nodes


def test_bff_is_tested_as_the_paper_says() -> None:
    bff = load_scenario("bff")
    assert bff.excitation.kind == "stepped-sine"
    assert (bff.excitation.band_hz, bff.excitation.points) == ((3.0, 35.0), 400)
    grid = bff.accelerometers.grid
    assert grid.node == tuple(range(1, 35))
    assert bff.acquisition.runs == tuple((node,) for node in grid.node)
    # The shaker pushes at point 12, off the axis; point 18 is at a wing tip.
    assert bff.shaker.position_m[:2] == (grid.x_m[11], grid.y_m[11])
    assert bff.shaker.position_m[1] != 0
    assert abs(grid.y_m[17]) == max(abs(y) for y in grid.y_m)
    assert bff.suspension.stiffness_n_per_m == 130.0


def test_garteur_weighs_what_its_aluminium_weighs() -> None:
    """1.5 m of fuselage, 2 m of wing, two drums, fin, tailplane, plate, tape and two masses of 0.2 kg."""
    from vgvt.scenario import rigid_body_properties

    fuselage, wing = 1.5 * 0.15 * 0.05, 2.0 * 0.1 * 0.01
    drums, fin, tailplane, plate = 2 * 0.4 * 0.1 * 0.01, 0.3 * 0.1 * 0.01, 0.4 * 0.1 * 0.01, 1.7 * 0.0762 * 0.0011
    aluminium = 2700 * (fuselage + wing + drums + fin + tailplane + plate)
    joint, tape = 0.05, 1000 * 1.7 * 0.0762 * 50e-6
    found = rigid_body_properties(load_scenario("garteur-sm-ag19").airframe)
    assert found.mass_kg == pytest.approx(aluminium + 0.4 + joint + tape, rel=1e-3)
    assert 40.0 < found.mass_kg < 44.5
    assert abs(found.centre_of_gravity_m[1]) < 1e-9
