"""A step of a fit: held back as its promises ask for, with slopes taken anew where those at hand mislead."""

from __future__ import annotations

import warnings
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vgvt.reconcile.fitting import descent, followed_descent

STEEP, BOTTOM = 300.0, 2.0
HERE = np.array([0.5, 0.25])


@pytest.fixture
def valley(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Two scores whose misfit leaves nothing on y = x² and little at x = 2, in place of an aircraft.

    ``asked`` are the scores at which its misfit was asked for.
    """
    case = SimpleNamespace(here=None, predicted=None, asked=[], bent=1.0, structures=None)
    case.structures = SimpleNamespace(whole=False, follows=None)

    def predicted(u: Any) -> Any:
        return np.array([STEEP * (u[1] - case.bent * u[0] ** 2), 30 * (u[0] - BOTTOM)])

    def there(problem: Any, u: Any, hypotheses: Any, e: Any, *, slopes: bool = True, **kept: Any) -> Any:
        return here(u, None if not slopes or kept.get("rough") else kept.get("origin"))

    def here(u: Any, origin: Any = None) -> Any:
        known = SimpleNamespace(moved=lambda score, move, at: score + move)
        aircraft = SimpleNamespace(unknowns=[known, known])

        def predict(u: Any, e: Any) -> Any:
            case.asked.append(u)
            return predicted(u)

        structures = case.structures
        return SimpleNamespace(
            problem=aircraft, hypotheses=(), structures=structures, origin=origin, assembled=None, predict=predict
        )

    def slopes(anchored: Any, u: Any, e: Any, predicted: Any, sigma: Any) -> Any:
        return np.array([[-2 * STEEP * case.bent * u[0], STEEP], [30.0, 0.0]])

    monkeypatch.setattr(descent, "anchor", there)
    monkeypatch.setattr(descent, "data_misfit", lambda problem, predicted, sigma: predicted)
    monkeypatch.setattr(descent, "jacobian", slopes)
    monkeypatch.setattr(descent, "from_elsewhere", lambda *_: False)
    case.here, case.predicted = here, predicted
    return case


def step_from(valley: Any, u: Any, damping: float, rough: bool = False) -> descent.Step | None:
    valley.asked.clear()
    return descent.taken(valley.here(u), u, np.zeros(0), valley.predicted(u), np.ones(2), damping, rough)


def walked(valley: Any, steps: int, damping: float = 0.1) -> float:
    """How far along the valley some steps lead from its beginning."""
    u = HERE
    for _ in range(steps):
        step = step_from(valley, u, damping)
        if step is None:
            break
        assert step.gain > 0
        u, damping = step.u, step.damping
    return float(u[0])


def test_it_arrives_at_the_bottom(valley: Any) -> None:
    assert walked(valley, 40) == pytest.approx(BOTTOM, abs=0.05)


def test_a_step_that_keeps_its_promise_frees_the_next(valley: Any) -> None:
    """On straight ground a step is what the tangent says: a fifth of the damping."""
    valley.bent = 0.0
    step = step_from(valley, HERE, 10.0)
    assert step is not None and step.damping == pytest.approx(2.0)
    assert len(valley.asked) == 1


def test_what_is_refused_is_held_back_and_the_next_begins_there(valley: Any) -> None:
    """Up the side of a valley: held back by more and more, and what was accepted is not let go of at once."""
    step = step_from(valley, HERE, 1e-6)
    assert step is not None
    refused = len(valley.asked) - 1
    assert refused > 1
    accepted = 1.0 * 4.0 ** (refused - 1)
    assert step.damping in (0.2 * accepted, accepted, 2.0 * accepted)
    # The next one is not freed to what has just been refused.
    step_from(valley, step.u, step.damping)
    assert len(valley.asked) <= 2


def test_a_step_that_keeps_little_holds_back_the_next(valley: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(descent, "_KEEPS_LITTLE", 2.0)
    monkeypatch.setattr(descent, "_KEEPS_MOST", 2.0)
    valley.bent = 0.0
    step = step_from(valley, HERE, 10.0)
    assert step is not None and step.damping == 20.0


@pytest.mark.parametrize("elsewhere", [True, False])
def test_slopes_that_mislead_are_taken_anew_before_a_step_is_shortened(
    valley: Any, monkeypatch: pytest.MonkeyPatch, elsewhere: bool
) -> None:
    """Those of elsewhere point away from the bottom; where there are no others, no step is found."""
    right = descent.jacobian

    def slopes(anchored: Any, *given: Any) -> Any:
        return right(anchored, *given) * (1.0 if anchored.origin is not None else -1.0)

    monkeypatch.setattr(descent, "jacobian", slopes)
    monkeypatch.setattr(descent, "from_elsewhere", lambda problem, u, e, origin, hypotheses: elsewhere and not origin)
    valley.bent = 0.0
    step = step_from(valley, HERE, 0.1)
    assert (step is not None) == elsewhere
    if step is not None:
        assert len(valley.asked) == 2
        # Taken where the step began, and they serve on.
        assert step.here.origin is not None and np.array_equal(step.here.origin.u, HERE)


def test_where_a_step_keeps_less_than_half_the_next_has_its_own_slopes(
    valley: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(descent, "from_elsewhere", lambda problem, u, e, origin, hypotheses: not origin)
    valley.bent = 0.0
    kept = step_from(valley, HERE, 0.1)
    assert kept is not None and kept.here.origin is None
    monkeypatch.setattr(descent, "TRUE", 2.0)
    broken = step_from(valley, HERE, 0.1)
    assert broken is not None and broken.here.origin is not None
    assert np.array_equal(broken.here.origin.u, broken.u)
    # A rough one keeps them.
    broken = step_from(valley, HERE, 0.1, rough=True)
    assert broken is not None and broken.here.origin is None


@pytest.fixture
def followed(valley: Any, monkeypatch: pytest.MonkeyPatch) -> Any:
    """The same valley beside a joint; ``asked`` are the places at which slopes were taken."""
    asked, slopes, there = [], descent.jacobian, descent.anchor
    monkeypatch.setattr(followed_descent, "anchor", there)
    monkeypatch.setattr(followed_descent, "data_misfit", lambda problem, predicted: predicted)
    monkeypatch.setattr(descent, "jacobian", lambda *given: asked.append(given[1]) or slopes(*given))

    def down(most: int) -> Any:
        asked.clear()
        return followed_descent.followed_down(valley.here(HERE), HERE, np.zeros(0), most)

    return SimpleNamespace(down=down, asked=asked)


def test_followed_steps_turn_with_the_valley(followed: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of them has slopes of where it begins, and there are half as many."""
    u, _, here, _, converged = followed.down(60)
    assert converged and u[0] == pytest.approx(BOTTOM, abs=0.05)
    assert np.array_equal(here.origin.u, u) and np.array_equal(followed.asked[-1], u)
    turning = len(followed.asked)
    monkeypatch.setattr(followed_descent, "_turned", lambda here, place, slopes, move, damping: move)
    assert followed.down(60)[-1]
    assert turning <= 0.5 * len(followed.asked)


@pytest.mark.parametrize("most", [0, 60])
def test_it_has_not_arrived_while_slopes_of_there_lead_down(
    followed: Any, monkeypatch: pytest.MonkeyPatch, most: int
) -> None:
    monkeypatch.setattr(followed_descent, "_taken", lambda *_: None)
    u, _, _, _, converged = followed.down(most)
    assert not converged and np.array_equal(u, HERE)


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


def test_where_data_are_nearly_met_nats_say_that_the_bottom_is_reached() -> None:
    """A thousandth of the cost of many points is nats still to be gained; far from the data it is the last of a way."""
    points = 10_000
    met, missed = 1.2 * points, 100.0 * points
    assert not descent.arrived(points, 5.0, met)
    assert descent.arrived(points, 0.9, met)
    assert descent.arrived(points, 900.0, missed)
    assert not descent.arrived(points, 1100.0, missed)
    # Judged coarsely no cost is that of data that are met.
    assert descent.arrived(0, 5.0, met)
