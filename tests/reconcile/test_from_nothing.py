"""Effects at exactly the value that does nothing, where runs that they part and channels that they touch are alike."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_problem, roving_scenario

from vgvt.effects import available_effects, make_effect
from vgvt.reconcile.fitting.fit import STAGES, fit
from vgvt.reconcile.fitting.misfit import data_misfit, jacobian
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem

STEP = 1e-3
KINDS: dict[str, tuple[dict[str, Any], dict[str, float]]] = {
    "run-drift": ({"shape": "step", "from_run": 3}, {"drift": 0.03}),
    "re-hang": ({"from_run": 3}, {"shift_x_m": 0.03, "shift_y_m": 0.0}),
    "drive-remount": ({"from_run": 3}, {"shift_x_m": 0.02, "shift_y_m": 0.01}),
    "temperature-change": (
        {"shape": "linear", "stiffness_per_k": -4e-4, "damping_per_k": 0.0}, {"warming_k": 15.0},
    ),
    "channel-gain": ({"channels": "response"}, {"gain_error": 0.05}),
    "gain-drift": ({"channels": "response", "shape": "linear"}, {"drift": 0.05}),
}  # fmt: skip


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """Five sensors that rove in four runs."""
    return roving_problem(tmp_path_factory.mktemp("cache"), 60)


@pytest.mark.parametrize("name", KINDS)
def test_what_does_nothing_yet_has_the_slope_of_what_it_would_do(case: Problem, name: str) -> None:
    """One group of runs at nothing is several a step away: all slopes had been nothing, too."""
    hypothesis = Hypothesis(available_effects()[name], KINDS[name][0])
    u, e = np.zeros(case.size), np.zeros(len(hypothesis.parameters))
    here = anchor(case, u, (hypothesis,), e)
    known = jacobian(here, u, e, here.predict(u, e))[:, case.size :]
    # The prediction itself is none the other for it.
    plain = anchor(case, u, (hypothesis,), e, slopes=False)
    np.testing.assert_allclose(here.predict(u, e), plain.predict(u, e), rtol=1e-8)
    for j in range(e.size):
        asides = [e + s * STEP * np.eye(e.size)[j] for s in (1, -1)]
        ends = [data_misfit(case, anchor(case, u, (hypothesis,), a, slopes=False).predict(u, a)) for a in asides]
        wanted = (ends[0] - ends[1]) / (2 * STEP)
        assert np.linalg.norm(wanted) > 1
        assert np.linalg.norm(known[:, j] - wanted) < 0.05 * np.linalg.norm(wanted)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name == "channel-gain" else pytest.mark.slow) for name in KINDS]
)
def test_a_fit_begun_at_nothing_arrives(name: str, tmp_path: Path) -> None:
    settings, values = KINDS[name]
    scenario = roving_scenario()
    campaign = campaign_of(scenario, 1, make_effect(name, "test", **values, **settings))
    case = make_problem(campaign, scenario, lines=60, cache=tmp_path)
    hypothesis = Hypothesis(available_effects()[name], settings)
    u, count = np.zeros(case.size), len(hypothesis.parameters)
    found, near = (fit(case, (hypothesis,), u, np.full(count, at), STAGES) for at in (0.0, 0.2))
    assert found.converged
    assert abs(found.cost - near.cost) < 1.0
    np.testing.assert_allclose(found.e, near.e, atol=0.02)
    assert np.abs(found.e).max() > 0.3
