"""A size that is told keeps its promise where the effect has it; what no size says is not told, and why."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from reconciled_case import campaign_of, problem, roving_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.next_test.at_size import Sight, Views, least, size_of
from vgvt.reconcile.next_test.before_test import expected_fit
from vgvt.reconcile.next_test.nameable import within_reach
from vgvt.reconcile.next_test.power import BY_LEVEL, NEVER, NOT_KNOWN, Power, power
from vgvt.reconcile.next_test.power_rows import confusable, power_rows
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import make_problem
from vgvt.reconcile.question.thresholds import noise_share
from vgvt.reconcile.search.candidates import candidates
from vgvt.reconcile.search.scan import start_values
from vgvt.reconcile.search.stand import Stand
from vgvt.scenario import load_scenario


@pytest.fixture(scope="module")
def stated(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """The scenario as stated."""
    case = problem(tmp_path_factory.mktemp("cache"), 1)
    return fit(case, (), np.zeros(case.size), np.zeros(0), ())


def seen_as(law: Callable[[float], float]) -> tuple[Callable[[float], Views], list[float]]:
    """Looks by a law of the size, and the sizes that were looked at."""
    looked: list[float] = []

    def views_at(size: float) -> Views:
        looked.append(size)
        return ((law(size), law(size)), (2 * law(size), 2 * law(size)))

    return views_at, looked


def test_a_slope_that_keeps_its_promise_is_looked_at_once() -> None:
    views_at, looked = seen_as(lambda size: 100 * size)
    found = size_of(views_at, 0.05, 5.0, 1)
    assert found is not None
    assert looked == [0.05] == [found[0]]


@pytest.mark.parametrize(
    ("law", "wanted"),
    [
        (lambda size: 100 * size + 3e5 * size**3, 0.0213),  # bends up
        (lambda size: 2.0 + 100 * size, 0.03),  # something is there at any size
        (lambda size: math.hypot(3.0 - 60 * size, 0.3) + (100 * size) ** 2 / 8, 0.0592),  # and falls at first
        (lambda size: 30 * size + 200 / (1 + math.exp(-(size - 0.2) / 0.004)), 0.184),  # a resonance comes in
    ],
)
def test_sizes_that_slopes_miss_are_found(law: Callable[[float], float], wanted: float) -> None:
    for foretold in (0.003, 0.05, 0.4):
        views_at, _ = seen_as(law)
        found = size_of(views_at, foretold, 5.0, 1)
        assert found is not None
        assert found[0] == pytest.approx(wanted, rel=0.15)


def test_a_jump_past_what_is_wanted_is_just_visible_beyond_it() -> None:
    views_at, _ = seen_as(lambda size: 40 * size + (9.0 if size > 0.07 else 0.0))
    found = size_of(views_at, 0.125, 5.0, 1)
    assert found is not None
    assert 0.07 < found[0] < 0.07 * 1.15


def test_what_is_there_at_any_size_has_no_smallest_one() -> None:
    for law in (lambda size: 1e4, lambda size: 1e4 - 20 * size, lambda size: math.nan):
        views_at, looked = seen_as(law)
        assert size_of(views_at, 0.01, 5.0, 1) is None
        assert len(looked) <= 3


def test_sizes_that_hang_on_the_level_are_not_foretold(stated: Fit) -> None:
    """A stop or a cubic spring comes with a joint that gives way by itself: seen at any size of theirs."""
    known = available_effects()
    tried = [
        Hypothesis(known["cubic-root-stiffness"], {"side": "left"}),
        Hypothesis(known["control-surface-freeplay"], {"item": "flap-outer", "side": "left"}),
    ]
    for found in power(stated, tried):
        assert math.isnan(found.smallest)
        assert math.isnan(found.named)
        assert not found.visible
        assert not found.alike
        document = found.document()
        assert document["smallest"] is document["named"] is None
        assert document["reason"] == BY_LEVEL
        assert "by_level" not in document


def test_a_resonance_that_comes_into_the_band_is_seen(stated: Fit) -> None:
    """A spring's own surge: far above the band it is a square of its mass, and it is seen before that is enough."""
    surge = Hypothesis(available_effects()["suspension-surge"])
    (found,) = (p for p in power(stated, [surge]) if p.parameter == "mass_kg")
    sight = Sight.of(Stand.of(stated), noise_share(stated.problem.measured, stated.problem.split.train).worth)
    (mass,) = (p for p in surge.parameters if p.name == "mass_kg")

    def deviations(size: float) -> float:
        views = sight.at(surge, {**start_values(surge), "mass_kg": size}, mass)
        assert views is not None
        return least(views)

    assert deviations(found.smallest / 1.2) < 5.0
    assert 4.5 < deviations(found.smallest) < 8.0


class Standing:
    """A stand that leaves ``still`` deviations where the unknowns stand still, and ``followed`` where they follow."""

    def __init__(self, still: float, followed: float) -> None:
        self.fit = SimpleNamespace(points=2)
        self.still, self.followed = np.array([still, 0.0, 0.0]), np.array([followed, 0.0, 0.0])

    def change(self, *_: object) -> np.ndarray:
        return self.still

    def projected(self, change: np.ndarray) -> np.ndarray:
        return change

    def shown(self, *_: object) -> np.ndarray:
        return self.followed


@pytest.mark.parametrize(
    ("still", "followed", "promised", "seen"),
    [
        (5.02, 3.16, None, 3.16),  # what a slope has not foretold is no proof, though it is what is wanted
        (5.02, 3.16, 5.0, 5.02),
        (7.0, 3.16, 5.0, 3.16),
        (5.24, 9.4, None, 5.24),  # led astray
    ],
)
def test_the_unknowns_stand_still_only_where_a_slope_keeps_its_promise(
    still: float, followed: float, promised: float | None, seen: float
) -> None:
    alike = SimpleNamespace(deviations=lambda change: 2 * float(np.linalg.norm(change)))
    sight = Sight(Standing(still, followed), alike, 1.0)  # type: ignore[arg-type]
    mass = Hypothesis(available_effects()["added-mass"])
    views = sight.at(mass, {"mass_kg": 0.1}, mass.parameters[0], promised)
    assert views is not None
    assert least(views) == pytest.approx(seen)


@pytest.mark.slow
def test_what_a_tolerance_makes_up_for_wholly_is_not_visible_at_any_plausible_size(tmp_path: Path) -> None:
    """A beam's own inertia in pitch is an unknown: by modes as they were 0.09 of it seemed to show, it shows at 0.6."""
    beam = expected_fit(load_scenario("teaching-beam"), lines=60, cache=tmp_path)
    heavier = Hypothesis(available_effects()["section-cg-offset"], {"offset_m": 0.0})
    (found,) = power(beam, [heavier])
    assert found.parameter == "pitch_inertia_change"
    assert not found.visible
    assert math.isfinite(found.smallest)


def made(smallest: float, label: str, **more: object) -> Power:
    row = Power("local-absorber", label, "mass_kg", "kg", smallest, 1.5 * smallest, 0.02, 0.3, ())
    return dataclasses.replace(row, **more)


def test_rows_say_what_the_best_and_the_worst_place_show() -> None:
    places = [made(v, str(v)) for v in (4e-3, 6e-5, math.inf, 1e-3, math.nan)]
    (row,) = power_rows(places)
    assert (row.variant, row.smallest, row.named) == ("6e-05", 6e-5, 1.5 * 6e-5)
    assert (row.variants, row.median, row.worst, row.worst_variant) == (5, 4e-3, math.inf, "inf")
    assert row.sizes == ("6e-05", "9e-05", "never")
    assert (row.shows, row.reason) == ("yes", "")


def test_rows_without_any_size_say_why() -> None:
    for places, reason, shows in (
        ([made(math.nan, "a", by_level=True), made(math.inf, "b")], BY_LEVEL, "unknown"),
        ([made(math.inf, "a"), made(math.nan, "b")], NOT_KNOWN, "unknown"),
        ([made(math.inf, "a"), made(math.inf, "b")], NEVER, "no"),
    ):
        (row,) = power_rows(places)
        assert (row.reason, row.shows, row.visible) == (reason, shows, False)
        assert row.sizes[0] == reason.partition(":")[0]


def test_whatever_variant_looks_alike_is_hard_to_tell_apart() -> None:
    """The one that shows at the smallest size may be another."""
    twin = made(2e-3, "19+Z", alike=(("gain-drift", 1.0),), alike_variants=("gain-drift (19+Z)",))
    near = made(1e-3, "6+Z", alike=(("gain-drift", 0.7), ("added-mass", 0.8)), alike_variants=("a", "b"))
    (row,) = power_rows([near, twin])
    assert row.variant == "6+Z"
    assert row.alike == (("gain-drift", 1.0), ("added-mass", 0.8))
    first, second = confusable([near, twin])
    assert first == {
        "effects": ["gain-drift", "local-absorber"], "variants": ["gain-drift (19+Z)", "19+Z"], "cosine": 1.0
    }  # fmt: skip
    assert second["effects"] == ["added-mass", "local-absorber"]


def test_a_gain_and_its_drift_are_confused_where_sensors_rove(tmp_path: Path) -> None:
    scenario, known = roving_scenario(), available_effects()
    case = make_problem(campaign_of(scenario, 1), scenario, lines=60, cache=tmp_path)
    null = fit(case, (), np.zeros(case.size), np.zeros(0), ())
    tried = candidates(case, {name: known[name] for name in ("channel-gain", "gain-drift")})
    pairs = [pair["effects"] for pair in confusable(power(null, tried))]
    assert ["channel-gain", "gain-drift"] in pairs


def test_a_size_that_gets_a_name_is_one_that_a_fit_can_have(stated: Fit) -> None:
    """An absorber at the tip had its name from 0.26 g on, and no fit has less than 5.2 g."""
    absorber = Hypothesis(available_effects()["local-absorber"], {"x_m": 0.9, "y_m": 1.1})
    (mass,) = (p for p in absorber.parameters if p.name == "mass_kg")
    (found,) = (p for p in power(stated, [absorber]) if p.parameter == "mass_kg")
    least_kg, most_kg = (absorber.values(s * np.full(len(absorber.parameters), 1e3))["mass_kg"] for s in (-1, 1))
    assert found.named == pytest.approx(least_kg)
    assert absorber.values(absorber.scores({"mass_kg": found.named}))["mass_kg"] == pytest.approx(found.named)
    assert within_reach(absorber, mass, 2 * least_kg) == 2 * least_kg
    assert within_reach(absorber, mass, 1.01 * most_kg) == math.inf
    assert math.isnan(within_reach(absorber, mass, math.nan))


def test_a_document_says_why_there_is_no_name_and_what_was_held() -> None:
    document = made(1e-3, "tip", named=math.inf, at=(("frequency_hz", 12.0),)).document()
    assert (document["named"], document["reason"]) == (None, NEVER)
    assert document["at"] == {"frequency_hz": 12.0}
    assert made(1e-3, "tip", named=math.nan).document()["reason"] == NOT_KNOWN
    assert made(1e-3, "tip").document()["reason"] == ""
