"""A gauge the wrong way round: seen by phases at the stated values, and named although nothing of it is small."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from reconciled_case import campaign_of, problem, small_scenario

from vgvt.effects import available_effects
from vgvt.reconcile import reconcile
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.search.candidates import candidates
from vgvt.reconcile.search.from_stated import from_stated
from vgvt.reconcile.work.progress import silent

FLIP = available_effects()["sign-flip"]


@pytest.fixture(scope="module")
def right(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return problem(tmp_path_factory.mktemp("cache"), 4)


def turned_round(case: Problem, rows: np.ndarray) -> Fit:
    """The stated values beside data of which some channels (C,) are read the wrong way round."""
    values = np.where(rows[:, None], -case.measured.values, case.measured.values)
    other = replace(case, measured=replace(case.measured, values=values))
    return fit(other, (), np.zeros(other.size), np.zeros(0), ())


def test_phases_tell_which_channels_are_turned_round(right: Problem) -> None:
    """All of them, or one alone; of data that are right none."""
    offered = candidates(right, {"sign-flip": FLIP})
    fitted = int(np.flatnonzero(right.split.train)[0])
    every, one = np.ones(len(right.measured.channels), dtype=bool), np.arange(len(right.measured.channels)) == fitted
    found = from_stated(turned_round(right, every), offered, silent)
    assert [s.hypothesis.settings["channels"] for s in found] == ["response"]
    few = from_stated(turned_round(right, one), offered, silent)
    # A single one of many is no cause to bend a calibration, and has its turn in the screen.
    assert all(s.hypothesis.settings["channels"] == right.measured.channels[fitted].label.split()[-1] for s in few)
    assert from_stated(turned_round(right, ~every), offered, silent) == ()


@pytest.mark.slow
def test_a_reversed_gauge_of_one_run_is_named(tmp_path: Path) -> None:
    """Four sensors in one run: a calibration turns the aircraft round to meet them, and had been "unknown"."""
    scenario = small_scenario()
    one_run = scenario.model_copy(
        update={"acquisition": scenario.acquisition.model_copy(update={"runs": (scenario.acquisition.runs[0][:4],)})}
    )
    campaign = campaign_of(one_run, 3, FLIP(channels="force"))
    verdict = reconcile(campaign, one_run, effects={"sign-flip": FLIP}, lines=100, with_tests=False)
    assert [(e.name, e.settings["channels"]) for e in verdict.effects] == [("sign-flip", "response")]
    assert any("force gauge" in reason for reason in verdict.reasons)
