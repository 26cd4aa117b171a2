"""A small campaign with known truth: Hati with twelve links a wing, solved exactly, drawn from the tolerances."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from vgvt.data import Campaign
from vgvt.effects import Effect, available_effects
from vgvt.effects.conformance import table_of
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.next_test.checks import Check, checks
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, Problem, make_problem
from vgvt.reconcile.question.uncertain import edited, unknowns
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import simulated_campaign


def small_scenario() -> Scenario:
    """The bundled quick scenario, smaller still."""
    whole = load_scenario("quick")
    wing = whole.airframe.beam[0].model_copy(update={"cells": 12})
    changes = {
        "airframe": whole.airframe.model_copy(update={"beam": (wing,)}),
        "acquisition": whole.acquisition.model_copy(update={"sample_rate_hz": 200.0}),
        "tolerances": whole.tolerances.model_copy(update={"segments": 0}),
    }
    return whole.model_copy(update=changes)


def roving_scenario() -> Scenario:
    """The small scenario with five accelerometers that rove over its points in four runs."""
    whole = small_scenario()
    runs = tuple(tuple(range(k, 21, 4)) for k in (1, 2, 3, 4))
    return whole.model_copy(update={"acquisition": whole.acquisition.model_copy(update={"runs": runs})})


def campaign_of(scenario: Scenario, seed: int, *effects: Effect) -> Campaign:
    """A campaign whose truth is drawn from the scenario's tolerances, with effects."""
    known = unknowns(scenario)
    drawn = np.random.default_rng(seed).standard_normal(len(known))
    truth = edited(scenario, known, drawn)
    truth = truth.model_copy(update={"seed": seed, "effect": tuple(table_of(e) for e in effects)})
    return simulated_campaign(truth, engine="linear")


def problem(cache: Path, seed: int, *effects: Effect) -> Problem:
    """The reconciliation of such a campaign with the scenario as stated."""
    scenario = small_scenario()
    return make_problem(campaign_of(scenario, seed, *effects), scenario, lines=200, cache=cache)


def roving_problem(cache: Path, lines: int) -> Problem:
    """The reconciliation of a campaign of four runs with five roving sensors with the scenario as stated."""
    scenario = roving_scenario()
    return make_problem(campaign_of(scenario, 1), scenario, lines=lines, cache=cache)


def check(case: Problem, words: str) -> Check:
    """The one reading off the rig whose words hold these."""
    (found,) = (c for c in checks(case) if words in c.words)
    return found


def claimed(case: Problem, name: str, values: dict[str, float], **settings: Any) -> Fit:
    """An effect of a given size beside the stated values, as if it had been fitted."""
    hypothesis = Hypothesis(available_effects()[name], settings)
    return fit(case, (hypothesis,), np.zeros(case.size), hypothesis.scores(values), ())


def drawn_scores(case: Problem, seed: int) -> np.ndarray:
    """The scores that a campaign of a seed was drawn with: its chain is as coarse as the scenario says."""
    count = len(case.unknowns) - 1
    scores = np.zeros(case.size)
    scores[:count] = np.random.default_rng(seed).standard_normal(count)
    scores[case.unknowns.index(CELLS)] = -3 / CELLS.sd  # as near to -1 as makes no difference
    return scores


def without_instrument_noise(scenario: Scenario) -> Scenario:
    """The scenario with instruments that add nothing."""
    clean = {"noise": None}
    changes = {
        "accelerometers": scenario.accelerometers.model_copy(update=clean),
        "transducer": scenario.transducer.model_copy(update=clean),
        "acquisition": scenario.acquisition.model_copy(update={"noise_v_per_rthz": 0.0, "bits": 32}),
    }
    return scenario.model_copy(update=changes)
