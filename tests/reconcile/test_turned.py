"""A fault of held-out data alone: no fit sees it, so another hold-out is drawn, and only then can it have a name."""

from __future__ import annotations

import dataclasses
import functools
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import Effect, available_effects, make_effect
from vgvt.reconcile import Verdict, loop, reconcile
from vgvt.reconcile.decision.leads import demoted
from vgvt.reconcile.decision.turned import counts_instead, missed_channels, turned
from vgvt.reconcile.outcome.account import account_of
from vgvt.reconcile.question.data import Measured, measured_frfs
from vgvt.reconcile.question.holdout import Split, split

LINES = 120
CATALOGUE = ("channel-gain",)


@functools.cache
def measured() -> Measured:
    """Responses of a campaign without any effect: a hold-out asks for their labels alone."""
    return measured_frfs(campaign_of(roving_scenario(), 3), lines=LINES, floor=0.004)


def drawn(turn: int = 0) -> Split:
    """What a draw holds out."""
    return split(roving_scenario(), measured(), turn)


def judged(folder: Path, *truth: Effect, known: tuple[str, ...] = CATALOGUE) -> Verdict:
    """The verdict on a campaign with some effects, a few being known."""
    effects = {n: c for n, c in available_effects().items() if n in known}
    campaign = campaign_of(roving_scenario(), 3, *truth)
    return reconcile(campaign, roving_scenario(), effects=effects, lines=LINES, folder=folder, most=1)


def held_out_label() -> str:
    """The DOF of a channel that is held out alone."""
    return str(measured().channels[int(np.flatnonzero(drawn().held_channels)[0])].dof)


@pytest.fixture(scope="module")
def loud(tmp_path_factory: pytest.TempPathFactory) -> tuple[Verdict, Path]:
    """The verdict where one held-out channel reads a tenth too much."""
    folder = tmp_path_factory.mktemp("loud")
    fault = make_effect("channel-gain", "test", gain_error=0.1, channels=held_out_label())
    return judged(folder, fault), folder


def test_every_draw_holds_out_as_much_and_no_two_are_alike() -> None:
    draws = [drawn(turn) for turn in range(6)]
    assert len({d.held.tobytes() for d in draws}) == 6
    assert len({int(d.held.sum()) for d in draws}) == 1
    assert (drawn(2).held == draws[2].held).all()
    assert [d.turn for d in draws] == list(range(6))


@pytest.mark.slow
def test_a_held_out_channel_that_reads_too_much_has_a_name(loud: tuple[Verdict, Path]) -> None:
    verdict, _ = loud
    assert verdict.kind == "explained"
    (effect,) = verdict.effects
    assert (effect.name, effect.settings["channels"]) == ("channel-gain", held_out_label())
    value, sd, _ = effect.parameters["gain_error"]
    assert abs(value - 0.1) < 4 * sd
    problem = verdict.attribution.final.problem
    labels = np.array([str(c.dof) for c in problem.measured.channels])
    assert problem.split.train[labels == held_out_label()].all() and problem.split.held.any()
    assert account_of(verdict, title="loud").turned
    assert verdict.reasons[0].startswith("Of the data held out at first")
    assert held_out_label() in verdict.reasons[0].split("were missed")[0]


@pytest.mark.slow
def test_a_name_that_does_not_keep_is_none_to_turn_for(
    loud: tuple[Verdict, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What the other hold-out's name loses it loses before it is asked whether that hold-out counts."""
    _, folder = loud
    monkeypatch.setattr(loop, "as_leads", lambda found, thresholds: demoted(found) if found.rounds else found)
    verdict = judged(folder, make_effect("channel-gain", "test", gain_error=0.1, channels=held_out_label()))
    assert verdict.kind == "unknown" and verdict.leads == ()
    assert (verdict.attribution.null.problem.split.held == drawn().held).all()


@pytest.mark.parametrize(
    ("named", "again", "adequate", "counts"),
    [(0, 1, False, True), (1, 1, False, False), (1, 1, True, True), (1, 0, True, False), (0, 0, True, False)],
)
def test_a_name_or_data_met_by_it_count_instead(named: int, again: int, adequate: bool, counts: bool) -> None:
    first: Any = SimpleNamespace(rounds=(None,) * named)
    other: Any = SimpleNamespace(rounds=(None,) * again, final_residual=SimpleNamespace(adequate=adequate))
    assert counts_instead(first, other) is counts


@pytest.mark.slow
def test_a_second_call_goes_on_after_the_round_of_the_other_hold_out(loud: tuple[Verdict, Path]) -> None:
    verdict, folder = loud
    assert (folder / "rounds-turned.json").is_file()
    again = judged(folder, make_effect("channel-gain", "test", gain_error=0.1, channels=held_out_label()))
    assert again.reasons == verdict.reasons
    assert again.effects[0].evidence_nats == pytest.approx(verdict.effects[0].evidence_nats, rel=1e-6)


@pytest.mark.slow
def test_what_no_effect_explains_is_judged_by_the_first_hold_out(tmp_path: Path) -> None:
    fault = make_effect("channel-gain", "test", gain_error=0.1, channels=held_out_label())
    verdict = judged(tmp_path, fault, known=("channel-delay",))
    assert verdict.kind == "unknown" and not verdict.reasons[0].startswith("Of the data")
    assert (verdict.attribution.null.problem.split.held == drawn().held).all()
    # There was another hold-out to try, with what was missed in the fit.
    other = turned(verdict.attribution)
    assert other is not None and (missed_channels(verdict.attribution) & other.split.train).any()


@pytest.mark.slow
def test_where_the_fit_misses_its_own_data_nothing_is_turned(loud: tuple[Verdict, Path]) -> None:
    found = loud[0].attribution
    assert turned(found) is None
    after = found.final_residual
    worse = dataclasses.replace(after, held_out_chi2_per_dof=5.0, train_chi2_per_dof=2 * after.limits.chi2_per_dof)
    assert turned(dataclasses.replace(found, final_residual=worse)) is None
