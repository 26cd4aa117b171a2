"""What is kept and what is tried again: a method that ran out of time, and it alone, gets another chance."""

from __future__ import annotations

import pytest

from vgvt.bench.bench import BenchPlan, bench
from vgvt.bench.entry import Entry
from vgvt.bench.rows import FAILED, ran_out_of_time
from vgvt.bench.umpire import Attempt, Limits

ENTRIES = (Entry("slow"), Entry("broken"))


@pytest.fixture
def umpire(monkeypatch):
    """An umpire whose word is law: the reasons by entry, and what it was asked."""
    reasons = {"slow": "took more than 60 s", "broken": "crashed: KeyError: 'took more than 60 s'"}
    asked: list[tuple[str, str]] = []

    def attempt(entry, file, _band, _limits):
        asked.append((file.parent.name, entry.label))
        return Attempt(None, reasons[entry.label], 60.0, 100.0)

    monkeypatch.setattr("vgvt.bench.cell.attempt", attempt)
    return reasons, asked


def test_what_ran_out_of_time_is_tried_again_and_nothing_else(light_scenario, tmp_path, umpire) -> None:
    reasons, asked = umpire
    one, two = (BenchPlan((light_scenario,), seeds, ENTRIES, Limits()) for seeds in (1, 2))
    first = bench(one, tmp_path)
    assert [label for _, label in asked] == ["slow", "broken"]
    reports: list[float] = []
    asked.clear()
    still = bench(two, tmp_path, progress=lambda fraction, _: reports.append(fraction))
    # The new campaign comes first: what was too slow may take its whole time once more.
    assert [label for _, label in asked] == ["slow", "broken", "slow"]
    assert reports[-1] == 1.0
    assert still[still["seed_number"] == 0].reset_index(drop=True).equals(first)
    asked.clear()
    reasons["slow"] = "declined: nothing there"
    after = bench(two, tmp_path)
    assert [label for _, label in asked] == ["slow", "slow"]
    assert sorted(after["reason"]) == sorted(2 * list(reasons.values()))
    asked.clear()
    assert bench(two, tmp_path).equals(after)
    assert asked == []


def test_only_the_clock_makes_a_row_that_ran_out_of_time() -> None:
    assert ran_out_of_time({"outcome": FAILED, "reason": "took more than 0.5 s"})
    assert not ran_out_of_time({"outcome": FAILED, "reason": "needs more than 16 MiB of memory"})
    assert not ran_out_of_time({"outcome": "nothing-found", "reason": "took more than one look"})
