"""``vgvt show``: numbers, picture, animation, and a machine without OpenGL."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from vgvt.scenario import load_scenario, rigid_body_properties


def test_the_document_holds_the_contract(vgvt) -> None:
    document = vgvt("show", "quick", "--no-picture", "--json").document
    assert {"mass_kg", "cg_m", "inertia_kg_m2", "modes", "picture", "coupled", "animation"} <= set(document)
    # The masses of the tables, summed without MuJoCo.
    expected = rigid_body_properties(load_scenario("quick").airframe)
    assert document["mass_kg"] == pytest.approx(expected.mass_kg, rel=1e-6)
    assert np.allclose(document["cg_m"], expected.centre_of_gravity_m, atol=1e-6)
    assert document["picture"] is None and document["animation"] is None
    assert document["modes"] and document["coupled"]
    # Attached to the ground through the shaker's flexure, the rig has more slow resonances than the bare airframe.
    assert len(document["coupled"]) > len(document["modes"])
    assert list(Path().iterdir()) == []


def test_the_tables_name_bare_modes_tested_modes_and_the_rig(vgvt) -> None:
    result = vgvt("show", "quick", "--no-picture")
    assert result.status == 0
    for words in ("mass", "bare airframe", "as tested", "whole rig"):
        assert words in result.out


def test_an_aircraft_that_hangs_askew_is_said_to(vgvt) -> None:
    """150 g near a tip: atan(m y / M h) of roll by the statics of the tables, told in words; quick hangs level."""
    scenario = load_scenario("spoiled-added-mass")
    roll, _ = vgvt("show", scenario.name, "--no-picture", "--json").document["hangs_at_roll_pitch_deg"][0]
    mass = scenario.effect[0].parameters
    bare = rigid_body_properties(scenario.airframe)
    total = bare.mass_kg + mass["mass_kg"]
    below = scenario.suspension.hook_m[2] - bare.centre_of_gravity_m[2] * bare.mass_kg / total
    assert -roll == pytest.approx(np.degrees(np.arctan2(mass["mass_kg"] * mass["y_m"], total * below)), abs=5.0)
    assert "hangs askew in run 1: right wing" in vgvt("show", scenario.name, "--no-picture").out
    assert "askew" not in vgvt("show", "quick", "--no-picture").out


def test_a_zero_has_no_sign_and_an_angle_of_zero_no_word(vgvt) -> None:
    level = vgvt("show", "teaching-beam", "--no-picture").out
    assert "hangs at +0.0° of roll" in level and "-0.0" not in level
    tilted = vgvt("show", "bff", "--no-picture").out
    assert "askew" in tilted and " 0.0°" not in tilted and "-0.0000" not in tilted


@pytest.mark.parametrize("name", ["quick", "spoiled-suspension-surge", "spoiled-local-absorber"])
def test_no_two_resonances_of_the_rig_share_a_name(vgvt, name: str) -> None:
    document = vgvt("show", name, "--no-picture", "--json").document
    names = [mode["label"] for mode in document["coupled"] if mode.get("label")]
    assert len(set(names)) == len(names) > 4
    surges = [mode["label"] for mode in document["as_tested"] if "surge" in mode["label"]]
    assert bool(surges) == (name == "spoiled-suspension-surge")


def test_an_effect_off_the_aircraft_is_refused(vgvt, tmp_path: Path) -> None:
    far = tmp_path / "far.toml"
    text = """extends = "quick"
name = "far"
summary = "A mass beside the aircraft."
[[effect]]
name = "added-mass"
mass_kg = 0.1
x_m = 0.9
y_m = 2.2
"""
    far.write_text(text, encoding="utf-8")
    for arguments in (("show", str(far), "--no-picture"), ("simulate", str(far))):
        result = vgvt(*arguments)
        assert result.status == 2
        assert "672 mm off the aircraft" in result.err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--no-picture", "--mode", 7), "--no-picture"),
        (("--mode", 999), "no mode 999"),
        (("--out", "rig.jpg"), ".png"),
        (("--out", "/dev/null/x.png"), "/dev/null/x.png: cannot be written"),
        (("--out", "/dev/null/x"), "/dev/null/x/quick.png: cannot be written"),
    ],
)
def test_bad_input(vgvt, arguments: tuple[object, ...], words: str) -> None:
    result = vgvt("show", "quick", *arguments)
    assert result.status == 2
    assert words in result.err
    assert list(Path().iterdir()) == []


def test_without_opengl_exit_status_1_and_advice(vgvt, monkeypatch: pytest.MonkeyPatch) -> None:
    import mujoco

    def broken(*_: object) -> None:
        raise AttributeError("no eglQueryString")

    monkeypatch.setattr(mujoco, "Renderer", broken)
    result = vgvt("show", "quick", "--out", "some/pictures", "--mode", 7)
    assert result.status == 1
    assert "--no-picture" in result.err
    assert list(Path().iterdir()) == []
    assert vgvt("show", "quick", "--no-picture").status == 0


def test_picture_and_animation_beside_a_dead_display(tmp_path: Path) -> None:
    """As a process, because MuJoCo takes its way to OpenGL from the environment when it is first imported."""
    environment = {k: v for k, v in os.environ.items() if k != "WAYLAND_DISPLAY"}
    environment |= {"DISPLAY": ":9999", "MUJOCO_GL": ""}
    arguments = ["show", "quick", "--out", "here", "--mode", "7", "--width", "320", "--height", "200"]
    done = subprocess.run(
        [sys.executable, "-m", "vgvt", *arguments],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    if done.returncode == 1 and "OpenGL does not work here" in done.stderr:
        pytest.skip(f"no rendering on this machine: {done.stderr.strip()}")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "here/quick.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "here/quick-mode-7.webp").read_bytes()[8:12] == b"WEBP"
