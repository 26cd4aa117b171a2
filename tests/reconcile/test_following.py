"""A slope in an unknown holds what the effects follow it with, and fits from afar begin where peaks overlap."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects.added_mass import AddedMass
from vgvt.effects.suspension_surge import SuspensionSurge
from vgvt.reconcile.fitting.fit import NEAR, fit
from vgvt.reconcile.fitting.rough_start import rough_start
from vgvt.reconcile.prediction.carried import Structures
from vgvt.reconcile.prediction.following import leaders
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.search import candidate_fits
from vgvt.reconcile.search.screened import Screened

SURGE = Hypothesis(SuspensionSurge)
MASS = Hypothesis(AddedMass, {"x_m": 0.7, "y_m": 0.9})


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A campaign on a spring that surges."""
    return problem(tmp_path_factory.mktemp("cache"), 1, SuspensionSurge(mass_kg=0.15, loss_factor=0.02))


def test_a_surge_follows_the_springs_stiffness_and_a_mass_nothing(case: Problem) -> None:
    assert {case.unknowns[k].name for k in leaders(case, SURGE)} == {"spring", "hook x", "hook y", "hook z"}
    assert leaders(case, MASS) == ()


@pytest.mark.parametrize("hypotheses", [(SURGE,), (SURGE, MASS), (MASS, SURGE)])
def test_the_slope_in_the_springs_stiffness_moves_the_surges_too(
    case: Problem, hypotheses: tuple[Hypothesis, ...]
) -> None:
    """Against structures assembled on either side: most of the slope was missing."""
    values = {SURGE: {"mass_kg": 0.15, "loss_factor": 0.05}, MASS: {"mass_kg": 0.02}}
    e = np.concatenate([h.scores(values[h]) for h in hypotheses])
    k = case.names.index("spring")
    u, step = np.zeros(case.size), 0.01
    ends = []
    for side in (step, -step):
        u[k] = side
        ends.append(anchor(case, u, hypotheses, e, slopes=False).mechanical(u, e))
    u[k] = 0.0
    expected = (ends[0] - ends[1]) / (2 * step)
    known = anchor(case, u, hypotheses, e).slopes()[k]
    assert np.linalg.norm(known - expected) < 0.03 * np.linalg.norm(expected)


def test_what_follows_from_the_unknowns_is_not_carried(case: Problem) -> None:
    u = np.zeros(case.size)
    k = case.names.index("spring")
    u[k] = 1.0
    e = SURGE.scores({"mass_kg": 0.15, "loss_factor": 0.02})
    kept = Structures(case, coarse=True)
    anchor(case, np.zeros(case.size), (SURGE,), e, slopes=False, structures=kept)
    there = anchor(case, u, (SURGE,), e, slopes=False, structures=kept).predict(u, e)
    np.testing.assert_array_equal(there, anchor(case, u, (SURGE,), e, slopes=False).predict(u, e))


def test_a_fit_from_a_rough_start_finds_the_surge(case: Problem) -> None:
    """Begun six per cent beside the mass, at unknowns as stated, where a spring's peaks are sharp."""
    u, e = rough_start(case, (SURGE,), SURGE.scores({"mass_kg": 0.159, "loss_factor": 0.06}))
    found = fit(case, (SURGE,), u, e, NEAR)
    assert found.chi2_per_dof < 1.0
    size, sd, _ = found.values(0)["mass_kg"]
    assert abs(size - 0.15) < 4 * sd


@pytest.mark.parametrize(("behind", "kept"), [(3.0, 1), (5.0, 0)])
def test_what_stays_far_behind_is_no_candidate(monkeypatch: pytest.MonkeyPatch, behind: float, kept: int) -> None:
    left = SimpleNamespace(chi2=behind * 100.0)
    monkeypatch.setattr(candidate_fits, "fit_unless_behind", lambda *args: left)
    monkeypatch.setattr(candidate_fits, "rough_start", lambda problem, hypotheses, e: (np.zeros(1), e))
    current: Any = SimpleNamespace(problem=None, hypotheses=(), scores=np.zeros(1), u=np.zeros(1))
    chosen = [Screened(MASS, {"mass_kg": 0.02}, 1.0)]
    assert len(candidate_fits.begun_anew(current, chosen, 100.0, lambda fraction, message: None)) == kept
