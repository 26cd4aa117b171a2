"""Effects that an unknown stands in for: scores and amounts, and a fit that goes the whole way along the valley."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.effects.added_inertia import AddedInertia
from vgvt.reconcile.fitting import fit as fits
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.descent import Step
from vgvt.reconcile.fitting.fit import NEAR, fit
from vgvt.reconcile.prediction.surrogate import Anchor
from vgvt.reconcile.question.hypothesis import Hypothesis, prior
from vgvt.reconcile.question.uncertain import Unknown
from vgvt.reconcile.search.stand import Stand

ROLL = 0.05
# The package's lazy name of the same spelling is the function.


def unknown(scale: str) -> Unknown:
    return Unknown("k", "a stiffness", "N/m", 0.1, scale, lambda scenario, amount: scenario)  # type: ignore[arg-type]


@pytest.mark.parametrize("scale", ["log", "linear", "bounded"])
def test_a_score_moves_straight_in_its_amount(scale: str) -> None:
    """By what the tangent at another score says, wherever it stands."""
    k = unknown(scale)
    there = k.moved(2.0, 1.5, 4.0)
    assert k.amount(there) - k.amount(2.0) == pytest.approx(1.5 * k.rate(4.0), rel=1e-9)


def test_a_factor_never_moves_through_zero() -> None:
    assert unknown("log").moved(0.0, -20.0, 0.0) == -20.0


def test_an_effect_moves_straight_in_its_value() -> None:
    """A step of the score is one of the value's tangent; the reach of a step is the tangent's way to the same value."""
    inertia = Hypothesis(available_effects()["added-inertia"], {"x_m": 0.4, "y_m": 0.0, "pitch_inertia_kg_m2": 0.0})
    (p,) = inertia.parameters
    sd = prior(p)[1]
    here, step = np.array([0.7]), np.array([0.2])
    before = inertia.values(here)[p.name]
    assert inertia.values(inertia.moved(here, step))[p.name] == pytest.approx(before * (1 + 0.2 * sd))
    assert inertia.reach(0, 0.2) == pytest.approx((math.exp(0.2 * sd) - 1) / sd)


@pytest.mark.slow
def test_a_fit_goes_the_whole_way_along_the_valley(tmp_path: Path) -> None:
    """The body's own inertia had taken over an added one: it must come back, and the added one to its true size."""
    case = problem(tmp_path, 1, AddedInertia(roll_inertia_kg_m2=ROLL))
    swallowed = calibrate(case)
    body = case.names.index("Ixx body")
    assert swallowed.u[body] > 8
    inertia = Hypothesis(available_effects()["added-inertia"], {"x_m": 0.48, "y_m": 0.0, "pitch_inertia_kg_m2": 0.0})
    half = {"roll_inertia_kg_m2": 0.4 * ROLL}
    followed = Stand.of(swallowed).followed(inertia, half)
    assert followed is not None
    assert followed[1][body] > 5
    found = fit(case, (inertia,), followed[1], inertia.scores(half), NEAR)
    assert found.converged
    assert abs(found.u[body]) < 3
    size, sd, _ = found.values(0)["roll_inertia_kg_m2"]
    assert abs(size - ROLL) < 4 * sd
    assert sd < 0.1 * ROLL


@pytest.mark.parametrize(
    ("promised", "cost", "steps"), [(0.05, 1e6, 12), (4e-4, 1e6, 1), (4e-4, 6000.0, 12), (1e-4, 6000.0, 1)]
)
def test_a_step_held_back_is_not_the_bottom(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, promised: float, cost: float, steps: int
) -> None:
    """Little gained where a free step promised much: on, as far as the stage allows; where little, it ends.

    Little is a share of the cost while data miss much, and half a nat where they are nearly met.
    """
    taken = []

    def held_back(here: Anchor, u: Any, e: Any, predicted: Any, sigma: Any, damping: float, rough: bool) -> Step:
        taken.append(damping)
        return Step(u, e, here, predicted, damping, 5e-4, promised, cost)

    monkeypatch.setattr(fits, "taken", held_back)
    case = problem(tmp_path, 1)
    found = fit(case, (), np.zeros(case.size), np.zeros(0), NEAR)
    assert len(taken) == steps
    assert found.converged == (steps == 1)


@pytest.mark.parametrize(
    ("gains", "steps"), [((1e-5, 1e-2, 1e-5, 1e-5, 1e-2), 4), ((1e-5, 1e-5, 1e-2), 2), ((1e-2, 1e-5), 12)]
)
def test_a_fit_ends_where_two_steps_gain_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, gains: tuple[float, ...], steps: int
) -> None:
    """One alone may have been held back at a bend, after which the valley goes on."""
    taken = []

    def next_one(here: Anchor, u: Any, e: Any, predicted: Any, sigma: Any, damping: float, rough: bool) -> Step:
        taken.append(gains[len(taken)] if len(taken) < len(gains) else 1e-2)
        return Step(u, e, here, predicted, damping, taken[-1], 0.05, cost=1e6)

    monkeypatch.setattr(fits, "taken", next_one)
    case = problem(tmp_path, 1)
    found = fit(case, (), np.zeros(case.size), np.zeros(0), NEAR)
    assert len(taken) == steps
    assert found.converged == (steps < 12)


def test_exact_slopes_come_last_and_only_where_a_fit_has_gone_far(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Forgiving steps and the first exact ones take the stated values' slopes."""
    taken: list[bool] = []

    def once(here: Anchor, u: Any, e: Any, predicted: Any, sigma: Any, damping: float, rough: bool) -> Any:
        taken.append(here.origin is None)
        return None

    monkeypatch.setattr(fits, "taken", once)
    case = problem(tmp_path, 1)
    near, far = np.zeros(case.size), np.zeros(case.size)
    far[[u.name for u in case.unknowns].index("mass body")] = 12.0
    stages = ((0.6, 4), (0.0, 12))
    for start, exact in ((near, True), (far, False)):
        fit(case, (), start, np.zeros(0), stages, exact=exact)
        assert taken == [True, True]
        taken.clear()
    shown: list[float] = []
    fit(case, (), far, np.zeros(0), stages, lambda fraction, message: shown.append(fraction), exact=True)
    assert taken == [True, True, False]
    # However soon a phase ends, progress goes forward.
    assert 0 < shown[0] < shown[1] < shown[2] <= 1
