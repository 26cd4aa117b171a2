"""A scenario whose effect acts on a sensor or a run that it does not have is no test to simulate."""

from __future__ import annotations

from pathlib import Path

import pytest

HEAD = 'extends = "quick"\nname = "aimed"\nsummary = "Quick with an effect of nothing."\n\n[[effect]]\n'
LATE = 'name = "payload-change"\nmass_kg = 0.1\nfrom_run = 5\n'


def written(folder: Path, effect: str) -> Path:
    path = folder / "aimed.toml"
    path.write_text(HEAD + effect, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("effect", "words"),
    [
        (LATE, "effect[0].from_run: payload-change: from_run = 5, but there is 1 run"),
        ('name = "channel-gain"\ngain_error = 0.1\nchannels = "sensor-99"\n', "channel-gain: sensor-99: no run has 99"),
        ('name = "channel-delay"\ndelay_s = 1e-4\nchannels = "sensor-21"\n', "There are sensor-1 to sensor-20."),
    ],
)
def test_it_is_refused_and_leaves_nothing_behind(vgvt, tmp_path: Path, effect: str, words: str) -> None:
    result = vgvt("simulate", written(tmp_path, effect), "--out", "made")
    assert result.status == 2
    assert words in result.err
    assert not (tmp_path / "made").exists()


@pytest.mark.parametrize(
    "command",
    [
        ("simulate",),
        ("show", "--no-picture"),
        ("plan",),
        ("bench", "--identifier", "quadrature"),
        ("sweep", "--set", "excitation.duration_s=8,16", "--identifier", "quadrature"),
        ("reconcile", "--power", "--scenario"),
    ],
)
@pytest.mark.parametrize(
    ("effect", "place"),
    [
        (LATE, "effect[0].from_run: payload-change: from_run = 5"),
        ('name = "payload-change"\nmass = 0.1\n', "effect[0].mass: effect 'payload-change' has no such parameter"),
        ('name = "added-mass"\nmass_kg = 0.1\nx_m = 9.0\ny_m = 0.0\n', "effect[0].x_m: effect added-mass at (9, 0)"),
        ('name = "channel-gain"\ngain_error = 0.1\nchannels = "sensor-99"\n', "effect channel-gain: sensor-99"),
    ],
)
def test_every_command_refuses_it_and_names_the_file(
    vgvt, tmp_path: Path, command: tuple[str, ...], effect: str, place: str
) -> None:
    path = written(tmp_path, effect)
    result = vgvt(*command, path)
    assert (result.status, result.out) == (2, "")
    assert f"{path}: {place}" in result.err


def test_an_inherited_effect_is_the_mistake_of_the_file_that_has_it(vgvt, tmp_path: Path) -> None:
    parent, child = written(tmp_path, LATE), tmp_path / "child.toml"
    child.write_text(f'extends = "{parent.name}"\nname = "child"\nsummary = "Nothing of its own."\n', encoding="utf-8")
    result = vgvt("show", child, "--no-picture")
    assert result.status == 2
    assert f"{parent}: effect[0].from_run" in result.err


def test_of_two_effects_of_one_name_it_is_said_in_words_which_is_meant(vgvt, tmp_path: Path) -> None:
    """The keys of a sweep count from 0; who reads effect[1] is not to mend the first table."""
    good = 'name = "added-mass"\nmass_kg = 0.1\n'
    said = vgvt("show", written(tmp_path, f"{good}\n[[effect]]\n{good}x_m = 9.0\ny_m = 0.0\n"), "--no-picture").err
    assert "effect[1].x_m: effect added-mass at (9, 0)" in said
    assert "ounted from 0, effect[1] is the second 'added-mass'" in said


def test_a_campaign_brings_its_own_runs(vgvt, tmp_path: Path) -> None:
    """The scenario's own count only where they are the test's: before it is made."""
    path = written(tmp_path, LATE)
    before = vgvt("reconcile", "--power", "--scenario", path)
    assert (before.status, "from_run = 5" in before.err) == (2, True)
    of_a_campaign = vgvt("reconcile", "nowhere.nc", "--scenario", path)
    assert (of_a_campaign.status, "from_run" in of_a_campaign.err) == (2, False)
