"""Reduced coordinates against all of them, where what an effect adds swings near the end of the modes that are kept."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.reconcile.prediction import plain
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """The small scenario and its campaign."""
    return problem(tmp_path_factory.mktemp("cache"), 1)


@pytest.fixture
def keep_every_mode(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[], None]]:
    """From when it is called on nothing is left out, of groups that are known already either."""

    def keep() -> None:
        monkeypatch.setattr(plain, "_MODES_PER_BAND", 1e6)
        plain.plain_of.cache_clear()

    yield keep
    plain.plain_of.cache_clear()


@pytest.mark.parametrize("compliance_m_per_n", [1e-6, 5e-5, 8e-5, 1.1e-4, 2e-4, 5e-4])
def test_a_gauge_on_clay_is_the_same_in_reduced_coordinates_at_every_size(
    case: Problem, keep_every_mode: Callable[[], None], compliance_m_per_n: float
) -> None:
    """Its dashpot holds more than its spring does in most of the band, and A/F has deep troughs."""
    hypothesis, u = Hypothesis(available_effects()["mount-compliance"]), np.zeros(case.size)
    e = hypothesis.scores({"compliance_m_per_n": compliance_m_per_n, "loss_factor": 0.3, "frequency_hz": 2.7})
    found = anchor(case, u, (hypothesis,), e, slopes=False).predict(u, e)
    keep_every_mode()
    whole = anchor(case, u, (hypothesis,), e, slopes=False)
    assert whole.groups[0].basis.shape[0] == whole.groups[0].basis.shape[1]
    wanted = whole.predict(u, e)
    assert np.linalg.norm(found - wanted) < 1e-4 * np.linalg.norm(wanted)
    assert np.abs(found / wanted - 1).max() < 0.01


@pytest.mark.parametrize("axis", ["pitch", "roll"])
@pytest.mark.parametrize("felt_per_m", [-15.0, 10.0])
@pytest.mark.parametrize("stiffness", [1.0, 10.0, 30.0])
def test_a_gauge_that_reads_moments_is_the_same_in_reduced_coordinates(
    case: Problem, keep_every_mode: Callable[[], None], felt_per_m: float, stiffness: float, axis: str
) -> None:
    """Modes of the symmetric half of what it reads, which were kept before, left out 3 % of A/F at 10 N m/rad.

    In roll it reads at rest nearly all that the shaker pushes with: of a difference of two such the rest was made.
    """
    hypothesis, u = Hypothesis(available_effects()["base-strain"], {"axis": axis}), np.zeros(case.size)
    values = {"apparent_force_per_moment_per_m": felt_per_m, "rotational_stiffness_n_m_per_rad": stiffness}
    e = hypothesis.scores({**values, "loss_factor": 0.05, "frequency_hz": 10.0})
    found = anchor(case, u, (hypothesis,), e, slopes=False).predict(u, e)
    keep_every_mode()
    whole = anchor(case, u, (hypothesis,), e, slopes=False)
    assert whole.groups[0].basis.shape[0] == whole.groups[0].basis.shape[1]
    assert np.median(np.abs(found / whole.predict(u, e) - 1)) < 1e-3
