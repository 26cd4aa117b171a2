"""Levels of force that are offered as a next test: none that the instruments would cut off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from reconciled_case import claimed, roving_problem

from vgvt.reconcile.next_test.procedures import levels_to_try
from vgvt.reconcile.question.problem import Problem
from vgvt.scenario.model import Scenario


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return roving_problem(tmp_path_factory.mktemp("cache"), lines=100)


def offered(case: Problem, stated: Scenario) -> list[str]:
    """The levels by their words, where this is the scenario that is stated."""
    rattling = claimed(case, "rattling-mass", {"mass_kg": 0.02})
    there = replace(rattling, problem=replace(case, stated=stated))
    return [p.words.removeprefix("sweep again with ").removesuffix(" the force") for p in levels_to_try([there])]


def test_twice_the_force_is_offered_where_nothing_overloads(case: Problem) -> None:
    assert offered(case, case.stated) == ["twice", "half", "a quarter of"]


@pytest.mark.parametrize("what", ["force", "acceleration", "command"])
def test_a_level_that_would_be_cut_off_is_not_offered(case: Problem, what: str) -> None:
    """One and a half times the largest of the first campaign is no room for twice of it; three times is."""
    measured, stated = case.measured, case.stated

    def with_room(times: float) -> Scenario:
        if what == "force":
            largest = float(np.abs(measured.pushed).max())
            return changed(stated, "transducer", range_n=times * largest)
        if what == "acceleration":
            return changed(stated, "accelerometers", range_g=times * measured.largest_m_per_s2 / 9.80665)
        return changed(stated, "generator", range_v=times * stated.excitation.amplitude_v)

    assert offered(case, with_room(1.5)) == ["half", "a quarter of"]
    assert offered(case, with_room(3.0)) == ["twice", "half", "a quarter of"]


def changed(scenario: Scenario, table: str, **values: float) -> Scenario:
    return scenario.model_copy(update={table: getattr(scenario, table).model_copy(update=values)})


def test_the_largest_acceleration_is_that_of_the_records(case: Problem) -> None:
    """Of a sweep at A/F it is no more than its largest ratio times the largest force, and no less than a tenth."""
    measured = case.measured
    most = float(np.abs(measured.values[measured.used]).max() * np.abs(measured.pushed).max())
    assert 0.1 * most < measured.largest_m_per_s2 < 1.2 * most
