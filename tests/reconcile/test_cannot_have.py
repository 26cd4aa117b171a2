"""Effects that an aircraft or its rig cannot have are no candidates, and are told as a simulation refuses them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from vgvt.data import InputError
from vgvt.effects import available_effects
from vgvt.effects.parameter import parameters_of
from vgvt.reconcile.search.candidates import candidates, cannot_have
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation.assembly import plan, plans

ON_THE_WING = {"base-strain", "stinger-moment"}


def asked_of(scenario: Scenario) -> Any:
    """As much of a problem as candidates follow from."""
    measured = SimpleNamespace(runs=scenario.acquisition.run_nodes, run_numbers=())
    return SimpleNamespace(scenario=scenario, measured=measured, layouts=SimpleNamespace(first=plan(scenario)))


@pytest.mark.parametrize(
    ("name", "without"),
    [
        ("hati-unsymmetric", set()),
        ("bff", set()),
        # The wing goes through from tip to tip, on a mount: beams of the body are that, nose and tail.
        ("garteur-sm-ag19", ON_THE_WING | {"carry-through-torsion", "entrained-air", "stiffness-asymmetry"}),
    ],
)
def test_what_a_simulation_would_refuse_is_no_candidate(name: str, without: set[str]) -> None:
    problem = asked_of(load_scenario(name))
    found = cannot_have(problem)
    assert set(found) == without
    offered = {h.name for h in candidates(problem)}
    assert not offered & without
    assert "root-compliance" in offered
    for effect, why in found.items():
        assert refusal(problem.scenario, effect) == why.problem
    assert refusal(problem.scenario, "root-compliance") is None


def refusal(scenario: Scenario, effect: str) -> str | None:
    """What a simulation says of a sizeable effect with the settings that it has by itself."""
    sizes = {p.name: p.at(0.75) for p in parameters_of(available_effects()[effect])}
    try:
        plans(scenario.model_copy(update={"effect": (EffectTable(name=effect, **sizes),)}))
    except InputError as error:
        return error.problem
    return None
