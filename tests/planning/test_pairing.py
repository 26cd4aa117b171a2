"""Targets and modes are paired one to one, in the prediction, in the search and in the confirmation alike."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from vgvt.planning import confirmation, search
from vgvt.planning.budget import AS_DESCRIBED, Budget
from vgvt.planning.confirmation import confirm
from vgvt.planning.pairing import named_alike, paired
from vgvt.planning.prediction import ModePrediction, Prediction
from vgvt.planning.proposal import Proposal
from vgvt.planning.wish import Wish

CLOSE = (("symmetric torsion", 33.096), ("antisymmetric torsion", 33.348))


def mode(label: str, hz: float) -> ModePrediction:
    return ModePrediction(label, hz, 0.011, 1e-4, 1e-5, 0.0)


def plan(light, *modes: ModePrediction) -> Proposal:
    return Proposal("plan-1", light, AS_DESCRIBED, 8.0, Prediction(modes, 1.0, 1.0, 1.0), CLOSE)


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        ([33.10], [0, None]),
        ([33.34], [None, 0]),
        ([33.34, 33.10], [1, 0]),
        ([33.10, 33.11, 40.0], [0, 1]),
        ([33.10, 33.9], [0, 1]),
        ([33.10, 34.5], [0, None]),  # 3.4 % off
        ([np.nan, 33.34], [None, 1]),
        ([], [None, None]),
    ],
)
def test_no_mode_stands_for_two(found, expected) -> None:
    assert paired([hz for _, hz in CLOSE], found, 0.03) == expected


def test_a_namesake_goes_before_a_nearer_stranger_and_before_more_pairs() -> None:
    def by_name(targets, found):
        alike = named_alike([t for t, _ in targets], [f for f, _ in found])
        return paired([hz for _, hz in targets], [hz for _, hz in found], 0.1, alike)

    assert by_name([("a", 10.0)], [("b", 10.0), ("a", 10.9)]) == [1]
    assert by_name([("a", 10.0)], [("b", 10.2), ("a", 11.1)]) == [0], "11 % off is another mode"
    assert by_name([("a", 10.0), ("b", 10.9)], [("b", 10.1), ("c", 11.8)]) == [None, 0]
    assert by_name([("a", 10.0), ("a", 10.5)], [("a", 10.6), ("a", 10.1)]) == [1, 0]


def test_a_target_that_a_plan_misses_has_no_finite_deviation(light) -> None:
    first, second = plan(light, mode("symmetric torsion", 33.1)).modes
    assert first.relative_damping_std < 0.01
    assert second.label == "antisymmetric torsion"
    assert np.isinf(second.relative_damping_std)
    assert np.isinf(plan(light, mode("symmetric torsion", 33.1)).worst_relative_damping_std)
    both = plan(light, mode("antisymmetric torsion", 33.2), mode("symmetric torsion", 33.3)).modes
    assert [m.frequency_hz for m in both] == [33.3, 33.2], "by name"


def test_a_search_looks_at_two_modes_for_two_targets(light) -> None:
    (system,) = search.systems_of(light)
    first, second = np.flatnonzero(system.modes.natural_frequency_hz > 5)[:2]
    hz = system.modes.natural_frequency_hz.copy()
    hz[second] = 1.01 * hz[first]
    close = dataclasses.replace(system, modes=dataclasses.replace(system.modes, natural_frequency_hz=hz))
    targets = tuple(("unheard of", float(hz[first]) * factor) for factor in (1.0, 1.003))
    wish = Wish(frozenset(), Budget(8, 10), 10, 1.0, targets=targets)
    assert search._wanted(close, wish).tolist() == [first, second]
    three = dataclasses.replace(wish, targets=(*targets, ("unheard of", float(hz[first]) * 1.005)))
    assert search._wanted(close, three) is None, "a third mode is not there"


def test_a_campaign_that_claims_one_of_two_close_modes_has_missed_the_other(light, monkeypatch) -> None:
    generator = np.random.default_rng(0)

    def one_of_two(_scenario, numbers):
        for _ in numbers:
            yield 33.10 + 1e-4 * generator.standard_normal(1), 0.011 + 1e-5 * generator.standard_normal(1)

    monkeypatch.setattr(confirmation, "estimates", one_of_two)
    seen = confirm(plan(light, *(mode(*target) for target in CLOSE)), "informed", 20)
    assert seen.found.tolist() == [20, 0]
    assert np.isinf(seen.worst_relative_damping_std)
