"""What was done between two runs is one event: names that begin with the same run are leads, and it is said why."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from lead_case import fitted, found
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import available_effects, make_effect
from vgvt.reconcile import reconcile
from vgvt.reconcile.decision import leads
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.kinds import Kind, kind_of
from vgvt.reconcile.decision.leads import as_leads, why_no_name
from vgvt.reconcile.decision.one_event import begin_together, beginning_of
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import stored_thresholds

LIMITS = stored_thresholds()


def thing(name: str, **settings: Any) -> Hypothesis:
    return Hypothesis(available_effects()[name], settings)


PAYLOAD, COOLER = thing("payload-change", from_run=3), thing("temperature-change", shape="step", from_run=3)


@pytest.mark.parametrize(
    ("hypothesis", "run"),
    [
        (PAYLOAD, 3),
        (COOLER, 3),
        (thing("re-hang"), 2),
        (thing("run-drift", shape="step", from_run=4), 4),
        # What creeps begins with the campaign, as all that creeps does.
        (thing("run-drift", shape="linear", from_run=4), None),
        (thing("temperature-change", shape="exponential"), None),
        (thing("temperature-change"), None),
        (thing("added-mass"), None),
        (thing("roving-sensor-mass"), None),
    ],
)
def test_a_change_between_runs_begins_with_one(hypothesis: Hypothesis, run: int | None) -> None:
    assert beginning_of(hypothesis) == run


@pytest.mark.parametrize(
    ("others", "told"),
    [
        ((COOLER,), (("payload-change", "temperature-change"), 3)),
        ((thing("added-mass"), COOLER), (("payload-change", "temperature-change"), 3)),
        ((thing("re-hang", from_run=2), thing("drive-remount", from_run=2)), (("re-hang", "drive-remount"), 2)),
        ((thing("re-hang", from_run=2),), ((), 0)),
        ((thing("temperature-change", shape="linear", from_run=3),), ((), 0)),
        ((thing("added-mass"),), ((), 0)),
        ((), ((), 0)),
    ],
)
def test_those_that_begin_with_the_same_run(others: tuple[Hypothesis, ...], told: tuple[tuple[str, ...], int]) -> None:
    assert begin_together((PAYLOAD, *others)) == told


def named(*hypotheses: Hypothesis) -> Attribution:
    """Two names that meet the data."""
    case = found((100.0, 100.0), (0.7, 0.7), adequate=True, names=2)
    return replace(case, final=fitted(700.0, hypotheses=hypotheses))


@pytest.fixture(autouse=True)
def plausible_things(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(leads, "implausible", lambda fit, index=-1: ())


def test_they_are_leads_however_well_they_meet_the_data() -> None:
    case = named(PAYLOAD, COOLER)
    judged = as_leads(case, LIMITS)
    assert judged.leads == case.rounds
    assert kind_of(judged) is Kind.UNKNOWN
    said = why_no_name(judged)
    assert "payload-change and temperature-change begin with the same run, 3" in said
    assert "declare" in said


@pytest.mark.parametrize("other", [thing("re-hang", from_run=2), thing("added-mass")])
def test_two_events_are_two_names(other: Hypothesis) -> None:
    case = named(PAYLOAD, other)
    assert as_leads(case, LIMITS) is case


@pytest.mark.slow
def test_another_hang_that_no_catalogue_holds_is_unknown(tmp_path: Path) -> None:
    """Its relatives meet the data together; with its own name to choose it is explained."""
    shifted = make_effect("re-hang", "test", shift_x_m=-0.01, from_run=2)
    campaign = campaign_of(roving_scenario(), 3, shifted)
    names = ("payload-change", "temperature-change", "run-drift", "added-mass", "re-hang")
    known = {n: available_effects()[n] for n in names}
    verdict = reconcile(campaign, roving_scenario(), effects=known, lines=120, folder=tmp_path, with_tests=False)
    assert [e.name for e in verdict.effects] == ["re-hang"], verdict
    del known["re-hang"]
    verdict = reconcile(campaign, roving_scenario(), effects=known, lines=120, folder=tmp_path, with_tests=False)
    assert verdict.kind is Kind.UNKNOWN, verdict


@pytest.mark.slow
def test_two_changes_with_a_run_between_them_both_have_their_names(tmp_path: Path) -> None:
    heavier = make_effect("payload-change", "test", mass_kg=0.05, x_m=0.9, y_m=1.1, from_run=2)
    softer = make_effect("run-drift", "test", drift=-0.02, shape="step", from_run=3)
    campaign = campaign_of(roving_scenario(), 3, heavier, softer)
    known = {n: available_effects()[n] for n in ("payload-change", "run-drift", "added-mass")}
    verdict = reconcile(campaign, roving_scenario(), effects=known, lines=120, folder=tmp_path, with_tests=False)
    assert {e.name for e in verdict.effects} == {"payload-change", "run-drift"}, verdict
