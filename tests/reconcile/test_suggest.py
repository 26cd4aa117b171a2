"""Two explanations that one campaign cannot tell apart: the first test that is suggested, once made, tells them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from added_noise import Noise
from reconciled_case import drawn_scores, small_scenario, without_instrument_noise

from vgvt.data import Campaign
from vgvt.effects import available_effects
from vgvt.effects.conformance import table_of
from vgvt.reconcile import Kind, reconcile
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.next_test.checks import checks, foretold, log_density, seen
from vgvt.reconcile.next_test.procedures import procedures
from vgvt.reconcile.next_test.suggest import suggest
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.question.thresholds import stored_thresholds
from vgvt.reconcile.question.uncertain import edited, unknowns
from vgvt.scenario import Scenario
from vgvt.simulation import simulated_campaign

SEED, MASS_KG = 5, 0.05


def recorded(scenario: Scenario, seed: int) -> Campaign:
    """A campaign with a mass at the first drive point, whatever the procedure."""
    known = available_effects()
    x, y, _ = small_scenario().shaker.position_m
    stated = small_scenario()
    truth = np.random.default_rng(SEED).standard_normal(len(unknowns(stated)))
    made = known["added-mass"](mass_kg=MASS_KG, x_m=x, y_m=y)
    true = without_instrument_noise(edited(scenario, unknowns(stated), truth))
    true = true.model_copy(update={"effect": (table_of(made),)})
    return Noise(0.01, False).on(simulated_campaign(true, engine="linear"), np.random.default_rng(seed))


def rivals(case: Problem) -> tuple[Fit, Fit]:
    """A mass where the shaker pushes, and one below the force gauge, which is there too."""
    known = available_effects()
    x, y, _ = small_scenario().shaker.position_m
    names = (("added-mass", {"x_m": x, "y_m": y}), ("transducer-mass", {}))
    found = []
    for name, settings in names:
        hypothesis = Hypothesis(known[name], settings)
        size = hypothesis.size
        assert size is not None
        start = hypothesis.scores({size.name: MASS_KG})
        found.append(fit(case, (hypothesis,), drawn_scores(case, SEED), start, NEAR))
    return found[0], found[1]


@pytest.mark.slow
def test_the_first_suggestion_resolves_a_pair_that_explains_alike(tmp_path: Path) -> None:
    scenario = small_scenario()
    case = make_problem(recorded(scenario, 1), scenario, lines=120, cache=tmp_path)
    one, other = rivals(case)
    assert abs(one.evidence_nats - other.evidence_nats) < stored_thresholds().set_nats
    told = suggest([one, other], count=5)
    assert told[0].nats > stored_thresholds().set_nats
    # A scale tells them within minutes; here the best of the changed campaigns is made besides.
    reading = next(c for c in checks(case) if c.words == told[0].test)
    x, y, _ = scenario.shaker.position_m
    made = reading.read(seen(scenario, [available_effects()["added-mass"](mass_kg=MASS_KG, x_m=x, y_m=y)]))
    laws = [foretold(f, reading) for f in (one, other)]
    right, wrong = (log_density(made, *law) for law in laws if law is not None)
    assert right - wrong > stored_thresholds().set_nats
    known = {p.words: p for p in procedures(case)}
    first = next(t for t in told if t.test in known)
    procedure = known[first.test]
    changed = procedure.edit(scenario)
    again = make_problem(recorded(changed, 2), changed, lines=120, cache=tmp_path)
    better, worse = rivals(again)
    # The unknowns start from their tolerances again: what the first campaign knew of them would only help.
    assert better.evidence_nats - worse.evidence_nats > stored_thresholds().set_nats, first


@pytest.mark.slow
def test_two_names_for_the_same_thing_are_ambiguous_and_no_test_is_promised() -> None:
    scenario = small_scenario()
    one = available_effects()["transducer-mass"]
    twin = type("Twin", (one,), {"name": "twin-of-it", "__doc__": one.__doc__})
    found = reconcile(
        recorded(scenario, 1), scenario, effects={"transducer-mass": one, "twin-of-it": twin}, lines=120, most=1
    )
    assert found.kind is Kind.AMBIGUOUS, found.reasons
    (effect,) = found.effects
    assert {effect.name, *effect.equivalent} == {"transducer-mass", "twin-of-it"}
    assert any("the data as well" in reason for reason in found.reasons)
    assert all(test.nats < stored_thresholds().set_nats for test in found.suggested_tests)
    assert any(reason.startswith("None of the tests") for reason in found.reasons)
