"""Readings of a rig that changed between runs, of sensors whose gains are fitted, and of what a reading is expected."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, claimed, roving_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.fitting.fit import TO_THE_END, calibrate, fit
from vgvt.reconcile.next_test.checks import Check, checks, reading_nats, seen
from vgvt.reconcile.next_test.with_reading import followed_nats
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A campaign of four runs with five roving sensors."""
    scenario = roving_scenario()
    return make_problem(campaign_of(scenario, 1), scenario, lines=60, cache=tmp_path_factory.mktemp("cache"))


def check(case: Problem, words: str) -> Check:
    (found,) = (c for c in checks(case) if words in c.words)
    return found


@pytest.mark.parametrize(
    ("words", "name", "values", "wanted"),
    [
        ("tape where the shaker", "drive-remount", {"shift_y_m": 0.02, "from_run": 3}, [0.0, 0.02]),
        ("tape where the hook", "re-hang", {"shift_x_m": 0.03, "from_run": 2}, [0.03, 0.0, 0.0]),
    ],
)
def test_what_is_read_after_a_campaign_is_how_its_last_run_left_the_rig(
    case: Problem, words: str, name: str, values: dict[str, Any], wanted: list[float]
) -> None:
    effect, tape = available_effects()[name](**values), check(case, words)
    shown = tape.read(seen(case.scenario, [effect])) - tape.read(seen(case.scenario, []))
    assert shown == pytest.approx(wanted)


def test_a_tape_tells_not_when_a_drive_point_was_moved(case: Problem) -> None:
    """Two centimetres off from the first run on, or from the third on: afterwards they are one."""
    always = claimed(case, "drive-point-offset", {"dy_m": 0.02})
    later = claimed(case, "drive-remount", {"shift_y_m": 0.02}, from_run=3)
    tape = check(case, "tape where the shaker")
    for one, other in ((always, later), (later, always)):
        assert reading_nats(one, other, tape) == pytest.approx(0.0, abs=0.5)
