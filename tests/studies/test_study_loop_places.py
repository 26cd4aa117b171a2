"""The umpire of places: where truths sit, where a verdict says that they do, and whether that is the same."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import loop_truth
import pytest
from loop_places import NOWHERE, Where, said_place, where, where_explained

from vgvt.reconcile import Place
from vgvt.reconcile.evidence.free_places import ON_BOTH_SIDES


@pytest.mark.parametrize(
    ("name", "said", "expected"),
    [
        ("added-mass", {"x_m": 0.5, "y_m": 0.2, "mass_kg": 0.1}, Where((0.5, 0.2))),
        ("loose-sensor-mount", {"node": 7, "period_s": 0.01}, Where(nodes=frozenset((7,)))),
        ("swapped-sensors", {"node": 7, "other_node": 9}, Where(nodes=frozenset((7, 9)))),
        ("channel-gain", {"channels": "19+Z"}, Where(nodes=frozenset((19,)))),
        ("channel-delay", {"channels": "response", "delay_s": 1e-4}, Where(force=True)),
        ("channel-gain", {"channels": "force"}, Where(force=True)),
        ("root-compliance", {"side": "left", "bending": 0.1}, Where(side="left")),
        ("run-drift", {"shape": "step", "drift": 0.01}, NOWHERE),
    ],
)
def test_a_truth_sits_where_its_settings_say(name: str, said: dict[str, object], expected: Where) -> None:
    assert where(name, said, loop_truth.nominal()) == expected


def test_a_truth_without_a_setting_sits_where_it_is_fixed() -> None:
    true = loop_truth.nominal()
    assert where("suspension-surge", {"mass_kg": 0.3}, true).point_m == true.suspension.hook_m[:2]
    mount = where("mount-compliance", {}, true)
    assert mount == Where(true.shaker.position_m[:2], force=True)


def place(label: str, position_m: tuple[float, float, float] | None = None) -> Place:
    """What the localisation says."""
    return Place(label, "structure", position_m, 0.5, "unclear", 0.0, "", None)


@pytest.mark.parametrize(
    ("explained", "expected"),
    [
        (place("force at 7+Z", (0.7, -0.2, 0.1)), Where((0.7, -0.2))),
        (place("bending at the root of wing-left", (0.5, -0.2, 0.0)), Where((0.5, -0.2), side="left")),
        (place("run 5, 19+Z"), Where(nodes=frozenset((19,)))),
        (place("force channel"), Where(force=True)),
    ],
)
def test_what_explains_a_residual_has_a_place(explained: Place, expected: Where) -> None:
    assert where_explained(explained) == expected


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        (Where((0.5, 1.0)), Where((0.6, 1.2)), True),
        (Where((0.5, 1.0)), Where((0.5, 1.31)), False),
        (Where((0.5, 1.0)), Where(nodes=frozenset((3,))), False),
        (Where(nodes=frozenset((3, 4))), Where(nodes=frozenset((4,))), True),
        (Where(nodes=frozenset((3,))), Where(nodes=frozenset((4,))), False),
        (Where(side="left"), Where((0.5, -0.2), side="left"), True),
        (Where(side="left"), Where(side="right"), False),
        (Where((0.6, 0.1), force=True), Where(force=True), True),
        (Where(force=True), Where((0.6, 0.1)), False),
        (NOWHERE, NOWHERE, False),
    ],
)
def test_two_places_are_one_where_something_known_of_both_agrees(one: Where, other: Where, same: bool) -> None:
    assert one.same(other) == other.same(one) == same


def test_a_verdict_says_where_what_it_names_first_sits_or_else_where_the_residual_does() -> None:
    residual = SimpleNamespace(places=[place("force at 12+Z", (0.7, -0.2, 0.1)), place("force channel")])
    fixed = SimpleNamespace(name="added-mass", settings={"x_m": 0.5, "y_m": 1.0}, parameters={})
    freed = SimpleNamespace(
        name="local-absorber", settings={}, parameters={"x_m": (0.6, 0.1, "m"), "y_m": (-1.0, 0.1, "m")}
    )
    drift = SimpleNamespace(name="run-drift", settings={}, parameters={})

    def said(
        *effects: object,
        places: object = residual,
        nameless: str | None = None,
        instead_of: object = ("run-drift",),
        point_m: tuple[float, float] | None = None,
    ) -> Where:
        where = None
        if nameless is not None:
            where = SimpleNamespace(where=SimpleNamespace(label=nameless, point_m=point_m), instead_of=instead_of)
        attribution = SimpleNamespace(nameless=where)
        verdict: Any = SimpleNamespace(effects=effects, localisation=places, attribution=attribution)
        return said_place(verdict, loop_truth.nominal())

    assert said(fixed, freed).point_m == (0.5, 1.0)
    assert said(freed, fixed).point_m == (0.6, -1.0)
    assert said(drift, fixed) == said() == Where((0.7, -0.2))
    assert said(places=None) == NOWHERE
    # What has no name is what the verdict says is there, whatever is named beside it.
    assert said(fixed, nameless="force channel") == Where(force=True)
    assert said(fixed, nameless=f"force at 12+Z{ON_BOTH_SIDES}") == Where((0.7, -0.2))
    assert said(fixed, nameless="force at 1+Z") == NOWHERE
    assert said(fixed, nameless="force at x = 0.68 m, y = -0.79 m", point_m=(0.68, -0.79)) == Where((0.68, -0.79))
    # What stands beside a name, and instead of none, is told after it.
    assert said(fixed, nameless="force channel", instead_of=()) == said(fixed)
