"""Coarse steps carry their structures along; whatever a fit gives back was assembled."""

from __future__ import annotations

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects.added_mass import AddedMass
from vgvt.reconcile.fitting.fit import fit
from vgvt.reconcile.prediction import carried as module
from vgvt.reconcile.prediction.carried import Structures, carried
from vgvt.reconcile.prediction.grouping import assembled
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem

NOTHING = np.zeros(0)
MASS = Hypothesis(AddedMass, {"x_m": 0.7, "y_m": 0.9})


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return problem(tmp_path_factory.mktemp("cache"), 1)


def scattered(case: Problem, size: float) -> np.ndarray:
    u = np.zeros(case.size)
    u[: len(case.unknowns)] = size * np.random.default_rng(3).uniform(-1, 1, len(case.unknowns))
    return u


def missed(case: Problem, u: np.ndarray, hypotheses: tuple[Hypothesis, ...], e: np.ndarray, kept: Structures) -> float:
    """Median relative difference of a prediction from that of an assembled structure."""
    there = anchor(case, u, hypotheses, e, slopes=False, structures=kept).predict(u, e)
    return float(np.median(np.abs(there / anchor(case, u, hypotheses, e, slopes=False).predict(u, e) - 1)))


@pytest.mark.parametrize(("hypotheses", "e"), [((), NOTHING), ((MASS,), np.array([0.4]))])
def test_carried_as_far_as_it_goes_it_misses_a_fraction_of_what_coarse_steps_forgive(
    case: Problem, hypotheses: tuple[Hypothesis, ...], e: np.ndarray
) -> None:
    kept = Structures(case, coarse=True)
    start, far = np.zeros(case.size), scattered(case, 1.5)
    assert missed(case, start, hypotheses, e, kept) < 2e-3
    assert 0 < missed(case, far, hypotheses, e, kept) < 0.01
    still = anchor(case, start, hypotheses, e, slopes=False).predict(start, e)
    moved = anchor(case, far, hypotheses, e, slopes=False).predict(far, e)
    assert np.median(np.abs(still / moved - 1)) > 0.1


def test_beyond_that_it_is_assembled_anew(case: Problem) -> None:
    kept = Structures(case, coarse=True)
    anchor(case, np.zeros(case.size), slopes=False, structures=kept)
    assert missed(case, scattered(case, 6.0), (), NOTHING, kept) == 0


def test_every_matrix_and_the_sensors_are_carried(case: Problem) -> None:
    """To first order: a hundredth of the way leaves a hundredth of its own change, and less."""
    base = assembled(case, np.zeros(case.size), (), NOTHING)
    u = scattered(case, 0.05)
    exact = assembled(case, u, (), NOTHING)
    assert base is not None
    assert exact is not None
    (there,) = carried(case, base, np.zeros(case.size), u)
    for name in module.MATRICES:
        before, after = (getattr(g[0].structure, name) for g in (base, exact))
        change = np.linalg.norm(after - before)
        assert np.linalg.norm(getattr(there.structure, name) - after) <= 0.1 * change
    assert there.masses_kg == pytest.approx(exact[0].masses_kg, rel=1e-9)
    assert not np.allclose(base[0].masses_kg, exact[0].masses_kg, rtol=1e-6)


def test_what_a_fit_gives_back_was_assembled(case: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    """After coarse steps alone, too: a stand on it compares with assembled structures."""
    used: list[int] = []
    plain = module.carried
    monkeypatch.setattr(module, "carried", lambda *args: used.append(1) or plain(*args))
    found = fit(case, (MASS,), np.zeros(case.size), np.zeros(1), ((0.6, 2),), judged=0.6)
    assert used
    exact = anchor(case, found.u, (MASS,), found.e, slopes=False).predict(found.u, found.e)
    np.testing.assert_array_equal(found.predicted, exact)


def test_fine_steps_carry_nothing(case: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*args: object) -> None:
        raise AssertionError

    monkeypatch.setattr(module, "carried", never)
    fit(case, (MASS,), np.zeros(case.size), np.zeros(1), ((0.0, 2),))


def test_the_structure_beside_an_effect_serves_half_a_standard_deviation(case: Problem) -> None:
    kept = Structures(case)
    first = kept.beside(np.zeros(case.size), (), NOTHING)
    assert kept.beside(scattered(case, 0.4), (), NOTHING) is first
    assert kept.beside(scattered(case, 2.0), (), NOTHING) is not first
    assert kept.beside(np.zeros(case.size), (MASS,), np.array([0.4])) is not first


def test_an_effects_slopes_beside_a_structure_half_a_deviation_away_are_its_own(case: Problem) -> None:
    u, e = scattered(case, 0.45), np.array([0.4])
    kept = Structures(case)
    anchor(case, np.zeros(case.size), (MASS,), e, structures=kept)
    near = anchor(case, u, (MASS,), e, structures=kept).slopes()[-1]
    own = anchor(case, u, (MASS,), e).slopes()[-1]
    assert 0 < np.linalg.norm(near - own) < 0.01 * np.linalg.norm(own)
