"""Recent answers are known by the argument's identity, and only the last few are."""

from __future__ import annotations

from vgvt.scenario import load_scenario
from vgvt.scenario.mirror import _all_beams, _all_items, expanded_beams, expanded_items
from vgvt.scenario.recent import Recent


def test_the_same_object_is_asked_for_once_and_an_equal_one_anew() -> None:
    asked: list[list[int]] = []

    def made(key: list[int]) -> list[int]:
        asked.append(key)
        return [*key, 0]

    recent, one, other = Recent(made, count=2), [1], [1]
    first = recent(one)
    assert recent(one) is first and len(asked) == 1
    assert recent(other) is not first and len(asked) == 2
    recent([2])
    assert recent(other) == [1, 0] and len(asked) == 3
    # The oldest is gone.
    assert recent(one) is not first and len(asked) == 4


def test_an_airframe_is_written_out_once_and_another_anew() -> None:
    airframe = load_scenario("quick").airframe
    assert expanded_beams(airframe) is expanded_beams(airframe)
    assert expanded_beams(airframe) == _all_beams(airframe) and expanded_items(airframe) == _all_items(airframe)
    beam = airframe.beam[0].model_copy(update={"cells": airframe.beam[0].cells + 1})
    other = airframe.model_copy(update={"beam": (beam, *airframe.beam[1:])})
    assert expanded_beams(other) == _all_beams(other) != expanded_beams(airframe)
