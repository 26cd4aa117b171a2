"""``vgvt sweep`` refuses keys that would change nothing, before any work, and says what to write instead."""

from __future__ import annotations

from pathlib import Path

import pytest

from vgvt.bench.bench import BenchPlan
from vgvt.bench.entry import Entry
from vgvt.bench.swept import require_free
from vgvt.bench.umpire import Limits
from vgvt.data import InputError
from vgvt.scenario import load_scenario
from vgvt.scenario.sweeps import Axis, sweep

_TWO_KINDS = ("--set", "excitation.kind=burst-random,linear-chirp", "--set", "excitation.burst_fraction=0.5")


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (["seed=1,2"], "write --seeds N"),
        (["simulation.engine=linear,mujoco"], "--engine linear simulates all variants\n  write --engine own"),
        (["simulation[engine]=linear,mujoco"], "write --engine own"),
        (["simulation.engine=linear,mujoco", "--engine", "mujoco"], "--engine mujoco simulates all variants"),
        (["simulation.step_s=1e-4,2e-4"], "--engine linear takes no steps"),
        (["name=a,b"], "no simulation depends on it"),
        (["summary=a,b"], "no simulation depends on it"),
        (["tolerances.damping=0.1,0.2"], "no simulation depends on it"),
        (["shaker.model=a,b"], "no simulation depends on it"),
        (
            ["excitation.blocks=2,4", *_TWO_KINDS],
            "changes nothing for quick-004",
        ),
    ],
)
def test_a_key_that_changes_nothing_is_refused(vgvt, tmp_path: Path, settings: list[str], words: str) -> None:
    result = vgvt("sweep", "quick", "--out", "made", "--workers", "0", "--set", *settings)
    assert (result.status, result.out) == (2, "")
    assert f"--set {settings[0].partition('=')[0]}: " in result.err
    assert words in result.err
    assert not (tmp_path / "made").exists()


def test_an_engine_can_be_swept_where_each_scenario_has_its_own() -> None:
    """What the column says is what was simulated."""
    axis = Axis.parse("simulation.engine=linear,mujoco")
    require_free([axis.key], None)
    variants = sweep(load_scenario("quick"), [axis])
    plan = BenchPlan(tuple(v.scenario for v in variants), 1, (Entry("quadrature"),), Limits(), engine=None)
    simulated = [cell.scenario.simulation.engine for cell in plan.cells()]
    assert simulated == [v.values[axis.key] for v in variants] == ["linear", "mujoco"]


def test_steps_can_be_swept_where_steps_are_taken() -> None:
    require_free(["simulation.step_s"], "mujoco")
    require_free(["simulation.step_s"], None)


def test_a_latin_hypercube_takes_the_whole_numbers_of_effects_and_says_how_many_variants_it_is(
    vgvt, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plans: list[BenchPlan] = []

    def planned(plan: BenchPlan, *_: object) -> None:
        plans.append(plan)
        raise InputError("bench", "has seen enough", "Go home.")

    monkeypatch.setattr("vgvt.bench.bench.bench", planned)
    text = 'name = "mine"\nsummary = "A trial."\nextends = "spoiled-payload-change"\n[acquisition]\nrepeats = 4\n'
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    command = ("sweep", "mine.toml", "--set", "effect[payload-change].from_run=2..4", "--design", "latin")
    said = [vgvt(*command, "--samples", samples).err for samples in (9, 3)]
    assert all("has seen enough" in words for words in said), said
    for plan in plans:
        assert sorted(scenario.effect[0].parameters["from_run"] for scenario in plan.scenarios) == [2, 3, 4]
    assert "9 samples are 3 different variants" in said[0]
    assert "different variants" not in said[1]
