"""Damping ratios that go to no mode are said where a scenario is given, and nowhere else."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from vgvt.scenario import bundled_scenarios, load_scenario, spoiled_scenarios
from vgvt.simulation.once import damping_once

PAGE = Path(__file__).parents[2] / "docs/how-to/write-your-own-scenario.md"


def plank(folder: Path, damping: str) -> Path:
    """The plank of the how-to with a table of damping: its elastic modes lie at 14, 40, 77 and 103 Hz."""
    text = PAGE.read_text(encoding="utf-8")
    (scenario,) = (block for block in re.findall(r"```toml\n(.*?)```", text, re.S) if 'name = "plank"' in block)
    path = folder / "plank.toml"
    path.write_text(f"{scenario}\n[airframe.damping]\n{damping}\n", encoding="utf-8")
    return path


def test_show_says_what_the_modes_above_the_limit_get(vgvt, tmp_path: Path) -> None:
    result = vgvt("show", plank(tmp_path, "modal = [0.01, 0.02, 0.03, 0.04]"), "--no-picture", "--json")
    assert result.status == 0
    modes = [mode for mode in result.document["modes"] if mode["frequency_hz"] < 110]
    got = [100 * mode["damping_ratio"] for mode in modes[-4:]]
    assert got[:2] == pytest.approx([1.0, 2.0], rel=1e-3)
    warning = "airframe.damping.modal has 4 ratios, of which the last 2 go to no mode: above limit_hz 60"
    assert warning in result.err
    for mode, percent in zip(modes[-2:], got[2:], strict=True):
        assert f"{percent:.2f} % at {mode['frequency_hz']:.5g} Hz" in result.err
    (limit,) = re.findall(r"write limit_hz = (\d+)", result.err)
    advised = vgvt(
        "show", plank(tmp_path, f"modal = [0.01, 0.02, 0.03, 0.04]\nlimit_hz = {limit}.0"), "--no-picture", "--json"
    )
    kept = [mode["damping_ratio"] for mode in advised.document["modes"] if mode["frequency_hz"] < 110]
    assert kept[-4:] == pytest.approx([0.01, 0.02, 0.03, 0.04], rel=1e-3)
    assert "damping" not in advised.err


@pytest.mark.parametrize("command", ["simulate", "run"])
def test_so_do_simulate_and_run(vgvt, simulations, tmp_path: Path, command: str) -> None:
    result = vgvt(command, plank(tmp_path, "modal = [0.01, 0.02, 0.03]"), "--out", "made")
    assert result.status == 0
    assert "the last 1 go to no mode" in result.err
    assert simulations == ["plank"]


def test_more_ratios_than_modes(vgvt, tmp_path: Path) -> None:
    ratios = ", ".join(["0.01"] * 60)
    said = vgvt("show", plank(tmp_path, f"modal = [{ratios}]\nlimit_hz = 9000.0"), "--no-picture").err
    assert "the last 12 go to no mode: there are 48 elastic modes; leave them out" in said


@pytest.mark.parametrize("name", bundled_scenarios())
def test_no_bundled_airframe_has_such_a_ratio(name: str) -> None:
    airframe = load_scenario(name).airframe
    assert damping_once(airframe).without_effect(airframe.damping) is None


def test_nor_has_a_spoiled_one() -> None:
    for airframe in {load_scenario(name).airframe for name in spoiled_scenarios()}:
        assert damping_once(airframe).without_effect(airframe.damping) is None
