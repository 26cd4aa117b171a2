"""The tables of the study of reconcile: what counts as right, and intervals that mean what they say."""

from __future__ import annotations

import dataclasses
from typing import Any

import closing_the_loop as study
import loop_cases
import loop_results
import loop_work
import pytest
import scipy.stats
from loop_cases import Case

from vgvt.effects import available_effects
from vgvt.effects.protocol import Family


@pytest.mark.parametrize(("hits", "trials"), [(0, 20), (1, 20), (19, 20), (20, 20), (60, 200)])
def test_intervals_are_wilsons(hits: int, trials: int) -> None:
    known = scipy.stats.binomtest(hits, trials).proportion_ci(0.95, "wilson")
    assert loop_results.wilson(hits, trials) == pytest.approx((known.low, known.high), abs=1e-12)


def test_behind_each_verdict_stands_what_was_true() -> None:
    def row(group: str, verdict: str, **said: Any) -> loop_results.Row:
        return {"group": group, "verdict": verdict, "ratio": 2.0, "answer": "wrong", "near": False} | said

    rows = [
        row("placebo", "adequate"), row("effect", "adequate"), row("effect", "adequate", ratio=0.8),
        row("effect", "explained", answer="right"), row("removed", "explained"),
        row("never", "partly_explained", near=True), row("never", "partly_explained"),
        row("never", "unknown"), row("placebo", "unknown"),
    ]  # fmt: skip
    said = loop_results.by_verdict(rows).splitlines()
    found = {line.split(" | ")[0].strip("| "): line.split(" | ")[2:] for line in said[2:]}
    assert found["adequate"][0].startswith("2 of 3,") and found["adequate"][1] == "one effect 1 |"
    assert found["explained"][0].startswith("1 of 2,") and found["explained"][1] == "removed 1 |"
    assert found["partly explained"][0].startswith("1 of 2,") and found["partly explained"][1] == "never catalogued 1 |"
    assert found["unknown"][0].startswith("1 of 2,") and found["unknown"][1] == "nothing missing 1 |"
    assert found["ambiguous"] == ["–", "– |"]


def test_truths_at_the_limit_are_counted_by_themselves() -> None:
    """What is just visible is named in about half of the cases, and must not hide what larger ones are."""

    def row(ratio: float, answer: str) -> loop_results.Row:
        return {
            "group": "effect", "verdict": "explained", "truth": "a", "named": "a", "ratio": ratio, "answer": answer,
            "held_after": 1.0, "core": "c",
        }  # fmt: skip

    sized = [(1.0, "nothing"), (1.05, "right"), (0.9, "nothing"), (2.0, "right"), (9.0, "in the set")]
    said = loop_results.headline([row(*s) for s in sized])
    assert "| truth in the set (≤ 3 members), above the limit | ≥ 95 % | 3 of 4, " in said
    assert "| … of these within a tenth of the limit itself |  | 1 of 2, " in said
    assert "| … of these beyond that | ≥ 95 % | 2 of 2, " in said
    # What has no size is above any limit.
    assert "beyond that | ≥ 95 % | 1 of 1, " in loop_results.headline([row(float("nan"), "right")])


def test_what_no_data_could_tell_from_the_truth_is_counted_by_itself() -> None:
    """A damper from the body to the ground is the suspension's, if that is not in the catalogue."""

    def row(ahead: float | None, named: str) -> loop_results.Row:
        found = {"verdict": "explained", "near": False} if named else {"verdict": "unknown", "near": True}
        mine = {"group": "removed", "truth": "a", "answer": "wrong", "core": "c"}
        return {**mine, "named": named, "told_ahead_nats": ahead, **found}

    said = loop_results.headline([row(2.0, "twin"), row(80.0, "wrong"), row(None, "older"), row(None, "")])
    assert "| removed from the catalogue: unknown, or partly with its place | ≥ 90 % | 1 of 4, " in said
    assert "as well as the truth itself would (5 nats) | ≥ 90 % | 1 of 3, " in said


def test_a_name_that_the_catalogue_warns_of_is_counted_by_itself() -> None:
    """A suspension's damper may be told as one at a point, but not together with a mass, which it is not taken for."""

    def row(named: str, truth: str = "suspension-damping") -> loop_results.Row:
        return {"group": "removed", "verdict": "explained", "near": False, "truth": truth, "named": named,
                "answer": "wrong", "core": "c"}  # fmt: skip

    named = ["nonproportional-damper", "added-mass or nonproportional-damper", "nonproportional-damper | added-mass"]
    other = [row("added-mass"), row("channel-delay", "anti-alias-delay")]
    said = loop_results.headline([*map(row, named), *other])
    assert "| removed from the catalogue: unknown, or partly with its place | ≥ 90 % | 0 of 5, " in said
    assert "a name that the catalogue says it could be taken for |  | 3 of 5, " in said


def test_a_family_is_taken_out_as_a_whole() -> None:
    """A drift, which is what warming does to the data, is not there to be named where warming is the truth."""
    of_two = Case("family", ("temperature-change",), 0, 6.0, 0.01)
    left = set(of_two.catalogue)
    mine = {n for n in available_effects() if loop_cases.family_of(n) is Family.BETWEEN_RUNS}
    assert {"temperature-change", "run-drift"} <= mine
    assert left == set(available_effects()) - mine
    alone = dataclasses.replace(of_two, group="removed")
    assert set(alone.catalogue) == set(available_effects()) - {"temperature-change"}
    assert of_two.key != alone.key


def test_what_was_taken_out_with_its_family_has_a_row_of_its_own() -> None:
    mine = {"group": "family", "truth": "a", "answer": "wrong", "core": "c", "near": False, "named": "b"}
    rows = [mine | {"verdict": "unknown", "named": ""}, mine | {"verdict": "explained"}]
    said = loop_results.headline(rows)
    assert "| removed with its whole family: unknown, or partly with its place | ≥ 90 % | 1 of 2, " in said
    assert "| removed from the catalogue: unknown, or partly with its place | ≥ 90 % | – |" in said
    assert "removed with its family 1" in loop_results.by_verdict(rows)
    assert loop_results.confusion(rows) == {("a (family)", "unknown"): 1, ("a (family)", "b"): 1}


def test_of_two_the_second_is_taken_out() -> None:
    """The records hold both; what is asked is whether the other one is found, and what is missing is not hidden."""
    case = Case("beside", ("added-mass", "run-drift"), 0, 6.0, 0.01)
    assert set(case.catalogue) == set(available_effects()) - {"run-drift"}
    planned = {c.truth for c in study.plan(1, 1, 1, 8) if c.group == "beside"}
    assert planned == {c.truth for c in study.plan(1, 1, 1, 8) if c.group == "pair"}


@pytest.mark.parametrize(
    ("verdict", "named", "leads", "right", "told"),
    [
        ("unknown", "", "a | c", True, True), ("unknown", "", "", True, False),
        ("partly_explained", "a or c", "", True, True), ("partly_explained", "a | c", "", False, True),
        ("partly_explained", "c", "", False, False), ("explained", "a", "", False, True),
        ("adequate", "", "", False, False),
    ],
)  # fmt: skip
def test_what_is_left_of_two_is_named_in_part_and_alone(
    verdict: str, named: str, leads: str, right: bool, told: bool
) -> None:
    """What explains the rest away is worse than to say that something is unknown."""
    sets = [tuple(part.split(" or ")) for part in named.split(" | ")] if named else []
    row = {"group": "beside", "truth": "a+b", "verdict": verdict, "named": named, "leads": leads, "core": "c",
           "answer": loop_work.answer(("a", "b"), verdict, sets), "near": False}  # fmt: skip
    said = loop_results.headline([row])
    assert (
        f"| two effects, one of them removed: unknown, or partly by the other one alone |  | {right:d} of 1, " in said
    )
    assert f"| … the other one named, or a lead |  | {told:d} of 1, " in said
    beside = loop_results.by_verdict([row]).splitlines()
    assert any(f"{right:d} of 1, " in line for line in beside)
    assert not loop_results.confusion([row])
