"""Names that begin with the same run may be one event that is in no catalogue: they explain in part, and it is said."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from lead_case import fitted, found
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import available_effects, make_effect
from vgvt.reconcile import reconcile
from vgvt.reconcile.decision import kinds
from vgvt.reconcile.decision.doubts import doubts
from vgvt.reconcile.decision.kinds import Kind, kind_of
from vgvt.reconcile.decision.one_event import begin_together, beginning_of, together_in
from vgvt.reconcile.question.hypothesis import Hypothesis


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
    assert begin_together((PAYLOAD, *others), range(1, 6)) == told


@pytest.mark.parametrize(("seen", "told"), [((1, 2, 4, 5), True), ((1, 2, 5), True), ((1, 2, 3, 5), False)])
def test_beginnings_that_no_fitted_run_lies_between_are_one(seen: tuple[int, ...], told: bool) -> None:
    """With the third run held out a change before it and one before the fourth are the same to a fit."""
    remount = thing("drive-remount", from_run=4)
    names = ("payload-change", "drive-remount")
    assert begin_together((PAYLOAD, remount), seen) == ((names, 3) if told else ((), 0))


def test_a_fit_knows_which_runs_it_was_made_to() -> None:
    remount = thing("drive-remount", from_run=4)
    channels = [SimpleNamespace(run=run, run_number=run + 1) for run in (0, 1, 2, 2, 3)]
    for train, told in (([True, True, False, False, True], True), ([True, True, False, True, True], False)):
        problem = SimpleNamespace(measured=SimpleNamespace(channels=channels), split=SimpleNamespace(train=train))
        fit: Any = SimpleNamespace(hypotheses=(PAYLOAD, remount), problem=problem)
        assert bool(together_in(fit)[0]) is told


def test_the_run_is_told_as_the_log_of_the_test_has_it() -> None:
    """Runs 3 and 4 were left out of the campaign: what begins with the third that is there begins with run 5."""
    channels = [SimpleNamespace(run=k, run_number=number) for k, number in enumerate((1, 2, 5, 6))]
    problem = SimpleNamespace(measured=SimpleNamespace(channels=channels), split=SimpleNamespace(train=[True] * 4))
    fit: Any = SimpleNamespace(hypotheses=(PAYLOAD, thing("drive-remount", from_run=3)), problem=problem)
    assert together_in(fit) == (("payload-change", "drive-remount"), 5)


def kind_with(monkeypatch: pytest.MonkeyPatch, *hypotheses: Hypothesis) -> tuple[Kind, tuple[str, ...]]:
    """The verdict on two names that meet the data, and what is doubted of them."""
    case = found((100.0, 100.0), (0.7, 0.7), adequate=True, names=2)
    winner: Any = SimpleNamespace(name="one", hypothesis=SimpleNamespace(linear=True))
    addition: Any = SimpleNamespace(winner=winner, alike=(winner,), equivalent=(winner,))
    final = fitted(700.0, hypotheses=hypotheses)
    final.problem.measured = SimpleNamespace(channels=[SimpleNamespace(run=k, run_number=k + 1) for k in range(5)])
    final.problem.split = SimpleNamespace(train=[True] * 5)
    case = replace(case, rounds=(addition,) * 2, final=final)
    monkeypatch.setattr(kinds, "rests_on_one_level", lambda case: ())
    monkeypatch.setattr(kinds, "open_places", lambda addition: ())
    return kind_of(case), doubts(case)


def test_they_explain_in_part_however_well_they_meet_the_data(monkeypatch: pytest.MonkeyPatch) -> None:
    kind, (doubt,) = kind_with(monkeypatch, PAYLOAD, COOLER)
    assert kind is Kind.PARTLY_EXPLAINED
    assert "payload-change and temperature-change begin together, from run 3 on" in doubt
    assert "the log of the test does" in doubt


@pytest.mark.parametrize("other", [thing("re-hang", from_run=2), thing("added-mass")])
def test_two_events_are_two_names(monkeypatch: pytest.MonkeyPatch, other: Hypothesis) -> None:
    assert kind_with(monkeypatch, PAYLOAD, other) == (Kind.EXPLAINED, ())


@pytest.mark.slow
def test_another_hang_that_no_catalogue_holds_is_not_explained(tmp_path: Path) -> None:
    """Its relatives meet the data together; with its own name to choose it is explained."""
    shifted = make_effect("re-hang", "test", shift_x_m=-0.01, from_run=2)
    campaign = campaign_of(roving_scenario(), 3, shifted)
    names = ("payload-change", "temperature-change", "run-drift", "added-mass", "re-hang")
    known = {n: available_effects()[n] for n in names}
    verdict = reconcile(campaign, roving_scenario(), effects=known, lines=120, folder=tmp_path, with_tests=False)
    assert [e.name for e in verdict.effects] == ["re-hang"], verdict
    del known["re-hang"]
    verdict = reconcile(campaign, roving_scenario(), effects=known, lines=120, folder=tmp_path, with_tests=False)
    assert verdict.kind in (Kind.UNKNOWN, Kind.PARTLY_EXPLAINED), verdict


@pytest.mark.slow
def test_two_changes_with_a_run_between_them_both_have_their_names(tmp_path: Path) -> None:
    heavier = make_effect("payload-change", "test", mass_kg=0.05, x_m=0.9, y_m=1.1, from_run=2)
    softer = make_effect("run-drift", "test", drift=-0.02, shape="step", from_run=3)
    campaign = campaign_of(roving_scenario(), 3, heavier, softer)
    known = {n: available_effects()[n] for n in ("payload-change", "run-drift", "added-mass")}
    verdict = reconcile(campaign, roving_scenario(), effects=known, lines=120, folder=tmp_path, with_tests=False)
    assert {e.name for e in verdict.effects} == {"payload-change", "run-drift"}, verdict
