"""``vgvt reconcile --power`` without a campaign: what a test could see, and what no test of the rig could."""

from __future__ import annotations

from pathlib import Path

import pytest
from coarse_beam import BEAM


@pytest.fixture
def beam(tmp_path: Path) -> Path:
    """A small scenario on disk."""
    path = tmp_path / "beam.toml"
    path.write_text(BEAM, encoding="utf-8")
    return path


def test_power_before_the_test(vgvt, tmp_path: Path, beam: Path) -> None:
    arguments = (
        "reconcile",
        "--power",
        "--scenario",
        beam,
        "--only",
        "channel-gain",
        "--only",
        "mains-hum",
        "--lines",
        60,
    )
    document = vgvt(*arguments, "--out", "seen", "--json").document
    gains = [row for row in document["power"] if row["effect"] == "channel-gain"]
    seen = {row["label"]: row["smallest"] for row in gains if row["smallest"] is not None}
    # One channel against the others of its instrument: some times the tolerances of both, 0.3 % and 1 %.
    alone = [smallest for label, smallest in seen.items() if "+Z" in label]
    assert len(alone) > 1 and all(0.003 < smallest < 0.1 for smallest in alone)
    # All sensors alike is what the gains' own tolerance of 1 % can imitate at once.
    assert seen["channel-gain (channels = response)"] > 0.01
    assert document["invisible"] == ["mains-hum"]
    (spread,) = (row for row in document["places"] if row["effect"] == "channel-gain")
    assert spread["variants"] == len(gains)
    assert spread["best"] == min(seen.values()) == seen[spread["best_variant"]]
    assert spread["best"] < spread["median"]
    assert {row["reason"] for row in document["power"] if row["effect"] == "mains-hum"} == {"never"}
    assert {p.name for p in (tmp_path / "seen").iterdir()} == {"power.json", "power.html"}
    assert "channel-gain" in vgvt(*arguments).out


def test_power_before_the_test_of_what_could_show_nowhere_is_no_table(vgvt, beam: Path) -> None:
    """A beam of four runs of one sensor each has no two that could be taken for one another."""
    beam.write_text(BEAM.replace("[[1, 2], [3, 4], [5, 6], [7, 8]]", "[[1], [3], [5], [7]]"), encoding="utf-8")
    ran = vgvt("reconcile", "--power", "--scenario", beam, "--only", "swapped-sensors", "--lines", 60)
    assert ran.status == 2
    assert "no variant of swapped-sensors" in ran.err


def test_power_before_the_test_tells_what_the_aircraft_cannot_have(vgvt, beam: Path) -> None:
    """A shaker on a beam puts no moment on the body: no table calls that invisible, as if another test could see it."""
    arguments = ("reconcile", "--power", "--scenario", beam, "--only", "stinger-moment", "--lines", 60)
    ran = vgvt(*arguments)
    assert ran.status == 2
    assert "no variant of stinger-moment" in ran.err
    assert "a moment can only be put on the centre body" in ran.err
    ran = vgvt(*arguments, "--only", "mains-hum", "--json")
    assert ran.document["invisible"] == ["mains-hum"]
    assert list(ran.document["cannot_have"]) == ["stinger-moment"]
    assert "no variant of stinger-moment is possible" in ran.err
