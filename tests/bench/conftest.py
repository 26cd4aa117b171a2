"""Small benches: one light scenario, entries that do not depend on the real identifiers."""

from __future__ import annotations

import pytest

from vgvt.scenario import load_scenario


@pytest.fixture(scope="session")
def light_scenario():
    """``quick`` with the linear engine and a short record."""
    scenario = load_scenario("quick")
    simulation = scenario.simulation.model_copy(update={"engine": "linear"})
    return scenario.model_copy(update={"simulation": simulation})
