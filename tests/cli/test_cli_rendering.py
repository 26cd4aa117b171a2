"""MUJOCO_GL and displays: pictures take a way to OpenGL that works, and nothing else needs one."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from vgvt.cli import rendering
from vgvt.cli.doctor import examine


def own_process(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """A command line in a process of its own: MuJoCo reads its variable as it is imported, once."""
    plain = {k: v for k, v in os.environ.items() if k not in ("MUJOCO_GL", "DISPLAY", "WAYLAND_DISPLAY")}
    return subprocess.run(
        [sys.executable, "-m", "vgvt", *arguments],
        env={**plain, **environment},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


@pytest.fixture
def no_display(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """Linux with neither a display nor a wish."""
    for name in ("MUJOCO_GL", "DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    return monkeypatch


def test_what_draws_nothing_runs_whatever_mujoco_gl_says() -> None:
    done = own_process("show", "quick", "--no-picture", MUJOCO_GL="nonsense")
    assert done.returncode == 0, done.stderr


def test_a_picture_by_a_way_that_there_is_not_names_the_variable(tmp_path: Path) -> None:
    done = own_process("show", "quick", "--out", str(tmp_path / "rig.png"), MUJOCO_GL="nonsense")
    assert done.returncode == 1
    assert "OpenGL does not work here (back end: nonsense)" in done.stderr
    assert "unset MUJOCO_GL, or set it to" in done.stderr and "--no-picture" in done.stderr


@pytest.mark.parametrize(
    ("asked", "display", "has_egl", "chosen"),
    [
        ("", "", True, "egl"),
        ("", ":99", True, "egl"),
        ("", ":0", False, ""),
        ("", "", False, "egl"),
        (" GLFW ", "", True, "glfw"),
    ],
)
def test_the_way_that_is_chosen(
    no_display: pytest.MonkeyPatch, asked: str, display: str, has_egl: bool, chosen: str
) -> None:
    no_display.setenv("MUJOCO_GL", asked)
    no_display.setenv("DISPLAY", display)
    no_display.setattr(rendering, "_has_egl", lambda: has_egl)
    assert rendering.back_end() == chosen


def test_elsewhere_the_way_is_mujocos_own(no_display: pytest.MonkeyPatch) -> None:
    no_display.setattr(sys, "platform", "darwin")
    assert rendering.back_end() == ""


def test_what_is_set_aside_is_remembered(no_display: pytest.MonkeyPatch) -> None:
    no_display.setattr(rendering, "_aside", {})
    no_display.setenv("MUJOCO_GL", "osmesa")
    rendering.draw_nothing()
    assert os.environ["MUJOCO_GL"] == "disabled"
    assert rendering.back_end() == "osmesa"


def test_doctor_tells_of_the_variable_beside_sound_physics(no_display: pytest.MonkeyPatch) -> None:
    """The physics runs for real; with no OpenGL in it, whatever the variable says."""
    no_display.setenv("MUJOCO_GL", "nonsense")
    findings = {finding.check: finding for finding in examine()}
    assert findings["physics"].status == "ok"
    assert findings["rendering"].status == "warn"
    assert findings["rendering"].detail.startswith("MUJOCO_GL=nonsense does not render")
    assert "unset MUJOCO_GL" in findings["rendering"].advice


def test_doctors_probes_see_what_is_wrong_without_assert(monkeypatch: pytest.MonkeyPatch) -> None:
    """python -O takes asserts out; a body that weighs nothing floats in both."""
    from vgvt.cli import doctor

    monkeypatch.setenv("PYTHONOPTIMIZE", "1")
    weightless = doctor._STEP.replace("<mujoco>", '<mujoco><option gravity="0 0 0"/>')
    environment = {rendering.VARIABLE: rendering.NONE}
    assert doctor._in_process(weightless, environment) == "a body does not fall"
    assert doctor._in_process(doctor._STEP, environment) == ""
    assert "assert" not in doctor._RENDER
