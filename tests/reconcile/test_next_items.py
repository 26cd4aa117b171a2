"""From where a fit of a loose flap arrived, the flaps next to it."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import drawn_scores, problem

from vgvt.effects import available_effects
from vgvt.effects.control_surface import ControlSurface
from vgvt.reconcile.fitting.fit import FAR, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.search import next_items
from vgvt.reconcile.search.candidates import candidates, freed
from vgvt.reconcile.search.from_stated import _sizes
from vgvt.reconcile.search.next_items import at_next_items
from vgvt.reconcile.search.scan import in_band, tuned_alike, where_it_swings
from vgvt.reconcile.work.progress import silent

TRUE: dict[str, Any] = {"item": "flap-middle", "side": "left"}
LOOSE = ControlSurface(compliance_rad_per_n_m=1.5, damping_ratio=0.09, **TRUE)


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return problem(tmp_path_factory.mktemp("cache"), 1, LOOSE)


@pytest.fixture(scope="module")
def offered(case: Problem) -> tuple[Hypothesis, ...]:
    return candidates(case, {"control-surface": ControlSurface})


def of(offered: tuple[Hypothesis, ...], item: str, side: str = "left") -> Hypothesis:
    return next(h for h in offered if h.settings == {"item": item, "side": side})


def hertz(case: Problem, hypothesis: Hypothesis, values: dict[str, float]) -> float:
    """Of a flap on a fixed wing, its own inertia about a spanwise hinge being Iyy, or nearly."""
    names = (hypothesis.settings["item"], f"{hypothesis.settings['item']}-{hypothesis.settings['side']}")
    item = next(i for i in case.scenario.airframe.item if i.name in names)
    inertia = item.mass_kg * values["arm_m"] ** 2 + item.inertia_kg_m2[1]
    return 1 / math.sqrt(values["compliance_rad_per_n_m"] * inertia) / (2 * math.pi)


def test_another_item_swings_as_fast(case: Problem, offered: tuple[Hypothesis, ...]) -> None:
    one, other = of(offered, "flap-outer"), of(offered, "servo-inner")
    values = {"compliance_rad_per_n_m": 4.0, "arm_m": 0.02, "damping_ratio": 0.05}
    alike = tuned_alike(case, one, values, other)
    assert alike is not None and {k: v for k, v in alike.items() if k[0] != "c"} == {
        "arm_m": 0.02, "damping_ratio": 0.05,
    }  # fmt: skip
    assert alike["compliance_rad_per_n_m"] != pytest.approx(4.0, rel=1e-3)
    assert hertz(case, other, alike) == pytest.approx(hertz(case, one, values), rel=0.02)
    # No further than what is plausible.
    softer = tuned_alike(case, one, {**values, "compliance_rad_per_n_m": 1000.0}, other)
    assert softer is not None and softer["compliance_rad_per_n_m"] == 100.0


def test_from_the_stated_values_a_flap_is_looked_for_all_over_the_band(
    case: Problem, offered: tuple[Hypothesis, ...]
) -> None:
    """Three large sizes of it had it swing between 3 and 7 Hz."""
    flap, band = of(offered, "flap-middle"), case.measured.frequency_hz
    hz = np.sort([hertz(case, flap, s) for s in in_band(case, flap)])
    assert hz[0] < 1.3 * band[0] and hz[-1] > 0.9 * band[-1]
    assert np.diff(np.log(hz)).max() < 0.3
    found: Any = SimpleNamespace(problem=case)
    assert len(_sizes(found, flap)) == hz.size
    root = Hypothesis(available_effects()["root-compliance"], {"side": "both"})
    assert in_band(case, root) == () and len(_sizes(found, root)) > 3
    absorber = Hypothesis(available_effects()["local-absorber"], {"x_m": 0.7, "y_m": 0.5})
    assert in_band(case, absorber) == ()


def test_a_thing_on_both_sides_swings_at_two_places(case: Problem, offered: tuple[Hypothesis, ...]) -> None:
    left, right, both = (where_it_swings(case, of(offered, "flap-middle", side)) for side in ("left", "right", "both"))
    assert len(left) == len(right) == 1 and set(both) == {*left, *right}
    assert left[0][1] < 0 < right[0][1]


MASS = available_effects()["added-mass"]
ABSORBER = available_effects()["local-absorber"]
SWINGING = {"mass_kg": 0.05, "frequency_hz": 12.0, "damping_ratio": 0.04}


def test_an_absorber_where_an_item_is_may_be_that_item(
    case: Problem, offered: tuple[Hypothesis, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of items within 0.3 m the nearest first, as fast as the absorber, with its damping; else, or unasked, none."""
    (item,) = where_it_swings(case, of(offered, "flap-middle"))
    tried: list[tuple[Hypothesis, dict[str, float]]] = []
    monkeypatch.setattr(
        next_items, "_fitted_there", lambda f, hypothesis, values, t: tried.append((hypothesis, values))
    )

    def absorber(x_m: float, y_m: float, evidence_nats: float = 50.0) -> Any:
        freed = Hypothesis(ABSORBER, {})
        told = {n: (v, 0.0, "") for n, v in {**SWINGING, "x_m": x_m, "y_m": y_m}.items()}
        return SimpleNamespace(
            problem=case, hypotheses=(freed,), evidence_nats=evidence_nats, values=lambda k: told
        )  # fmt: skip

    current: Any = SimpleNamespace(evidence_nats=0.0)
    near = absorber(item[0] + 0.01, item[1])
    assert at_next_items(current, [near], offered, silent) == [] and not tried
    at_next_items(current, [near], offered, silent, placed=True)
    assert {(h.settings["item"], h.settings["side"]) for h, _ in tried[:2]} == {
        ("flap-middle", "left"), ("flap-middle", "both"),
    }  # fmt: skip
    assert 2 <= len(tried) <= 4
    for h, values in tried:
        assert min(math.dist(item, place) for place in where_it_swings(case, h)) < 0.31
        assert values["damping_ratio"] == SWINGING["damping_ratio"]
        assert hertz(case, of(offered, h.settings["item"]), values) == pytest.approx(12.0, rel=0.03)
    tried.clear()
    at_next_items(current, [absorber(0.1, 0.0)], offered, silent, placed=True)
    mass: Any = SimpleNamespace(problem=case, hypotheses=(Hypothesis(MASS, {}),), evidence_nats=1000.0)
    at_next_items(current, [near, mass], offered, silent, placed=True)
    assert not tried, "there is no item there, and what gains little beside another effect is not worth the walk"
    # An item keeps its walk beside an absorber that is ahead of it and near none.
    told = {name: (value, 0.0, "") for name, value in size().items()}
    wrong: Any = SimpleNamespace(
        problem=case, hypotheses=(of(offered, "servo-middle"),), evidence_nats=40.0, values=lambda k: told
    )
    at_next_items(current, [wrong, absorber(0.1, 0.0)], offered, silent, placed=True)
    assert TRUE in [h.settings for h, _ in tried]


@pytest.mark.parametrize(("rough", "begun"), [(1.0, "overlapping"), (9.0, "arrived")])
def test_another_effect_begins_where_peaks_overlap_if_that_is_nearer(
    case: Problem, offered: tuple[Hypothesis, ...], monkeypatch: pytest.MonkeyPatch, rough: float, begun: str
) -> None:
    """The same effect at the next item goes on from where the fit arrived, as its unknowns are right there."""
    monkeypatch.setattr(next_items, "rough_start", lambda problem, hypotheses, e: ("overlapping", e))
    monkeypatch.setattr(
        next_items, "cost_at", lambda problem, hypotheses, u, e: {"overlapping": rough, "arrived": 5.0}[u]
    )
    monkeypatch.setattr(next_items, "fit", lambda problem, hypotheses, u, e, stages, tell: u)

    def arrived(hypothesis: Hypothesis) -> Any:
        scores = np.zeros(len(hypothesis.parameters))
        return SimpleNamespace(problem=case, hypotheses=(hypothesis,), u="arrived", e=scores)

    flap = of(offered, "flap-middle")
    assert next_items._fitted_there(arrived(Hypothesis(ABSORBER, {})), flap, size(), silent) == begun
    assert next_items._fitted_there(arrived(of(offered, "flap-outer")), flap, size(), silent) == "arrived"


@pytest.mark.slow
def test_from_an_absorber_the_loose_item_is_found(case: Problem, offered: tuple[Hypothesis, ...]) -> None:
    u = drawn_scores(case, 1)
    null = fit(case, (), u, np.zeros(0), ())
    (item,) = where_it_swings(case, of(offered, "flap-middle"))
    hypothesis = freed(Hypothesis(ABSORBER, {"x_m": item[0] + 0.05, "y_m": item[1] - 0.05}))
    start = {"mass_kg": 0.04, "frequency_hz": hertz(case, of(offered, "flap-middle"), size()), "damping_ratio": 0.05}
    begun = hypothesis.scores({**start, "x_m": item[0] + 0.05, "y_m": item[1] - 0.05})
    arrived = fit(case, (hypothesis,), u, begun, FAR)
    best = max(at_next_items(null, [arrived], offered, silent, placed=True), key=lambda f: f.evidence_nats)
    assert best.hypotheses[-1].settings == TRUE
    assert best.evidence_nats > arrived.evidence_nats + 10
    assert best.chi2_per_dof < 1.2


@pytest.mark.slow
def test_from_a_neighbour_the_loose_one_is_found(case: Problem, offered: tuple[Hypothesis, ...]) -> None:
    u = drawn_scores(case, 1)
    null = fit(case, (), u, np.zeros(0), ())
    wrong = of(offered, "servo-middle")
    near = wrong.scores(tuned_alike(case, Hypothesis(ControlSurface, TRUE), size(), wrong) or {})
    arrived = fit(case, (wrong,), u, near, FAR)
    more = at_next_items(null, [arrived], offered, silent)
    best = max(more, key=lambda f: f.evidence_nats)
    assert best.hypotheses[-1].settings == TRUE
    assert best.evidence_nats > arrived.evidence_nats + 10
    assert best.chi2_per_dof < 1.2
    elsewhere = [f.hypotheses[-1].settings for f in more if f.hypotheses[-1].settings["side"] != "left"]
    assert {"item": "servo-middle", "side": "right"} in elsewhere
    assert {f["item"] for f in elsewhere} <= {"servo-middle", "flap-middle"}, "of what did best, and nothing else"


def size() -> dict[str, float]:
    return {"compliance_rad_per_n_m": 1.5, "arm_m": 0.03, "damping_ratio": 0.09}


def test_it_walks_on_while_the_next_one_does_better_and_repeats_nothing(
    case: Problem, offered: tuple[Hypothesis, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    worth = {"winglet": 0.0, "flap-outer": 50.0, "servo-outer": 30.0, "flap-middle": 80.0}

    def made(hypothesis: Hypothesis) -> Any:
        nats = worth.get(hypothesis.settings["item"], 10.0) - (hypothesis.settings["side"] != "left")
        told = {name: (value, 0.0, "") for name, value in size().items()}
        return SimpleNamespace(problem=case, hypotheses=(hypothesis,), evidence_nats=nats, values=lambda k: told)

    asked: list[tuple[str, str]] = []

    def there(found: Any, hypothesis: Hypothesis, values: Any, tell: Any) -> Any:
        tell(1.0, "there")
        asked.append((hypothesis.settings["item"], hypothesis.settings["side"]))
        return made(hypothesis)

    monkeypatch.setattr(next_items, "_fitted_there", there)
    current: Any = SimpleNamespace(evidence_nats=-100.0)
    start = [made(of(offered, "winglet")), made(of(offered, "servo-outer"))]
    fractions: list[float] = []
    more = at_next_items(current, start, offered, lambda fraction, message: fractions.append(fraction))
    assert fractions == sorted(fractions) and fractions[-1] <= 1.0
    assert len(asked) == len(set(asked)) and not {("winglet", "left"), ("servo-outer", "left")} & set(asked)
    assert ("flap-middle", "left") in asked, "reached by way of what is next to the first one"
    assert ("flap-middle", "right") in asked, "a side is no item"
    assert len(more) == len(asked)
    # What gains little beside another effect is not worth the walk, and what is no item has none.
    mass: Any = SimpleNamespace(hypotheses=(Hypothesis(available_effects()["added-mass"], {}),), evidence_nats=1000.0)
    assert at_next_items(current, [*start, mass], offered, silent) == []
    assert at_next_items(current, [mass], offered, silent) == []
