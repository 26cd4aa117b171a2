"""pLSCF and the subspace method on a bundled scenario: every true mode, no other, and every pole explained."""

from __future__ import annotations

import pytest

from vgvt.identification import make_identifier, run_identifier
from vgvt.scenario import load_scenario
from vgvt.simulation import simulate
from vgvt.simulation.campaign import SimulationResult
from vgvt_scoreboard import score

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def quick() -> SimulationResult:
    return simulate(load_scenario("quick"), engine="linear")


@pytest.mark.parametrize("name", ["plscf", "subspace"])
def test_the_modes_of_quick(quick: SimulationResult, name: str) -> None:
    claim = run_identifier(make_identifier(name), quick.campaign)
    card = score(quick.truth, claim, quick.campaign.band_hz)
    assert (card.missed, card.false) == (0, 0)
    for row in card.modes:
        assert abs(row.frequency_error_percent or 100.0) < 0.1
        assert abs(row.damping_error_percent or 100.0) < 5.0
        assert (row.mac or 0.0) > 0.99
    assert any(c.kept for c in claim.candidates)
