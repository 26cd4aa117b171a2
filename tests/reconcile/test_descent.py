"""A step of a fit along a valley that is narrow and bent, and the solution of badly scaled systems."""

from __future__ import annotations

import warnings
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vgvt.reconcile import descent

STEEP, BOTTOM = 300.0, 2.0


@pytest.fixture
def valley(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Two scores whose misfit leaves nothing on y = x² and little at x = 2, in place of an aircraft."""

    def predicted(u: Any) -> Any:
        return np.array([STEEP * (u[1] - u[0] ** 2), 30 * (u[0] - BOTTOM)])

    def there(problem: Any, u: Any, hypotheses: Any, e: Any, **kept: Any) -> Any:
        return here(u)

    def here(u: Any) -> Any:
        known = SimpleNamespace(moved=lambda score, move, at: score + move)
        case = SimpleNamespace(unknowns=[known, known])
        return SimpleNamespace(
            problem=case, hypotheses=(), structures=None, origin=None, assembled=None, predict=lambda u, e: predicted(u)
        )

    def slopes(anchored: Any, u: Any, e: Any, predicted: Any, sigma: Any) -> Any:
        return np.array([[-2 * STEEP * u[0], STEEP], [30.0, 0.0]])

    monkeypatch.setattr(descent, "anchor", there)
    monkeypatch.setattr(descent, "data_misfit", lambda problem, predicted, sigma: predicted)
    monkeypatch.setattr(descent, "jacobian", slopes)
    return SimpleNamespace(here=here, predicted=predicted)


def walked(valley: Any, steps: int) -> float:
    """How far along the valley some steps lead from its beginning."""
    u, e, damping = np.array([0.5, 0.25]), np.zeros(0), 0.1
    for _ in range(steps):
        step = descent.taken(valley.here(u), u, e, valley.predicted(u), np.ones(2), damping, True)
        if step is None:
            break
        assert step.gain > 0
        u, damping = step.u, step.damping
    return float(u[0])


def test_a_step_up_the_side_of_a_valley_is_led_back_to_its_floor(valley: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two steps reach what steps that must stay inside take many for."""
    assert walked(valley, 2) == pytest.approx(BOTTOM, abs=0.05)
    monkeypatch.setattr(descent, "_CORRECTIONS", 0)
    assert walked(valley, 2) < 1.0


def test_a_step_that_leads_too_far_is_taken_for_a_part_before_it_is_turned(
    valley: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(globals(), "STEEP", 100.0)
    monkeypatch.setattr(descent, "_CORRECTIONS", 0)
    monkeypatch.setattr(descent, "_REJECTIONS", 1)
    assert walked(valley, 1) > 0.5
    monkeypatch.setattr(descent, "_SHORTER", 1.0)
    assert walked(valley, 1) == 0.5


def test_a_way_back_that_leads_nowhere_is_given_up(valley: Any) -> None:
    """After the first, whichever leaves most of what the one before it left."""
    asked: list[float] = []

    def back(u: Any, e: Any, misfit: Any) -> Any:
        asked.append(float(u[0]))
        return u * 0.99, e

    far = np.array([30.0, 0.0])
    assert descent._downhill(valley.here(far), (far, np.zeros(0)), np.ones(2), 1.0, back) is None
    assert len(asked) == 2


def test_badly_scaled_systems_are_solved_without_a_word() -> None:
    g = np.random.default_rng(3)
    size = 10.0 ** np.linspace(-12, 12, 12)
    tangent = g.standard_normal((40, 12))
    normal, wanted = (tangent.T @ tangent) * size * size[:, None], g.standard_normal(12) / size
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert descent.solved(normal, normal @ wanted) == pytest.approx(wanted, rel=1e-6)
        # Two rows alike to the last digit: the shortest solution, and it solves it.
        twice = np.ones((2, 2)) * 1e20
        assert twice @ descent.solved(twice, np.array([2e20, 2e20])) == pytest.approx(np.full(2, 2e20))


def test_beside_what_has_no_slope_there_is_no_step(valley: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a joint whose march runs away next to where it stands."""
    monkeypatch.setattr(descent, "jacobian", lambda *given: np.array([[np.nan, STEEP], [30.0, 0.0]]))
    assert walked(valley, 2) == 0.5
