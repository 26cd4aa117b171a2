"""Methods without the force on a shaker: right about shaker and aircraft together, and told what that is worth."""

from __future__ import annotations

import pytest

from vgvt.data import Campaign, TrueModes, Truth
from vgvt.identification import make_identifier, run_identifier
from vgvt.scenario import Excitation, load_scenario
from vgvt.simulation import simulate
from vgvt_scoreboard import score


@pytest.fixture(scope="module")
def tested() -> tuple[Campaign, Truth]:
    """The quick wing, all points at once, under two minutes of random noise from the shaker."""
    quick = load_scenario("quick")
    nodes = tuple(node for run in quick.acquisition.runs for node in run)
    level = 0.5 * quick.excitation.amplitude_v
    noise = Excitation(kind="random", start_hz=2.0, stop_hz=50.0, duration_s=120.0, amplitude_v=level, taper_s=0.5)
    together = quick.acquisition.model_copy(update={"repeats": 1, "runs": (nodes,)})
    result = simulate(quick.model_copy(update={"acquisition": together, "excitation": noise}), engine="linear")
    return result.campaign, result.truth


@pytest.mark.parametrize("name", ["ssi-cov", "cfdd-output-only"])
def test_their_uncertainty_is_of_what_they_could_find(tested: tuple[Campaign, Truth], name: str) -> None:
    campaign, truth = tested
    claim = run_identifier(make_identifier(name), campaign, (3.0, 48.0))
    card = score(truth, claim, (4.0, 40.0))
    assert card.true_modes is TrueModes.COUPLED
    assert (card.found, card.missed, card.false) == (3, 0, 0)
    assert all(row.frequency_covered and row.damping_covered for row in card.modes)
    first = card.modes[0]
    assert first.label == "1st symmetric bending"
    # The shaker stiffens the first bending by 5 % and damps it nearly four times as much, whatever the method.
    assert first.true_hz == pytest.approx(8.56, abs=0.05)
    assert first.as_tested_hz == pytest.approx(8.14, abs=0.05)
    assert first.true_damping_ratio / first.as_tested_damping_ratio == pytest.approx(3.8, abs=0.2)
    assert any("error of the procedure" in remark for remark in card.remarks)
    assert any("the force is not used" in line for line in card.advice)
