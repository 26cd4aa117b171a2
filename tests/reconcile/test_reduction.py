"""Reduced coordinates against all of them, where what an effect adds swings near the end of the modes that are kept."""

from __future__ import annotations

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.reconcile import surrogate
from vgvt.reconcile.hypothesis import Hypothesis
from vgvt.reconcile.problem import Problem
from vgvt.reconcile.surrogate import anchor


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """The small scenario and its campaign."""
    return problem(tmp_path_factory.mktemp("cache"), 1)


@pytest.mark.parametrize("compliance_m_per_n", [1e-6, 5e-5, 8e-5, 1.1e-4, 2e-4, 5e-4])
def test_a_gauge_on_clay_is_the_same_in_reduced_coordinates_at_every_size(
    case: Problem, monkeypatch: pytest.MonkeyPatch, compliance_m_per_n: float
) -> None:
    """Its dashpot holds more than its spring does in most of the band, and A/F has deep troughs."""
    hypothesis, u = Hypothesis(available_effects()["mount-compliance"]), np.zeros(case.size)
    e = hypothesis.scores({"compliance_m_per_n": compliance_m_per_n, "loss_factor": 0.3, "frequency_hz": 2.7})
    found = anchor(case, u, (hypothesis,), e, slopes=False).predict(u, e)
    monkeypatch.setattr(surrogate, "_MODES_PER_BAND", 1e6)
    whole = anchor(case, u, (hypothesis,), e, slopes=False)
    assert whole.groups[0].basis.shape[0] == whole.groups[0].basis.shape[1]
    wanted = whole.predict(u, e)
    assert np.linalg.norm(found - wanted) < 1e-4 * np.linalg.norm(wanted)
    assert np.abs(found / wanted - 1).max() < 0.01
