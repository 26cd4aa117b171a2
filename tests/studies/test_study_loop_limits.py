"""The study's sizes against the limit of the aircraft that they were found on, not of the nominal one."""

from __future__ import annotations

import loop_cases
import loop_results
import numpy as np
import pytest
from loop_limits import own_ratio

from vgvt.effects import available_effects
from vgvt.reconcile.fitting.fit import fit
from vgvt.reconcile.next_test.power import power
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.candidates import candidates


def test_a_size_is_held_against_the_limit_of_its_own_aircraft() -> None:
    """Where a fit that is told the truth has the aircraft: a root's torsion hides where its mode leaves the band."""
    nominal = loop_cases.expected(0.01)
    creep = {"side": "left", "shape": "step", "from_run": 5}
    share = candidates(nominal.problem, {"root-creep": available_effects()["root-creep"]})[0].share
    limits = power(nominal, [Hypothesis(available_effects()["root-creep"], creep, share)])
    named = next(p.named for p in limits if p.parameter == "torsion")
    truth = {"root-creep": {**creep, "torsion": 2 * named}}
    assert own_ratio(nominal, truth) == pytest.approx(2.0, rel=1e-6)
    stiffer = nominal.u.copy()
    stiffer[[k.name for k in nominal.problem.unknowns].index("GJ wing")] = 3.0
    elsewhere = own_ratio(fit(nominal.problem, (), stiffer, np.zeros(0), ()), truth)
    assert elsewhere is not None and abs(elsewhere - 2.0) > 0.1
    assert own_ratio(nominal, {"sign-flip": {"channels": "sensor-1"}}) is None


def test_truths_above_the_limit_of_their_own_aircraft_are_counted_by_themselves() -> None:
    row = {"group": "effect", "verdict": "explained", "truth": "a", "named": "a", "ratio": 1.0, "held_after": 1.0}
    row |= {"core": "c", "answer": "right"}
    unlucky = row | {"verdict": "adequate", "named": "", "answer": "nothing"}
    said = loop_results.headline([row | {"own_ratio": 1.2}, unlucky | {"own_ratio": 0.5}, row, unlucky])
    assert "above the limit | ≥ 95 % | 2 of 4, " in said
    assert "| … of those whose own aircraft's limit is known, above that | ≥ 95 % | 1 of 1, " in said
