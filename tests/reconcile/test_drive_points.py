"""Other drive points of a next test: each on the part that is there, and none off the aircraft."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from vgvt.effects.beams import written_out
from vgvt.reconcile.next_test.procedures import procedures
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.placement import placement_problems

FORWARD = "excite 10 cm further forward"
MIDDLE, MIRROR = "excite on the centre line", "excite at the mirror image of the drive point"


def excited(scenario: Scenario) -> dict[str, Scenario]:
    """What every move of the shaker makes of a scenario."""
    runs = scenario.acquisition.run_nodes
    measured = SimpleNamespace(runs=runs, run_numbers=tuple(range(1, len(runs) + 1)))
    problem: Any = SimpleNamespace(scenario=scenario, measured=measured)
    return {p.words: p.edit(scenario) for p in procedures(problem) if p.words.startswith("excite")}


def pushed_at(scenario: Scenario, part: str, *place: float) -> Scenario:
    """The scenario with its shaker somewhere else."""
    shaker = scenario.shaker.model_copy(update={"position_m": place, "attached_to": part})
    return scenario.model_copy(update={"shaker": shaker})


def bare(scenario: Scenario) -> Scenario:
    """The scenario with a body that has no outline."""
    airframe = scenario.airframe
    body = airframe.body.model_copy(update={"outline_m": ()})
    return scenario.model_copy(update={"airframe": airframe.model_copy(update={"body": body})})


@pytest.mark.parametrize("as_built", [False, True])
def test_a_moved_shaker_pushes_on_the_part_that_is_there(as_built: bool) -> None:
    """Under the wing tip of the testbed: its wing ends 50 mm behind the third point; the fuselage has no outline."""
    stated = load_scenario("garteur-sm-ag19")
    moved = excited(written_out(stated) if as_built else stated)
    parts = {words: s.shaker.attached_to for words, s in moved.items()}
    assert parts == {MIRROR: "wing-left", MIDDLE: "nose"}
    assert moved[MIRROR].shaker.position_m == (0.45, -0.95, 0.0755)
    assert moved[MIDDLE].shaker.position_m == (0.45, 0.0, 0.0755)
    for s in moved.values():
        assert placement_problems(s.airframe, None, s.shaker, None) == ()


@pytest.mark.parametrize("name", ["quick", "bff", "skoll-gvt1", "teaching-beam"])
def test_where_the_aircraft_reaches_all_three_are_offered(name: str) -> None:
    moved = excited(load_scenario(name))
    assert set(moved) == {FORWARD, MIDDLE, MIRROR}
    for s in moved.values():
        assert placement_problems(s.airframe, None, s.shaker, None) == ()


@pytest.mark.parametrize("without_outline", [False, True])
def test_nothing_is_pushed_on_ahead_of_a_wing(without_outline: bool) -> None:
    """Not on a body without an outline either, which takes any point that no wing has."""
    beam = load_scenario("teaching-beam")
    beam = pushed_at(bare(beam) if without_outline else beam, "beam", -0.1, 0.8, 0.0)
    assert set(excited(beam)) == {MIDDLE, MIRROR}


def test_on_a_body_without_outline_the_shaker_may_be_moved() -> None:
    body = excited(bare(load_scenario("quick")))
    assert {words: s.shaker.attached_to for words, s in body.items()} == dict.fromkeys(
        (FORWARD, MIDDLE, MIRROR), "body"
    )


def test_a_fin_takes_no_push_beside_it() -> None:
    """Ahead of the tailplane there is nothing; the fin, a point as seen from above, has no outline and is nearest."""
    tail = excited(pushed_at(load_scenario("garteur-sm-ag19"), "tailplane", 1.4, 0.15, 0.375))
    assert FORWARD not in tail
    assert tail[MIRROR].shaker.attached_to == "tailplane-left"
