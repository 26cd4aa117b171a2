"""A beam that is cut too coarsely for the bends of its axis is told of where a scenario is given."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from vgvt.scenario import bundled_scenarios, load_scenario
from vgvt.scenario.cells import bent_within_a_cell

PAGE = Path(__file__).parents[2] / "docs/how-to/write-your-own-scenario.md"


@pytest.fixture
def turned_up(tmp_path: Path) -> Path:
    """The plank of the how-to with tips that turn up on less than a cell."""
    text = PAGE.read_text(encoding="utf-8")
    (scenario,) = (block for block in re.findall(r"```toml\n(.*?)```", text, re.S) if 'name = "plank"' in block)
    bent = scenario.replace("[0.05, 0.6, 0.0]]", "[0.05, 0.59, 0.0], [0.05, 0.6, 0.02]]")
    bent = re.sub(r"= \[([^,\[\]]+), \1\]$", r"= [\1, \1, \1]", bent, flags=re.M)
    path = tmp_path / "plank.toml"
    path.write_text(bent, encoding="utf-8")
    return path


def test_show_and_simulate_say_how_many_cells_are_enough(vgvt, turned_up: Path, simulations: list[str]) -> None:
    warning = "vgvt: warning: the axis of beam 'plank' bends by 63° within one of its cells"
    shown = vgvt("show", turned_up, "--no-picture")
    assert shown.status == 0
    assert warning in shown.err
    assert warning in vgvt("simulate", turned_up, "--out", "made").err
    assert simulations == ["plank"]
    (cells,) = re.findall(r"write cells = (\d+), not 12", shown.err)
    finer = turned_up.read_text(encoding="utf-8").replace("mirror = true ", f"cells = {cells}\nmirror = true ")
    turned_up.write_text(finer, encoding="utf-8")
    assert "warning" not in vgvt("show", turned_up, "--no-picture").err


@pytest.mark.parametrize("name", bundled_scenarios())
def test_no_bundled_beam_bends_within_a_cell(name: str) -> None:
    assert not any(bent_within_a_cell(beam) for beam in load_scenario(name).airframe.beam)
