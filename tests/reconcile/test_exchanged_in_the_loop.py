"""A search that has gone the wrong way first is put right: a wrong name gives way in the loop, with real fits."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import available_effects, make_effect
from vgvt.reconcile import Verdict, reconcile, searches
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.evidence.rivals import Rival, against
from vgvt.reconcile.fitting.fit import FAR, Fit, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import Thresholds

LINES = 120
DAMPING, PLACE, GAIN, LABEL = 2.0, {"x_m": 0.886, "y_m": 1.113}, 0.1, "6+Z"
KNOWN = ("added-mass", "channel-gain", "nonproportional-damper")
DAMPER = Hypothesis(available_effects()["nonproportional-damper"], {})
MASS = Hypothesis(available_effects()["added-mass"], {})
READS = Hypothesis(available_effects()["channel-gain"], {"channels": LABEL})


def with_one_more(current: Fit, hypothesis: Hypothesis, values: dict[str, float]) -> Rival:
    """A fit with one effect more, as a rival."""
    e = np.concatenate([current.e, hypothesis.scores(values)])
    found = fit(current.problem, (*current.hypotheses, hypothesis), current.u, e, FAR)
    return against(current, [found])[0]


def gone_wrong(start: Fit, thresholds: Thresholds) -> Attribution:
    """A mass named where a damper sits, beside which the gain has its name: the damper had convinced, too."""
    mass = with_one_more(start, MASS, {"mass_kg": 0.02, **PLACE})
    damper = with_one_more(start, DAMPER, {"damping_n_s_per_m": 1.0, **PLACE})
    gain = with_one_more(mass.fit, READS, {"gain_error": GAIN})
    rounds = (
        Addition(mass, (mass,), (damper, mass), start.held_out_chi2_per_dof),
        Addition(gain, (gain,), (gain,), mass.held_out),
    )
    before, after = residual(start, thresholds), residual(gain.fit, thresholds)
    return Attribution(start, before, rounds, gain.fit, after, (gain,), ())


def verdict_of(monkeypatch: pytest.MonkeyPatch, folder: Path, *, exchanging: bool) -> Verdict:
    """The verdict on a damper and a gain where the first search has gone wrong."""
    searched, real = list[int](), searches.attribute

    def first_wrong(start: Fit, asked: Any, thresholds: Thresholds, **rest: Any) -> Attribution:
        searched.append(len(searched))
        return gone_wrong(start, thresholds) if len(searched) == 1 else real(start, asked, thresholds, **rest)

    monkeypatch.setattr(searches, "attribute", first_wrong)
    if not exchanging:
        monkeypatch.setattr(searches, "exchanged", lambda *rest: ())
    damper = make_effect("nonproportional-damper", "test", damping_n_s_per_m=DAMPING, **PLACE)
    gain = make_effect("channel-gain", "test", gain_error=GAIN, channels=LABEL)
    campaign = campaign_of(roving_scenario(), 3, damper, gain)
    effects = {n: c for n, c in available_effects().items() if n in KNOWN}
    return reconcile(campaign, roving_scenario(), effects=effects, lines=LINES, folder=folder, most=2, with_tests=False)


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
