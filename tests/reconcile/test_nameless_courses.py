"""When a law may act: courses that are one where fitted are asked together, and what no data can tell apart once."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from vgvt.reconcile.evidence.still_explained import StillExplained, _Acting, _best, _courses


@pytest.mark.parametrize(
    ("held", "pair"),
    [
        (0, {"": (1, 1, 1, 1), "from run 2 on": (0, 1, 1, 1)}),
        (1, {"from run 2 on": (0, 1, 1, 1), "from run 3 on": (0, 0, 1, 1)}),
        (2, {"from run 3 on": (0, 0, 1, 1), "in run 4 alone": (0, 0, 0, 1)}),
        (3, {"from run 3 on": (0, 0, 1, 1), "in run 3 alone": (0, 0, 1, 0)}),
    ],
)
def test_what_begins_with_a_held_out_run_is_asked_too(held: int, pair: dict[str, tuple[int, ...]]) -> None:
    """Of either of the two fitted data know the same; what is seen in a held-out run alone is not asked."""
    place, runs = SimpleNamespace(kind="structure"), dict(enumerate((1, 2, 3, 4)))
    fitted = np.delete(np.arange(4), held)
    courses = dict(_courses(cast(Any, place), fitted, np.arange(4), runs))
    seen = [tuple(c[fitted]) for c in courses.values()]
    assert all(any(course) for course in seen)
    twins = {when: tuple(c) for when, c in courses.items() if seen.count(tuple(c[fitted])) > 1}
    assert twins == pair


def test_one_sensor_in_one_run_is_a_place_of_its_own() -> None:
    place: Any = SimpleNamespace(kind="sensor", label="sensor-1 in every run")
    runs = dict(enumerate((1, 2, 3, 4)))
    assert _courses(place, np.array([2]), np.array([2]), runs) == []
    assert _courses(place, np.array([], dtype=int), np.array([2]), runs) == []
    assert [when for when, _ in _courses(place, np.array([1]), np.array([1, 2]), runs)] == [""]
    assert "from run 4 on" not in dict(_courses(place, np.arange(4), np.arange(4), runs))


def acting(label: str, kind: str, nats: float, share: tuple[float, ...], when: str = "") -> _Acting:
    on = label if kind == "structure" else ""
    return _Acting(StillExplained(label, kind, nats, when), on, np.array(share))


def test_what_fitted_data_cannot_tell_is_asked_together_and_what_no_data_can_once() -> None:
    """Channels of runs 1, 2, 3 and 4 by two sensors, of which the fourth has one; the third is held out."""
    fitted, used = np.array([1, 1, 1, 1, 0, 0, 1, 0], dtype=bool), np.array([1, 1, 1, 1, 1, 1, 1, 0], dtype=bool)
    told = [
        acting("force at 5+Z", "structure", 3.0, (0, 0, 0, 0, 1, 1, 1, 1), "from run 3 on"),
        acting("force at 5+Z", "structure", 3.0, (0, 0, 0, 0, 0, 0, 1, 1), "in run 4 alone"),
        acting("force channel", "drive", 7.0, (0, 0, 0, 0, 1, 1, 1, 1), "from run 3 on"),
        acting("force channel", "drive", 7.0, (0, 0, 0, 0, 0, 0, 1, 1), "in run 4 alone"),
        acting("sensor-1 in every run", "sensor", 7.0, (0, 0, 0, 0, 1, 0, 1, 0), "from run 3 on"),
        acting("run 4, 4+Z", "sensor", 7.0, (0, 0, 0, 0, 0, 0, 1, 0)),
    ]
    best = _best(told, fitted, used)
    # Two on the structure, and three factors: that of the last run is called in two ways.
    assert best.asked == 5 and best.nats == pytest.approx(7 - np.log(5))
    assert [(s.label, s.when, s.asked, s.or_on) for s in best.alike] == [
        ("force channel", "in run 4 alone", 5, ("run 4, 4+Z",)),
        ("sensor-1 in every run", "from run 3 on", 5, ()),
    ]
    assert best.alike[0].words == "factor on the force channel in run 4 alone or on run 4, 4+Z"
    assert best.words == (
        "factor on the force channel from run 3 on or in run 4 alone or on sensor-1 from run 3 on or on run 4, 4+Z"
    )
    one = replace(best, label="force at 5+Z", kind="structure", when="", alike=(told[0].told,))
    assert one.words == "force at 5+Z in every run or from run 3 on"
