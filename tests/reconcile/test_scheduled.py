"""Changes between runs: one derivative for every course, against predictions of each course as a whole."""

from __future__ import annotations

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import available_effects
from vgvt.effects.parameter import Parameter
from vgvt.reconcile.fitting.fit import fit
from vgvt.reconcile.prediction.scheduled import whole_and_shares
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.search.stand import Stand


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """Four runs of five sensors."""
    scenario = roving_scenario()
    return make_problem(campaign_of(scenario, 1), scenario, lines=150, cache=tmp_path_factory.mktemp("cache"))


@pytest.fixture(scope="module")
def stand(case: Problem) -> Stand:
    """On the nominal aircraft."""
    return Stand.of(fit(case, (), np.zeros(case.size), np.zeros(0), ()))


@pytest.mark.parametrize(
    ("settings", "shares"),
    [
        ({"shape": "linear"}, [0, 1 / 3, 2 / 3, 1]),
        ({"shape": "exponential"}, np.expm1([0, -1 / 3, -2 / 3, -1]) / np.expm1(-1)),
        ({"shape": "step", "from_run": 3}, [0, 0, 1, 1]),
    ],
)
def test_a_course_is_a_share_of_the_whole_in_every_run(
    case: Problem, settings: dict[str, object], shares: list[float]
) -> None:
    drift = Hypothesis(available_effects()["run-drift"], settings)
    found = whole_and_shares(case, drift, {}, drift.parameters[0], 0.01)
    assert found is not None
    assert found[0].settings == {"shape": "step", "from_run": 2}
    np.testing.assert_allclose(found[1], shares, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "settings", "size"),
    [
        ("run-drift", {"shape": "linear"}, 1e-4),
        ("root-creep", {"shape": "exponential", "side": "right"}, 1e-3),
        ("re-hang", {"from_run": 4}, 1e-4),
    ],
)
def test_the_shared_slope_is_that_of_the_course(
    stand: Stand, name: str, settings: dict[str, object], size: float
) -> None:
    """Against what the course itself changes between two sizes, whole predictions both, and against its own slope."""
    hypothesis = Hypothesis(available_effects()[name], settings)
    sizes = [p for p in hypothesis.parameters if p.neutral is not None]
    p = sizes[0]
    values = {q.name: float(q.neutral or 0.0) for q in sizes}
    found = stand.slope(hypothesis, values, p)
    near, far = (stand.change(hypothesis, {**values, p.name: k * size}) for k in (1.0, 1.5))
    assert found is not None and near is not None and far is not None
    wanted = (far - near) / (0.5 * size)
    assert float(found @ wanted) > 0.97 * np.linalg.norm(found) * np.linalg.norm(wanted)
    own = stand._slope(hypothesis, values, p)
    assert own is not None
    assert float(found @ own) > 0.99 * np.linalg.norm(found) * np.linalg.norm(own)
    assert np.linalg.norm(found) == pytest.approx(np.linalg.norm(own), rel=0.05)


def test_one_whole_serves_all_courses(stand: Stand, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    plain = Stand._slope

    def counted(self: Stand, hypothesis: Hypothesis, values: dict[str, float], p: Parameter) -> object:
        asked.append(hypothesis.label)
        return plain(self, hypothesis, values, p)

    monkeypatch.setattr(Stand, "_slope", counted)
    stand.known.clear()
    for settings in ({"shape": "linear"}, {"shape": "exponential"}, {"shape": "step", "from_run": 3}):
        drift = Hypothesis(available_effects()["run-drift"], settings)
        stand.slope(drift, {"drift": 0.0}, drift.parameters[0])
    assert len(asked) == 1
    assert len(stand.known) == 4


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("added-mass", {"x_m": 0.9, "y_m": 1.0}),  # no change between runs
        ("gain-drift", {"shape": "linear", "channels": "sensor-2"}),  # happens to channels
    ],
)
def test_what_is_no_course_of_the_rig_stands_alone(case: Problem, name: str, settings: dict[str, object]) -> None:
    hypothesis = Hypothesis(available_effects()[name], settings)
    p = next(p for p in hypothesis.parameters if p.neutral is not None)
    assert whole_and_shares(case, hypothesis, {}, p, 0.01) is None
