"""Where two modes change places in the list of damping ratios, a difference across that is no slope."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.effects.beams import with_airframe
from vgvt.reconcile.prediction import local_slopes, sides
from vgvt.reconcile.prediction.grouping import assembled, changed_places
from vgvt.reconcile.prediction.sides import sides_of
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem
from vgvt.scenario.airframe import Damping
from vgvt.simulation.assembly import plan
from vgvt.simulation.reduced import structure

ROOT = Hypothesis(available_effects()["root-compliance"], {"side": "both"})


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return problem(tmp_path_factory.mktemp("cache"), 1)


def test_ratios_that_two_modes_exchange_are_such_an_edge(case: Problem) -> None:
    """And a hundredth more of every ratio is none."""

    def damped(*ratios: float) -> Any:
        airframe = case.scenario.airframe
        damping = Damping(damping_ratio=0.01, modal=ratios)
        layout = plan(with_airframe(case.scenario, damping=damping))
        assert airframe is not layout.scenario.airframe
        return (SimpleNamespace(structure=structure(layout, layout.grid)),)

    assert changed_places(damped(0.01, 0.03), damped(0.03, 0.01))
    assert not changed_places(damped(0.01, 0.03), damped(0.0101, 0.0303))


@pytest.mark.parametrize("edges", [0, 1, 2])
def test_the_side_without_one_is_taken(case: Problem, monkeypatch: pytest.MonkeyPatch, edges: int) -> None:
    """Of a parameter; where there is one on either side the first has to do."""
    seen: list[int] = []

    def edge(here: Any, there: Any) -> bool:
        seen.append(len(seen))
        return len(seen) <= edges

    u, e = np.zeros(case.size), ROOT.scores({"bending": 0.05, "torsion": 0.05})
    here = anchor(case, u, (ROOT,), e)
    monkeypatch.setattr(sides, "changed_places", edge)
    first, second = sides_of(here.structures, u, (ROOT,), e, here.assembled)
    assert (first.step > 0) == (edges != 1)
    assert second.step > 0
    assert len(seen) == (3 if edges == 1 else 2 if edges == 0 else 3)


@pytest.mark.parametrize("both_sides", [True, False])
def test_so_it_is_of_an_unknown(case: Problem, monkeypatch: pytest.MonkeyPatch, both_sides: bool) -> None:
    """Where there is no aircraft on the other side the one across the edge has to do."""
    u = np.zeros(case.size)
    u[0] = 8.0
    stepped: list[float] = []

    def watched(problem: Problem, scores: Any, *more: Any) -> Any:
        stepped.append(float((scores - u)[1]))
        return assembled(problem, scores, *more) if both_sides or (scores - u).min() >= 0 else None

    monkeypatch.setattr(local_slopes, "assembled", watched)
    monkeypatch.setattr(local_slopes, "changed_places", lambda here, there: stepped[-1] > 0)
    local_slopes._slopes.cache_clear()
    group = anchor(case, u, slopes=False).assembled[0]
    found = local_slopes.slopes_for(case, (), local_slopes.Origin(u, np.zeros(0)), group)
    assert [s for s in stepped if s] == [local_slopes._STEP, -local_slopes._STEP]
    assert found.values is not case.slopes
    assert found.values["stiffness"][1].any()
    local_slopes._slopes.cache_clear()
