"""A spring that rings on when the record ends: what a campaign says of it is what the prediction foretells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from reconciled_case import campaign_of, drawn_scores, roving_scenario, without_instrument_noise

from vgvt.effects import available_effects, make_effect
from vgvt.reconcile.fitting.fit import fit
from vgvt.reconcile.fitting.misfit import data_misfit
from vgvt.reconcile.next_test.procedures import changed, procedures
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.data import measured_frfs
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, problem_of
from vgvt.reconcile.search.stand import Stand

SIZES = {"mass_kg": 0.3, "loss_factor": 0.002}
SURGE = Hypothesis(available_effects()["suspension-surge"], {})
E = SURGE.scores(SIZES)


@pytest.fixture(scope="module")
def ringing() -> Problem:
    scenario = roving_scenario()
    campaign = campaign_of(without_instrument_noise(scenario), 1, make_effect("suspension-surge", "test", **SIZES))
    return problem_of(measured_frfs(campaign, lines=200), scenario)


def test_records_that_end_ringing_are_foretold(ringing: Problem) -> None:
    """In deviations of 0.4 %, the mean over all lines: with and without what their ends leave out."""
    assert all(end.last.size for end in ringing.measured.endings)
    u, measured = drawn_scores(ringing, 1), ringing.measured

    def missed(case: Problem) -> float:
        predicted = anchor(case, u, (SURGE,), E, slopes=False).predict(u, E)
        return float(np.mean(np.abs((predicted - measured.values) / measured.sigma) ** 2))

    known, forgotten = missed(ringing), missed(replace(ringing, measured=replace(measured, endings=())))
    assert known < 0.5
    assert forgotten > 10 * known


def test_what_pushed_is_kept_as_it_was(ringing: Problem) -> None:
    """What is marched through the record feels no taper."""
    for pushed, end in zip(ringing.measured.pushed, ringing.measured.endings, strict=True):
        np.testing.assert_array_equal(pushed[end.begun : end.samples], end.last)
        assert not pushed[end.samples :].any()


def test_their_slopes_are_those_of_differences(ringing: Problem) -> None:
    u, step = drawn_scores(ringing, 1), 1e-3
    known = anchor(ringing, u, (SURGE,), E).slopes()
    for k in range(E.size):
        ends = [
            anchor(ringing, u, (SURGE,), E + s * step * np.eye(E.size)[k], slopes=False).mechanical(
                u, E + s * step * np.eye(E.size)[k]
            )
            for s in (1, -1)
        ]
        wanted = (ends[0] - ends[1]) / (2 * step)
        assert np.linalg.norm(known[u.size - len(ringing.nuisances) + k] - wanted) < 0.05 * np.linalg.norm(wanted)


def test_a_screen_sees_them_as_if_they_had_rested(ringing: Problem) -> None:
    """Misses stay what they are; slopes are those of the same aircraft where nothing is cut off."""
    u = drawn_scores(ringing, 1)
    made = fit(ringing, (SURGE,), u, E, ())
    alone = fit(replace(ringing, measured=replace(ringing.measured, endings=())), (SURGE,), u, E, ())
    stand = Stand.of(made)
    np.testing.assert_allclose(stand.misfit[: made.points], data_misfit(ringing, made.predicted), atol=1e-8)
    size = np.linalg.norm(alone.tangent)
    assert np.linalg.norm(made.tangent - alone.tangent) > 1e-2 * size
    assert np.linalg.norm(stand.fit.tangent - alone.tangent) < 1e-6 * size


def test_a_run_made_once_more_ends_as_it_did(ringing: Problem) -> None:
    again = next(p for p in procedures(ringing) if p.words.startswith("make run 2 once more"))
    first, there = ringing.measured, changed(ringing, again).measured
    assert there.endings == (*first.endings, first.endings[1])
