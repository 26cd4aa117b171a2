"""A team looks ahead at what a screen will ask for next; whoever is alone looks at nothing but what is asked for."""

from __future__ import annotations

import heapq
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from vgvt.reconcile import closer_look
from vgvt.reconcile.closer_look import _InSmall
from vgvt.reconcile.screened import Screened

NULL: Any = "a fit"
LEAST_NATS = 5.0


class Together:
    """So many workers that all sit here, and what they were given."""

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self.given: list[list[list[float]]] = []

    def work_off(self, tasks: Any, tell: Any) -> list[Any]:
        self.given.append([[s.gain_nats for s in variants] for _, (_, variants) in tasks])
        return [function(*arguments, tell) for function, arguments in tasks]


@pytest.fixture(autouse=True)
def halved(monkeypatch: pytest.MonkeyPatch) -> None:
    """In small every variant promises half, and comes back with another object for its hypothesis."""
    monkeypatch.setattr(closer_look, "stand_on", lambda null: None)
    monkeypatch.setattr(closer_look, "_checkable", lambda stand, s: s.visible)
    monkeypatch.setattr(
        closer_look, "_in_small", lambda stand, s: replace(s, gain_nats=s.gain_nats / 2, hypothesis=None)
    )


def variants(gains: list[float], name: str = "") -> list[Screened]:
    made: list[Any] = [SimpleNamespace(name=name or f"effect of {gain}") for gain in gains]
    return [Screened(h, {}, gain) for h, gain in zip(made, gains, strict=True)]


def asked(sized: list[Screened], workers: int, count: int) -> tuple[Together, list[Screened]]:
    """The first few of a queue, looked at one after the other."""
    team = Together(workers)
    everyone: Any = team
    small = _InSmall(NULL, SimpleNamespace(), everyone)  # type: ignore[arg-type]
    queue = [(-s.gain_nats, k, 0, s) for k, s in enumerate(sized)]
    heapq.heapify(queue)
    found = []
    for _ in range(count):
        _, k, _, s = heapq.heappop(queue)
        found.append(small.of(k, s, queue, LEAST_NATS))
        heapq.heappush(queue, (-found[-1].gain_nats, k, 1, found[-1]))
    return team, found


def test_alone_nothing_is_looked_at_ahead_of_its_turn() -> None:
    team, found = asked(variants([100.0, 90.0, 80.0]), 1, 2)
    assert team.given == [[[100.0]], [[90.0]]]
    assert [s.gain_nats for s in found] == [50.0, 45.0]


def test_a_team_shares_those_that_come_next() -> None:
    sized = variants([100.0, 99.0, 98.0, 97.0, 96.0, 95.0, 94.0, 4.0])
    team, found = asked(sized, 2, 7)
    # What promises too little is not looked at, nor anything twice.
    assert team.given == [[[100.0, 98.0, 96.0], [99.0, 97.0, 95.0]], [[94.0]]]
    assert [s.hypothesis for s in found] == [s.hypothesis for s in sized[:7]]
    assert [s.gain_nats for s in found] == [s.gain_nats / 2 for s in sized[:7]]


def test_of_one_effect_no_more_are_looked_at_ahead_than_are_looked_at_at_all() -> None:
    same = variants([100.0 - k for k in range(8)], "absorber")
    team, _ = asked([*same, *variants([80.0])], 4, 1)
    assert sorted(gain for share in team.given[0] for gain in share) == [80.0, *(95.0 + k for k in range(6))]
