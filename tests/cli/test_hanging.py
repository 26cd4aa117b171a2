"""An aircraft that a plan's sensors pull askew is said to hang askew, with what to do."""

from __future__ import annotations

import pytest

from vgvt.cli.boundary import run_command
from vgvt.cli.hanging import hanging, hanging_askew
from vgvt.scenario import load_scenario
from vgvt.simulation.attitude import attitudes_deg


def test_words_for_how_it_hangs() -> None:
    assert hanging(((-0.01, 0.04),)) == "hangs at +0.0° of roll (left wing down) and +0.0° of pitch (nose up)"
    assert hanging_askew(((2.9, -2.9),)) is None
    assert hanging_askew(((1.0, 0.0), (-7.9, 0.02))) == "hangs askew in run 2: right wing 7.9° low"
    assert hanging_askew(((1.0, -66.5),)) == "hangs askew in run 1: left wing 1.0° low, nose 66.5° down"


def test_a_plan_that_hangs_askew_says_so(tmp_path, capsys: pytest.CaptureFixture[str]) -> None:
    """Ten accelerometers of 2.8 g, most of them on the right wing, rolled Hati by 8 degrees without a word."""
    out = tmp_path / "plan"
    budget = ["--sensors", "10", "--points", "20", "--minutes", "20", "--free", "shaker,sensors,sweep-time"]
    assert run_command(["plan", "quick", *budget, "--seeds", "0", "--out", str(out)]) == 0
    said = capsys.readouterr().err
    planned = load_scenario(out / "plan.toml")
    repeats = planned.acquisition.repeats
    assert repeats > 1  # a run is a group of sensors, however often it is swept
    rolls = [roll for roll, _ in attitudes_deg(planned)[::repeats]]
    run = max(range(2), key=lambda k: abs(rolls[k])) + 1
    assert abs(rolls[run - 1]) > 3
    assert f"hangs askew in run {run}: right wing {abs(rolls[run - 1]):.1f}° low" in said and "counterweight" in said
    card = (out / "card.html").read_text(encoding="utf-8")
    assert f"right wing down by {abs(rolls[0]):.1f}°" in card and f"right wing down by {abs(rolls[1]):.1f}°" in card
