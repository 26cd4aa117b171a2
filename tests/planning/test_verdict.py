"""The verdict on a plan: what is predicted, unless simulated campaigns contradict it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from vgvt.cli.plan import _show
from vgvt.planning.budget import AS_DESCRIBED
from vgvt.planning.confirmation import Confirmation
from vgvt.planning.prediction import ModePrediction, Prediction
from vgvt.planning.proposal import Proposal
from vgvt.planning.result import PlanningResult, Verdict

TARGET = ("first bending", 8.0)


def plan(light, name: str, damping_std: float) -> Proposal:
    mode = ModePrediction(*TARGET, 0.01, 1e-4, damping_std, 0.0)
    return Proposal(name, light, AS_DESCRIBED, 8.0, Prediction((mode,), 1.0, 1.0, 1.0), (TARGET,))


def seen(scatter: float, seeds: int) -> Confirmation:
    """Claims whose damping scatters by exactly so much; NaN where the mode was missed."""
    spread = np.linspace(-1, 1, seeds)
    damping = 0.01 + scatter * spread / spread.std(ddof=1)
    return Confirmation("auto", np.where(np.isfinite(damping), 8.0, np.nan)[:, None], damping[:, None])


@pytest.fixture
def predicted_twice_as_good(light) -> PlanningResult:
    return PlanningResult(plan(light, "as-described", 2e-5), None, (plan(light, "plan-1", 1e-5),), {})


@pytest.mark.parametrize(
    ("before", "after", "seeds", "verdict"),
    [
        (2e-5, 1e-5, 50, Verdict.BETTER),
        (1e-5, 2e-5, 50, Verdict.NOTHING_TO_GAIN),  # contradicted: twice as bad, known to 14 %
        (1e-5, 1.2e-5, 6, Verdict.BETTER),  # six seeds cannot tell 0.83 from 2: nothing is contradicted
        (np.nan, 1e-5, 50, Verdict.BETTER),  # the mode was not even found before
        (1e-5, np.nan, 50, Verdict.NOTHING_TO_GAIN),
        (np.nan, np.nan, 50, Verdict.NOTHING_TO_GAIN),
    ],
)
def test_simulation_has_the_last_word(predicted_twice_as_good, before, after, seeds, verdict) -> None:
    confirmed = {"as-described": seen(before, seeds), "plan-1": seen(after, seeds)}
    result = dataclasses.replace(predicted_twice_as_good, confirmed=confirmed)
    assert result.gain == pytest.approx(2.0)
    assert result.verdict is verdict


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        (1e-5, 2e-5, "2 times as good by prediction, and 0.5 ± 14 % times in simulated campaigns"),
        (np.nan, np.nan, "2 times as good by prediction, and simulated campaigns miss a mode more often than not"),
    ],
)
def test_what_simulation_says_against_a_plan_is_told(predicted_twice_as_good, capsys, before, after, said) -> None:
    """It read "2 times as good; 1.05 would count", which was no reason."""
    confirmed = {"as-described": seen(before, 50), "plan-1": seen(after, 50)}
    result = dataclasses.replace(predicted_twice_as_good, confirmed=confirmed)
    assert result.contradicted
    _show(result, {})
    assert said in " ".join(capsys.readouterr().out.split())


def test_the_confirmed_gain_and_its_error(predicted_twice_as_good) -> None:
    assert predicted_twice_as_good.confirmed_gain is None
    assert predicted_twice_as_good.confirmed_gain_relative_error is None
    confirmed = {"as-described": seen(3e-5, 51), "plan-1": seen(1e-5, 51)}
    result = dataclasses.replace(predicted_twice_as_good, confirmed=confirmed)
    assert result.confirmed_gain == pytest.approx(3.0)
    # A scatter from 51 seeds is known to 10 %, the ratio of two to √2 times that.
    assert result.confirmed_gain_relative_error == pytest.approx(0.1 * 2**0.5)
