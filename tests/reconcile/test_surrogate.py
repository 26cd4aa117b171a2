"""The fast prediction is that of the simulation: as stated, moved within its tolerances, and with effects."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from reconciled_case import campaign_of, drawn_scores, problem, small_scenario, without_instrument_noise

from vgvt.effects import available_effects
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.data import measured_frfs
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return problem(tmp_path_factory.mktemp("cache"), 1)


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
    measured = measured_frfs(campaign_of(without_instrument_noise(small_scenario()), 1, *made), lines=200)
    there = replace(case, measured=measured)
    hypotheses = () if name is None else (Hypothesis(known[name], values),)
    free = np.zeros(sum(len(h.parameters) for h in hypotheses))
    u = drawn_scores(case, 1)
    predicted = anchor(there, u, hypotheses, free, slopes=False).predict(u, free)
    error = np.abs(predicted / measured.values - 1)
    assert np.median(error) < 0.003
    assert np.quantile(error, 0.9) < 0.02
