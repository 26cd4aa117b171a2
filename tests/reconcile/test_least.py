"""Below a parameter's least there is no effect: a scenario that says so is refused, and so no fit may end there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from reconciled_case import campaign_of, problem, small_scenario

from vgvt.effects import available_effects, parameters_of
from vgvt.reconcile.fitting.fit import NEAR, fit
from vgvt.reconcile.prediction.carried import Structures
from vgvt.reconcile.prediction.grouping import assembled
from vgvt.reconcile.prediction.sides import sides_of
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import make_problem

AIR = Hypothesis(available_effects()["entrained-air"])
DRAG = {"drag_n_s_per_m3": 0.5}


@pytest.mark.parametrize("settings", [{}, {"mass_fraction": -0.1}], ids=["fitted", "chosen"])
def test_an_effect_is_none_below_its_least(settings: dict[str, float]) -> None:
    air = Hypothesis(AIR.cls, settings)
    assert air.effect({"mass_fraction": -0.1, **DRAG} if not settings else DRAG) is None
    assert AIR.effect({"mass_fraction": 0.0, **DRAG}) is not None
    assert AIR.effect({"mass_fraction": 0.5, "drag_n_s_per_m3": -1.0}) is None


@pytest.mark.parametrize("name", sorted(available_effects()))
def test_no_score_leads_below_it(name: str) -> None:
    """As far as a fit may go: every value could be written to a scenario."""
    hypothesis = Hypothesis(available_effects()[name])
    for far in (-1e3, 1e3):
        values = hypothesis.values(np.full(len(hypothesis.parameters), far))
        assert all(p.least is None or values[p.name] >= p.least for p in parameters_of(hypothesis.cls))


def test_a_start_that_does_nothing_lies_on_the_limit_and_has_a_slope_inwards(tmp_path: Path) -> None:
    case = problem(tmp_path, 3)
    nothing = AIR.scores({"mass_fraction": 0.0, **DRAG})
    assert AIR.values(nothing)["mass_fraction"] == 0.0
    here = assembled(case, np.zeros(case.size), (AIR,), nothing)
    assert here is not None
    side, _ = sides_of(Structures(case), np.zeros(case.size), (AIR,), nothing, here)
    heavier = np.trace(side.there[0].structure.mass) - np.trace(side.here[0].structure.mass)
    assert heavier / side.step > 0.0


def test_a_fit_that_would_go_below_ends_beside_it(tmp_path: Path) -> None:
    """A wing that is lighter than stated: less air than none would explain it."""
    scenario = small_scenario()
    (wing,) = scenario.airframe.beam
    stations = wing.stations.model_copy(update={"mass_kg_per_m": tuple(0.9 * m for m in wing.stations.mass_kg_per_m)})
    lighter = scenario.airframe.model_copy(update={"beam": (wing.model_copy(update={"stations": stations}),)})
    truth = campaign_of(scenario.model_copy(update={"airframe": lighter}), 3)
    case = make_problem(truth, scenario, lines=100, cache=tmp_path)
    begun = AIR.scores({"mass_fraction": 0.3, **DRAG})
    found = fit(case, (AIR,), np.zeros(case.size), begun, NEAR)
    assert 0.0 <= found.values(0)["mass_fraction"][0] < 0.05
    assert found.ranges(0)["mass_fraction"][0] == 0.0
    assert found.cost < fit(case, (AIR,), np.zeros(case.size), begun, ()).cost
