"""A calibration that stopped on the wrong side of a resonance looks across the hump."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from vgvt.reconcile import make_problem
from vgvt.reconcile.fitting import calibration, other_valleys
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.question.uncertain import edited, unknowns
from vgvt.reconcile.rehearsal import placebo_campaign
from vgvt.scenario import load_scenario
from vgvt.simulation import simulated_campaign

_TRUE, _WRONG = -1.4, 1.2


@pytest.fixture(scope="module")
def fin() -> tuple[Problem, int]:
    """The GARTEUR aircraft with a fin soft in torsion, and which of its unknowns that is."""
    whole = load_scenario("garteur-sm-ag19")
    # Stretches of beams, half of the unknowns, have no part in this.
    scenario = whole.model_copy(update={"tolerances": whole.tolerances.model_copy(update={"segments": 0})})
    known = unknowns(scenario)
    index = next(k for k, unknown in enumerate(known) if unknown.name == "GJ fin")
    scores = np.zeros(len(known))
    scores[index] = _TRUE
    campaign = simulated_campaign(edited(scenario, known, scores), engine="linear")
    return make_problem(replace(campaign, name="soft fin", notes={}), scenario, lines=60), index


def test_the_valley_of_the_truth_is_seen_across_the_hump(fin: tuple[Problem, int]) -> None:
    """As low as this with nothing else moved, far on the other side, from scores that no descent leaves."""
    problem, index = fin
    scores = np.zeros(problem.size)
    scores[index] = _WRONG
    lowest = other_valleys.other_valleys(problem, scores)[0]
    assert lowest.index == index
    assert lowest.score == pytest.approx(_TRUE, abs=0.2)
    assert lowest.misfit < 0.95


@pytest.mark.parametrize(
    ("known", "score", "expected"),
    [
        ({-2.5: 2.0, -1.5: 0.9, -1.0: 1.2, 1.0: 1.0, 2.5: 3.0}, 1.0, [-1.5]),  # across a hump, lower
        ({-2.5: 2.0, -1.5: 1.05, -1.0: 1.2, 1.0: 1.0, 2.5: 3.0}, 1.0, [-1.5]),  # as low, with nothing else moved yet
        ({-2.5: 2.0, -1.5: 1.15, -1.0: 1.3, 1.0: 1.0, 2.5: 3.0}, 1.0, []),  # higher than what moves with it gives back
        ({-2.5: 2.0, -1.5: 0.9, 1.0: 1.0, 2.5: 3.0}, 1.0, []),  # down a slope, which a descent finds by itself
        ({-2.5: 1.0, -1.5: 0.9, -1.0: 1.2, 2.5: 3.0}, -2.0, []),  # the hump is on the far side
        ({-2.5: 0.8, -1.5: 1.2, 1.0: 1.0, 2.5: 3.0}, 1.0, [-2.5]),  # at the edge of what is looked at
    ],
)
def test_a_valley_has_a_hump_before_it(known: dict[float, float], score: float, expected: list[float]) -> None:
    """Shares of the misfit here, straight lines between the values that are given."""
    grid = other_valleys._GRID
    misfit = np.interp(grid, list(known), list(known.values()))
    assert [float(grid[i]) for i in other_valleys._across(misfit, score)] == expected


def _fake(u: NDArray[np.float64], cost: float) -> Any:
    return SimpleNamespace(problem="problem", u=u, cost=cost)


def test_the_lowest_of_the_valleys_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each is gone down from where only its own score has moved; a way that has no aircraft, or is higher, is not."""
    begun: list[list[float]] = []
    ends = iter(
        [_fake(np.full(2, 7.0), 12.0), calibration.NoStructureError("no such structure"), _fake(np.ones(2), 8.0)]
    )

    def fit(problem: Any, hypotheses: Any, u: NDArray[np.float64], *rest: Any, **options: Any) -> Any:
        begun.append(u.tolist())
        found = next(ends)
        if isinstance(found, Exception):
            raise found
        return found

    valleys = [other_valleys.Valley(k, v, 0.9) for k, v in ((0, -1.0), (1, 2.0), (0, 2.5))]
    monkeypatch.setattr(calibration, "other_valleys", lambda problem, u, progress: valleys)
    monkeypatch.setattr(calibration, "fit", fit)
    first = _fake(np.array([0.5, 0.25]), 10.0)
    assert calibration._lowest(first, None).cost == 8.0
    assert begun == [[-1.0, 0.25], [0.5, 2.0], [2.5, 0.25]]
    assert first.u.tolist() == [0.5, 0.25]


@pytest.mark.slow
def test_a_placebo_is_met_whose_fin_was_on_the_wrong_side() -> None:
    """All tolerances of the aircraft are drawn: its calibration had ended at 1.64, where noise leaves 0.87."""
    scenario = load_scenario("garteur-sm-ag19")
    found: Fit = calibrate(make_problem(placebo_campaign(scenario, 10), scenario, lines=100))
    assert found.chi2_per_dof < 0.95
    assert found.u[found.problem.names.index("GJ fin")] < -0.5
