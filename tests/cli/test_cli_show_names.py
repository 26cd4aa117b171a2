"""``vgvt show`` names a resonance of the rig after a mode that it can be, or not at all."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs/how-to/write-your-own-scenario.md"


def test_no_rigid_resonance_has_an_elastic_modes_name_and_the_torsion_keeps_its_own(vgvt, tmp_path: Path) -> None:
    """The plank of the how-to, whose sensors lie on its axis and see little of a torsion."""
    (text,) = (block for block in re.findall(r"```toml\n(.*?)```", PAGE.read_text(), re.S) if 'name = "plank"' in block)
    plank = tmp_path / "plank.toml"
    plank.write_text(text, encoding="utf-8")
    document = vgvt("show", str(plank), "--no-picture", "--json").document
    tested = {mode["label"]: mode for mode in document["as_tested"]}
    named = {mode["label"]: mode for mode in document["coupled"] if mode["label"]}
    for name, mode in named.items():
        assert 1 / 1.3 < mode["frequency_hz"] / tested[name]["frequency_hz"] < 1.3, name
    # Pitch and yaw do not feel the shaker: the same frequency and the same damping, whatever the sensors see.
    for name in ("yaw", "pitch", "1st antisymmetric torsion"):
        assert named[name]["frequency_hz"] == pytest.approx(tested[name]["frequency_hz"], rel=1e-3)
        assert named[name]["damping_ratio"] == pytest.approx(tested[name]["damping_ratio"], rel=1e-2)


def test_of_two_swings_that_look_alike_each_has_the_nearer_name(vgvt) -> None:
    """The first wing's sensors see the two swings of the quick scenario as pitch and roll, which have names too."""
    document = vgvt("show", "quick", "--no-picture", "--json").document
    tested = {mode["label"]: mode["frequency_hz"] for mode in document["as_tested"]}
    for mode in document["coupled"]:
        if "swing" in mode["label"] or mode["label"] in ("yaw", "pitch"):
            assert mode["frequency_hz"] == pytest.approx(tested[mode["label"]], rel=0.03)
