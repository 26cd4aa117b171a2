"""The run in which a change began is told by the campaign's own number; ``[[effect]]`` counts runs, and keeps that."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from account_by_hand import account
from reconciled_case import roving_scenario

from vgvt.cli.reconcile_tables import effects_table
from vgvt.effects import available_effects
from vgvt.reconcile.decision.verdict import NamedEffect, _effect_document
from vgvt.reconcile.outcome import augment
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import make_problem
from vgvt.reconcile.search.candidates import candidates
from vgvt.simulation import simulated_campaign
from vgvt.view.reconcile_sections import named_section
from vgvt.view.reconcile_wording import parameter_text

NUMBERS = (2, 3, 4, 5)
TOLD = "from_run = 3 (run 4 of the campaign)"


def named(numbers: tuple[int, ...]) -> NamedEffect:
    """A change from the third run on in a campaign whose runs have these numbers."""
    found = thing(numbers)
    parameters = {"drift": (-0.02, 0.001, "")}
    return NamedEffect(
        "run-drift", "", parameters, dict(found.settings), 50.0, (), 9.0, 1.0, run_numbers=found.run_numbers
    )


def thing(numbers: tuple[int, ...], **settings: Any) -> Hypothesis:
    chosen = settings or {"shape": "step", "from_run": 3}
    return Hypothesis(available_effects()["run-drift"], chosen, numbers=numbers)


def test_a_label_calls_the_run_what_the_campaign_does() -> None:
    assert thing(NUMBERS).label == "run-drift (shape = step, from run 4)"
    for same in ((1, 2, 3, 4), (), (7,)):
        assert thing(same).label == "run-drift (shape = step, from_run = 3)"
    assert thing(NUMBERS, shape="linear").label == "run-drift (shape = linear)"
    # As copies do that have another size, or course.
    assert replace(thing(NUMBERS), settings={"from_run": 2}).label == "run-drift (from run 3)"


def test_a_name_is_told_so_by_terminal_page_json_and_header() -> None:
    e = named(NUMBERS)
    assert TOLD in e.in_words
    document = _effect_document(e)
    assert document["settings"] == {"shape": "step", "from_run": 3} and document["run_numbers"] == {"from_run": 4}
    (row,) = effects_table([document]).rows  # type: ignore[list-item]
    assert TOLD in row[1]
    told = replace(account().effects[0], settings=e.settings, run_numbers=e.run_numbers)
    assert TOLD in parameter_text(told) and TOLD in named_section(replace(account(), effects=(told,)))
    assert f"#   {TOLD}" in augment._values(e)


def test_numbers_that_count_runs_are_told_once() -> None:
    e = named((1, 2, 3, 4))
    document = _effect_document(e)
    assert document["run_numbers"] == {"from_run": 3}
    (row,) = effects_table([document]).rows  # type: ignore[list-item]
    assert row[1].endswith("shape = step, from_run = 3") and "of the campaign" not in e.in_words
    assert "#   from_run = 3" in augment._values(e)


def test_candidates_know_the_numbers_of_the_campaign(tmp_path: Path) -> None:
    """Whatever the runs are called that a scenario states in their order."""
    scenario = roving_scenario()
    campaign = simulated_campaign(scenario, engine="linear")
    runs = tuple(replace(run, run=number) for run, number in zip(campaign.runs, NUMBERS, strict=True))
    case = make_problem(replace(campaign, runs=runs), scenario, lines=100, cache=tmp_path)
    assert case.measured.run_numbers == NUMBERS
    found = candidates(case, {"run-drift": available_effects()["run-drift"]})
    assert {h.label for h in found if "from_run" in h.settings} == {
        f"run-drift (shape = step, from run {number})" for number in NUMBERS[1:]
    }
    # A run without any channel is called by its place.
    kept = case.measured.some(np.array([c.run != 2 for c in case.measured.channels]))
    assert kept.run_numbers == (2, 3, 3, 5)
