"""The fast prediction is that of the simulation: as stated, moved within its tolerances, and with effects."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from reconciled_case import campaign_of, problem, small_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.data import measured_frfs
from vgvt.reconcile.hypothesis import Hypothesis
from vgvt.reconcile.problem import CELLS, Problem
from vgvt.reconcile.surrogate import anchor
from vgvt.scenario import Scenario


def silent(scenario: Scenario) -> Scenario:
    """The scenario without any noise."""
    clean = {"noise": None}
    return scenario.model_copy(
        update={
            "accelerometers": scenario.accelerometers.model_copy(update=clean),
            "transducer": scenario.transducer.model_copy(update=clean),
            "acquisition": scenario.acquisition.model_copy(update={"noise_v_per_rthz": 0.0, "bits": 32}),
        }
    )


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return problem(tmp_path_factory.mktemp("cache"), 1)


def truth_scores(case: Problem, seed: int) -> np.ndarray:
    """The scores that a campaign of a seed was drawn with: its chain is as coarse as the scenario says."""
    count = len(case.unknowns) - 1
    scores = np.zeros(case.size)
    scores[:count] = np.random.default_rng(seed).standard_normal(count)
    scores[case.unknowns.index(CELLS)] = -3 / CELLS.sd  # as near to -1 as makes no difference
    return scores


@pytest.mark.parametrize(
    ("name", "values"),
    [
        (None, {}),
        ("local-absorber", {"mass_kg": 0.05, "frequency_hz": 14.0, "x_m": 0.75, "y_m": 0.9}),
        ("channel-delay", {"delay_s": 5e-4}),
        ("root-compliance", {"bending": 0.05, "torsion": 0.02}),
        ("swapped-sensors", {"node": 1, "other_node": 2}),
    ],
)
def test_predicts_what_the_simulation_records(case: Problem, name: str | None, values: dict[str, float]) -> None:
    """Within a fraction of a per cent, windows included, for a truth drawn from the tolerances."""
    known = available_effects()
    made = () if name is None else (known[name](**values),)
    measured = measured_frfs(campaign_of(silent(small_scenario()), 1, *made), lines=200)
    there = replace(case, measured=measured)
    hypotheses = () if name is None else (Hypothesis(known[name], values),)
    free = np.zeros(sum(len(h.parameters) for h in hypotheses))
    u = truth_scores(case, 1)
    predicted = anchor(there, u, hypotheses, free, slopes=False).predict(u, free)
    error = np.abs(predicted / measured.values - 1)
    assert np.median(error) < 0.003
    assert np.quantile(error, 0.9) < 0.02
