"""A name that lives on the tolerances is a lead: what is missing was imitated by them, and a right name lets go."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from lead_case import fitted, found, left

from vgvt.reconcile.decision import leads
from vgvt.reconcile.decision.kinds import Kind, kind_of
from vgvt.reconcile.decision.leads import as_leads, why_no_name

THRESHOLDS: Any = SimpleNamespace()


@pytest.fixture(autouse=True)
def plausible_things(monkeypatch: pytest.MonkeyPatch) -> None:
    """All of them."""
    monkeypatch.setattr(leads, "implausible", lambda fit, index=-1: ())


@pytest.mark.parametrize(
    ("before", "after", "adequate", "kept"),
    [
        (5.0, 9.1, False, False),
        (5.0, 4.9, False, True),  # it lets go of some
        (1.0, 3.9, False, True),  # no more than campaigns do in which nothing is missing
        (1.0, 4.1, False, False),
        (5.0, 9.1, True, True),
        (40.0, 15.9, False, True),
        (40.0, 16.1, False, False),  # four times what they may give: a mass's inertia had been half a loose flap
        (40.0, 16.1, True, True),
    ],
)
def test_a_name_that_makes_tolerances_give_more_than_before_is_a_lead(
    before: float, after: float, adequate: bool, kept: bool
) -> None:
    """A line from tip to tip was a flap with a cable, as the body and the wings had to give for it."""
    case = found((1.7, 1.6), (1.0, 1.1), adequate)
    case = replace(case, null_residual=left(1.6, strain=before), final_residual=left(1.1, adequate, after))
    judged = as_leads(case, THRESHOLDS)
    assert (judged is case) == kept
    if not kept:
        assert kind_of(judged) is Kind.UNKNOWN


@pytest.mark.parametrize(
    ("before", "after", "held_out", "kept"),
    [
        (2600.0, 18.0, 0.9, True),  # a root that slips: what is foretold of it is wrong by a share of what it does
        (190.0, 18.0, 0.9, True),
        (170.0, 18.0, 0.9, False),  # more than a tenth of what they had to give without it
        (2600.0, 18.0, 1.1, False),  # held-out data are missed
    ],
)
def test_where_data_are_met_tolerances_that_let_go_of_nine_tenths_are_not_far_off(
    monkeypatch: pytest.MonkeyPatch, before: float, after: float, held_out: float, kept: bool
) -> None:
    case = found((70.0, 90.0), (0.9, held_out))
    case = replace(case, null_residual=left(90.0, strain=before), final_residual=left(held_out, False, after))
    judged = as_leads(case, THRESHOLDS)
    assert (judged is case) == kept
    if not kept:
        led = fitted(900.0)
        led.held_out_chi2_per_dof = held_out
        monkeypatch.setattr(leads, "strain_sd", lambda fit: after)
        told = replace(case, rounds=(), leads=case.rounds, led=led)
        assert "to give 18 standard deviations beyond chance, more than 4 times" in why_no_name(told)


def test_it_is_said_that_a_lead_lives_on_the_tolerances(monkeypatch: pytest.MonkeyPatch) -> None:
    case = found((1.7, 1.6), (1.0, 1.1))
    led: Any = SimpleNamespace(hypotheses=(), chi2_per_dof=1.0, held_out_chi2_per_dof=1.1)
    monkeypatch.setattr(leads, "strain_sd", lambda fit: 9.1)
    judged = replace(case, null_residual=left(1.6, strain=5.0), rounds=(), leads=case.rounds, led=led)
    assert "the tolerances give more than without (9.1 standard deviations beyond chance, 5.0 before)" in why_no_name(
        judged
    )


@pytest.mark.parametrize(("after", "said"), [(16.1, True), (15.9, False)])
def test_it_is_said_that_a_lead_leaves_the_tolerances_far_off(
    monkeypatch: pytest.MonkeyPatch, after: float, said: bool
) -> None:
    case = found((1.7, 1.6), (1.0, 1.1))
    led = fitted(1000.0)
    led.held_out_chi2_per_dof = 1.1
    monkeypatch.setattr(leads, "strain_sd", lambda fit: after)
    judged = replace(case, null_residual=left(1.6, strain=40.0), rounds=(), leads=case.rounds, led=led)
    assert ("to give 16 standard deviations beyond chance, more than 4 times" in why_no_name(judged)) == said
