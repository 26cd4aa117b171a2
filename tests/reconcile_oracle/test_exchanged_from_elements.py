"""A search gone wrong is put right with data from finite elements that share no code with the analysis, too."""

from __future__ import annotations

import json
from pathlib import Path

import catalogue_twins as twins
import pytest
import second_laboratory as lab
from gone_wrong import GoneWrong, Named
from test_nameless_things import roving

from vgvt.effects import available_effects
from vgvt.reconcile import Verdict, reconcile

MASS_KG, GAIN, LABEL, NODE = 0.06, 0.12, "6+Z", 18
KNOWN = ("added-mass", "channel-gain", "nonproportional-damper")


def verdict_on_elements(monkeypatch: pytest.MonkeyPatch, folder: Path, *, exchanging: bool) -> Verdict:
    """The verdict on a mass and a gain where a damper was named first in the mass's place."""
    x, y = lab.place(roving(20), NODE)
    wrong = GoneWrong(
        Named("nonproportional-damper", {"damping_n_s_per_m": 1.0, "x_m": x, "y_m": y}, {}),
        Named("added-mass", {"mass_kg": 0.01, "x_m": x, "y_m": y}, {}),
        Named("channel-gain", {"gain_error": GAIN}, {"channels": LABEL}),
    )
    wrong.first(monkeypatch, exchanging=exchanging)
    campaign = lab.campaign_of(roving(8), (twins.added_mass(MASS_KG, x, y), twins.channel_gain((6,), GAIN)))
    effects = {n: c for n, c in available_effects().items() if n in KNOWN}
    return reconcile(campaign, roving(20), effects=effects, lines=160, folder=folder, most=2, with_tests=False)


@pytest.mark.slow
def test_a_mass_takes_the_place_of_the_damper_that_was_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    verdict = verdict_on_elements(monkeypatch, tmp_path, exchanging=True)
    found = {e.name: e for e in verdict.effects}
    assert set(found) == {"added-mass", "channel-gain"}, verdict
    mass, sd, _ = found["added-mass"].parameters["mass_kg"]
    assert abs(mass - MASS_KG) < max(4 * sd, 0.1 * MASS_KG)
    assert found["channel-gain"].parameters["gain_error"][0] == pytest.approx(GAIN, abs=0.01)
    kept = json.loads((tmp_path / "rounds-exchanged.json").read_text(encoding="utf-8"))
    winners = [row["rivals"][row["winner"]]["effects"][-1]["name"] for row in kept["rounds"]]
    assert set(winners) == {"added-mass", "channel-gain"}


@pytest.mark.slow
def test_nothing_else_puts_it_right(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    verdict = verdict_on_elements(monkeypatch, tmp_path, exchanging=False)
    assert "added-mass" not in {e.name for e in verdict.effects}
