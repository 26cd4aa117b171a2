"""An aircraft with every unknown at its score is that of one edit after the other, and leaves the stated one alone."""

from __future__ import annotations

import numpy as np
import pytest
from reconciled_case import roving_scenario

from vgvt.reconcile.question.uncertain import edited, prepared, unknowns
from vgvt.scenario.write import to_toml
from vgvt.simulation.reduced import Layouts, structure


def test_all_unknowns_at_once_are_each_after_the_other() -> None:
    scenario = roving_scenario()
    known, stated = unknowns(scenario), to_toml(prepared(scenario))
    scores = np.random.default_rng(3).normal(size=len(known))
    scores[::7] = 0.0
    single = prepared(scenario)
    for unknown, u in zip(known, scores, strict=True):
        single = unknown.edit(single, unknown.amount(float(u)))
    together = edited(scenario, known, scores)
    for one, other in zip(single.airframe.beam, together.airframe.beam, strict=True):
        for name in type(one.stations).model_fields:
            expected = getattr(one.stations, name)
            if expected is None:
                assert getattr(other.stations, name) is None
            else:
                assert np.array(getattr(other.stations, name)) == pytest.approx(np.array(expected), rel=1e-13)
    beams = {"beam": single.airframe.beam}
    rest = together.model_copy(update={"airframe": together.airframe.model_copy(update=beams)})
    assert to_toml(rest) == to_toml(single)
    assert to_toml(prepared(scenario)) == stated == to_toml(edited(scenario, known, np.zeros(len(known))))


def test_rigs_of_one_airframe_share_it_and_differ_as_they_should() -> None:
    """A structure beside others of the same airframe is what it is alone, whichever was asked for first."""
    scenario = prepared(roving_scenario())
    spring = scenario.suspension
    softer = scenario.model_copy(
        update={"suspension": spring.model_copy(update={"stiffness_n_per_m": 0.8 * spring.stiffness_n_per_m})}
    )
    layouts = Layouts.of(scenario)
    plans = [layouts.plan(s) for s in (scenario, softer, scenario)]
    first, second, again = (structure(p, p.grid) for p in plans)
    assert np.array_equal(first.stiffness, again.stiffness) and np.array_equal(first.damping, again.damping)
    heave = first.stiffness[2, 2]
    assert second.stiffness[2, 2] == pytest.approx(heave - 0.2 * spring.stiffness_n_per_m, rel=0.02)
    assert np.diag(second.damping)[6:] == pytest.approx(np.diag(first.damping)[6:], rel=1e-3)
