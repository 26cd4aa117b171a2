"""A search gone wrong is put right with data from finite elements that share no code with the analysis, too."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import catalogue_twins as twins
import numpy as np
import pytest
import second_laboratory as lab
from test_nameless_things import roving

from vgvt.effects import available_effects
from vgvt.reconcile import Verdict, reconcile, searches
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.evidence.rivals import Rival, against
from vgvt.reconcile.fitting.fit import FAR, Fit, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import Thresholds

MASS_KG, GAIN, LABEL, NODE = 0.06, 0.12, "6+Z", 18
NAMES = ("added-mass", "channel-gain", "nonproportional-damper")
KNOWN = {name: available_effects()[name] for name in NAMES}


def one_more(current: Fit, name: str, settings: dict[str, Any], values: dict[str, float]) -> Rival:
    """A fit with one effect more, as a rival."""
    hypothesis = Hypothesis(KNOWN[name], settings)
    start = np.concatenate([current.e, hypothesis.scores(values)])
    return against(current, [fit(current.problem, (*current.hypotheses, hypothesis), current.u, start, FAR)])[0]


def a_damper_first(start: Fit, thresholds: Thresholds) -> Attribution:
    """A damper named where the mass sits, beside which the gain has its name: the mass had convinced, too."""
    x, y = lab.place(start.problem.scenario, NODE)
    damper = one_more(start, "nonproportional-damper", {}, {"damping_n_s_per_m": 1.0, "x_m": x, "y_m": y})
    mass = one_more(start, "added-mass", {}, {"mass_kg": 0.01, "x_m": x, "y_m": y})
    gain = one_more(damper.fit, "channel-gain", {"channels": LABEL}, {"gain_error": GAIN})
    rounds = (
        Addition(damper, (damper,), (mass, damper), start.held_out_chi2_per_dof),
        Addition(gain, (gain,), (gain,), damper.held_out),
    )
    before, after = residual(start, thresholds), residual(gain.fit, thresholds)
    return Attribution(start, before, rounds, gain.fit, after, (gain,), ())


def verdict_on_elements(monkeypatch: pytest.MonkeyPatch, folder: Path, *, exchanging: bool) -> Verdict:
    """The verdict on a mass and a gain where the first search has gone wrong."""
    begun, real = list[int](), searches.attribute

    def first_wrong(start: Fit, asked: Any, thresholds: Thresholds, **rest: Any) -> Attribution:
        begun.append(1)
        return a_damper_first(start, thresholds) if len(begun) == 1 else real(start, asked, thresholds, **rest)

    monkeypatch.setattr(searches, "attribute", first_wrong)
    if not exchanging:
        monkeypatch.setattr(searches, "exchanged", lambda *given: ())
    changes = (twins.added_mass(MASS_KG, *lab.place(roving(8), NODE)), twins.channel_gain((6,), GAIN))
    campaign = lab.campaign_of(roving(8), changes)
    return reconcile(campaign, roving(20), effects=KNOWN, lines=160, folder=folder, most=2, with_tests=False)


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
