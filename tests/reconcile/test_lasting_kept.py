"""What a linearised step promises a fit where the model's error lasts, far from the data: the response itself is asked.

Of a base's strain alone, a mount missing beside it, 492 nats were promised along a step on which the response only got
worse; the right second name had gained less than nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.reconcile.evidence.lasting import lasting, lasting_evidence, lasting_nats
from vgvt.reconcile.fitting.fit import NEAR, fit
from vgvt.reconcile.fitting.misfit import data_misfit
from vgvt.reconcile.question.hypothesis import Hypothesis

Array = NDArray[np.float64]


@dataclass(eq=False)
class Records:
    """Of what was measured, what such errors depend on."""

    values: NDArray[np.complex128]
    sigma: Array
    noise: Array
    frequency_hz: Array


def far_off(scale: float) -> tuple[Any, Array, Array, Array]:
    """A problem without any noise, a misfit so large, slopes, and scores at the bottom by white noise's measure."""
    generator = np.random.default_rng(11)
    values = generator.standard_normal((3, 12)) + 1j * generator.standard_normal((3, 12))
    measured = Records(values, np.ones((3, 12)), np.zeros((3, 12)), np.linspace(3, 35, 12))
    of = SimpleNamespace(measured=measured, split=SimpleNamespace(train=np.arange(3) > 0))
    slopes, apart = generator.standard_normal((48, 2)), scale * generator.standard_normal(48)
    bottom = -np.linalg.solve(slopes.T @ slopes + np.eye(2), slopes.T @ apart)
    return of, apart + slopes @ bottom, slopes, bottom


def cost_of(of: Any, misfit: Array, scores: Array) -> float:
    return float(np.sum(lasting(of, misfit[:, None]) ** 2) + scores @ scores)


def occam_of(of: Any, slopes: Array) -> float:
    judged = lasting(of, slopes)
    return 0.5 * float(np.linalg.slogdet(judged.T @ judged + np.eye(slopes.shape[1]))[1])


def test_a_response_that_keeps_the_promise_changes_nothing() -> None:
    of, misfit, slopes, scores = far_off(80.0)
    asked: list[Array] = []

    def linear(there: Array) -> Array:
        asked.append(there)
        return misfit + slopes @ (there - scores)

    told = lasting_evidence(of, misfit, slopes, scores, 0.0, aside=linear)
    assert told == pytest.approx(lasting_evidence(of, misfit, slopes, scores, 0.0), rel=1e-9)
    assert len(asked) == 3


def test_a_response_that_only_gets_worse_gains_nothing() -> None:
    of, misfit, slopes, scores = far_off(80.0)
    told = lasting_evidence(of, misfit, slopes, scores, 0.0, aside=lambda _: 2 * misfit)
    here = -0.5 * cost_of(of, misfit, scores) - occam_of(of, slopes)
    assert told == pytest.approx(here)
    assert lasting_evidence(of, misfit, slopes, scores, 0.0) > told + 10


def test_the_best_of_the_way_counts() -> None:
    """The model bends: along half of the step it keeps something, at its end nothing is left of that."""
    of, misfit, slopes, scores = far_off(80.0)
    asked: list[tuple[float, Array]] = []

    def bent(there: Array) -> Array:
        moved = there - scores
        found = (1 + 2e-4 * float(moved @ moved) ** 2) * misfit + slopes @ moved
        asked.append((cost_of(of, found, there), moved))
        return found

    told = lasting_evidence(of, misfit, slopes, scores, 0.0, aside=bent)
    best = min(cost for cost, _ in asked)
    assert best < cost_of(of, misfit, scores)
    assert best < asked[0][0]
    assert told == pytest.approx(-0.5 * best - occam_of(of, slopes))
    whole = asked[0][1]
    for (_, moved), share in zip(asked, (1.0, 0.5, 0.25), strict=True):
        np.testing.assert_allclose(moved, share * whole)


def test_where_there_is_no_such_aircraft_nothing_is_gained() -> None:
    of, misfit, slopes, scores = far_off(80.0)
    told = lasting_evidence(of, misfit, slopes, scores, 0.0, aside=lambda _: None)
    assert told == pytest.approx(-0.5 * cost_of(of, misfit, scores) - occam_of(of, slopes))


def test_a_small_promise_is_believed() -> None:
    """Of what ends near the data slopes say what is true, and three predictions a fit are to be had for nothing."""
    of, misfit, slopes, scores = far_off(10.0)
    told = lasting_evidence(of, misfit, slopes, scores, 0.0, aside=lambda _: pytest.fail("it was asked"))
    assert told == pytest.approx(lasting_evidence(of, misfit, slopes, scores, 0.0))


def test_a_fit_is_asked_by_its_own_response(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """At its own scores it answers what it left, with an effect and without one."""
    stated = problem(tmp_path, 1)
    heavier = Hypothesis(available_effects()["added-mass"], {"x_m": 0.9, "y_m": 1.1})
    asked: list[Any] = []

    def spied(*arguments: Any, aside: Any, **named: Any) -> float:
        asked.append(aside)
        return lasting_evidence(*arguments, aside=aside, **named)

    monkeypatch.setattr("vgvt.reconcile.evidence.lasting.lasting_evidence", spied)
    for hypotheses, start in (((), np.zeros(0)), ((heavier,), heavier.scores({"mass_kg": 0.005}))):
        found = fit(stated, hypotheses, np.zeros(stated.size), start, NEAR[:1])
        lasting_nats(found)
        np.testing.assert_allclose(asked[-1](found.scores), data_misfit(found.problem, found.predicted), atol=1e-9)
    assert asked[-1](np.full(found.scores.size, 1e6)) is None
