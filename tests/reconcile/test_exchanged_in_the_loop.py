"""A search that has gone the wrong way first is put right: a wrong name gives way in the loop, with real fits."""

from __future__ import annotations

from pathlib import Path

import pytest
from gone_wrong import GoneWrong, Named
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import available_effects, make_effect
from vgvt.reconcile import Verdict, reconcile

LINES = 120
DAMPING, PLACE, GAIN, LABEL = 2.0, {"x_m": 0.886, "y_m": 1.113}, 0.1, "6+Z"
KNOWN = ("added-mass", "channel-gain", "nonproportional-damper")
A_MASS_FIRST = GoneWrong(
    Named("added-mass", {"mass_kg": 0.02, **PLACE}, {}),
    Named("nonproportional-damper", {"damping_n_s_per_m": 1.0, **PLACE}, {}),
    Named("channel-gain", {"gain_error": GAIN}, {"channels": LABEL}),
)


def verdict_of(monkeypatch: pytest.MonkeyPatch, folder: Path, *, exchanging: bool) -> Verdict:
    """The verdict on a damper and a gain where the first search has gone wrong."""
    A_MASS_FIRST.first(monkeypatch, exchanging=exchanging)
    damper = make_effect("nonproportional-damper", "test", damping_n_s_per_m=DAMPING, **PLACE)
    gain = make_effect("channel-gain", "test", gain_error=GAIN, channels=LABEL)
    campaign = campaign_of(roving_scenario(), 3, damper, gain)
    effects = {n: c for n, c in available_effects().items() if n in KNOWN}
    return reconcile(campaign, roving_scenario(), effects=effects, lines=LINES, folder=folder, most=2, with_tests=False)


@pytest.mark.slow
def test_a_wrong_name_gives_way(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    verdict = verdict_of(monkeypatch, tmp_path, exchanging=True)
    found = {e.name: e for e in verdict.effects}
    assert set(found) == {"nonproportional-damper", "channel-gain"}, verdict
    damping, sd, _ = found["nonproportional-damper"].parameters["damping_n_s_per_m"]
    assert abs(damping - DAMPING) < 4 * sd
    assert found["channel-gain"].parameters["gain_error"][0] == pytest.approx(GAIN, abs=0.01)


@pytest.mark.slow
def test_without_that_it_is_no_answer(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    verdict = verdict_of(monkeypatch, tmp_path, exchanging=False)
    assert "nonproportional-damper" not in {e.name for e in verdict.effects}
