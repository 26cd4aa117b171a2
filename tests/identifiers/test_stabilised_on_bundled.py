"""Bundled scenarios: `auto` on all, pLSCF and the subspace method on one: every true mode in reach, and no other."""

from __future__ import annotations

from dataclasses import replace

import pytest

from vgvt.identification import make_identifier, run_identifier
from vgvt.scenario import bundled_scenarios, load_scenario
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


@pytest.mark.parametrize("name", bundled_scenarios())
def test_auto_finds_what_the_excitation_reaches_and_nothing_else(name: str) -> None:
    """What is in reach the score tells by information; a campaign of many runs is thinned to a dozen."""
    result = simulate(load_scenario(name), engine="linear")
    runs = result.campaign.runs
    campaign = replace(result.campaign, runs=runs[:: max(1, len(runs) // 12)])
    card = score(result.truth, run_identifier(make_identifier("auto"), campaign), campaign.band_hz)
    assert (card.missed, card.false) == (0, 0), [(m.status, m.true_hz, m.claimed_hz) for m in card.modes]
    assert card.found > 0
    if name == "garteur-sm-ag19":
        torsion = [m.claimed_hz for m in card.modes if m.true_hz and 32 < m.true_hz < 34]
        assert len(torsion) == 2, "the antisymmetric and the symmetric torsion, less than 1 % apart"
