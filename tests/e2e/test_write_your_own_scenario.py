"""The plank of the how-to loads, simulates, has the frequencies that the page states, and fails as the page says."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.scenario import load_scenario, rigid_body_properties
from vgvt.simulation import simulate

PAGE = (Path(__file__).resolve().parents[2] / "docs/how-to/write-your-own-scenario.md").read_text(encoding="utf-8")
EXTENDING, PLANK = re.findall(r"^```toml\n(.*?)^```", PAGE, flags=re.MULTILINE | re.DOTALL)[:2]
ANSWERS = re.findall(r"^\| `([^`|]+)` \| `([^`|]+)` \| `([^`|]+)` ([^|]+) \|$", PAGE, flags=re.MULTILINE)


def written(folder: Path, text: str) -> Path:
    file = folder / "plank.toml"
    file.write_text(text, encoding="utf-8")
    return file


def test_the_plank_has_the_frequencies_of_a_free_beam_with_a_mass_in_the_middle(tmp_path: Path) -> None:
    """Rayleigh: a mass m at the middle, which moves 0.608 of the tip, against a quarter of the plank's mass."""
    scenario = load_scenario(written(tmp_path, PLANK))
    linear = scenario.model_copy(update={"simulation": scenario.simulation.model_copy(update={"engine": "linear"})})
    result = simulate(linear)
    assert len(result.campaign.runs) == 2
    assert rigid_body_properties(scenario.airframe).mass_kg == pytest.approx(1.08 * 1.2 + 0.02)
    first, second = result.truth.bare.natural_frequency_hz[:2]
    free = np.array([4.730041, 7.853205]) ** 2 / (2 * np.pi * 1.2**2) * np.sqrt(37.3 / 1.08)
    assert first == pytest.approx(free[0] / np.sqrt(1 + 0.02 * 0.608**2 / (1.08 * 1.2 / 4)), rel=2e-3)
    assert second == pytest.approx(free[1], rel=2e-3)
    for stated in (first, free[0], second):
        assert f"{stated:.2f} Hz" in PAGE


def test_the_extending_example_changes_what_it_says(tmp_path: Path) -> None:
    scenario, parent = load_scenario(written(tmp_path, EXTENDING)), load_scenario("hati-unsymmetric")
    assert scenario.suspension.stiffness_n_per_m == parent.suspension.stiffness_n_per_m / 2
    assert scenario.airframe.item[:-1] == parent.airframe.item
    assert scenario.airframe.item[-1].name == "camera"


def test_there_are_answers() -> None:
    assert len(ANSWERS) >= 8


@pytest.mark.parametrize(("right", "wrong", "key", "answer"), ANSWERS, ids=[a[2] for a in ANSWERS])
def test_a_mistake_gets_the_answer_on_the_page(tmp_path: Path, right: str, wrong: str, key: str, answer: str) -> None:
    assert PLANK.count(right) == 1
    with pytest.raises(InputError) as caught:
        load_scenario(written(tmp_path, PLANK.replace(right, wrong)))
    assert caught.value.where.endswith(f": {key}")
    assert f"{caught.value.problem}. {caught.value.advice}" == answer


@pytest.mark.parametrize(
    ("right", "wrong", "key"),
    [
        ("position_m = [0.05, 0.45, 0.0]", "position_m = [9.0, 0.45, 0.0]", "shaker.position_m"),
        ("x_m = [0.05, 0.05,", "x_m = [0.05, 9.0,", "accelerometers.grid.x_m[1]"),
    ],
)
def test_nine_metres_are_off_the_plank_without_its_outlines_too(
    tmp_path: Path, right: str, wrong: str, key: str
) -> None:
    bare = re.sub(r"^(?:outline_m|forward_edge_m|aft_edge_m) = .*\n", "", PLANK, flags=re.MULTILINE)
    assert load_scenario(written(tmp_path, bare)).airframe.body.outline_m == ()
    with pytest.raises(InputError, match="has no outline") as caught:
        load_scenario(written(tmp_path, bare.replace(right, wrong)))
    assert caught.value.where.endswith(f": {key}")
