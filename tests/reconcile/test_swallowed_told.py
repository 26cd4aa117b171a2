"""A name whose effect a calibration had swallowed: what it mends is the tolerances, and the verdict says so."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from vgvt.reconcile.decision import reasons
from vgvt.reconcile.decision.kinds import Kind


@pytest.mark.parametrize("bent", [False, True])
def test_what_a_calibration_had_swallowed_is_told_as_tolerances_that_are_met_again(
    monkeypatch: pytest.MonkeyPatch, bent: bool
) -> None:
    """Held-out data were met before: the sentence does not speak as if the name had done that."""
    for name in ("open_places", "untold_parameters", "_of_what_is_left", "doubts", "_of_the_implausible"):
        monkeypatch.setattr(reasons, name, lambda *_: [])
    monkeypatch.setattr(reasons, "strained_too_much", lambda fit: bent)
    monkeypatch.setattr(reasons, "far_scores", lambda fit: "gain sensor-2 at +7.4 sd")
    monkeypatch.setattr(reasons, "rests_on_one_level", lambda found: ())
    monkeypatch.setattr(reasons, "words_of", lambda harmonics: None)
    hypothesis = SimpleNamespace(label="channel-gain", name="channel-gain", linear=True, settings={})
    fit: Any = SimpleNamespace(chi2_per_dof=0.6, hypotheses=(hypothesis,))
    winner: Any = SimpleNamespace(
        name="channel-gain", hypothesis=hypothesis, gain_nats=30.0, lasting_nats=28.0, held_out=0.621, fit=fit
    )

    def said(before: float) -> str:
        addition = SimpleNamespace(winner=winner, equivalent=(winner,), in_its_place=(winner,), held_out_before=before)
        null = SimpleNamespace(problem=SimpleNamespace(measured=SimpleNamespace(harmonics=())))
        found: Any = SimpleNamespace(null=null, rounds=(addition,), vetoed=())
        limits: Any = SimpleNamespace(set_nats=5.0, evidence_nats=9.0)
        return next(s for s in reasons.reasons_of(Kind.EXPLAINED, found, limits, None) if "Adding" in s)

    assert "held-out error goes from 1.20 to 0.62" in said(1.2)
    assert "held-out error stays at 0.62" in said(0.624)
    for before in (1.2, 0.624):
        assert ("tolerances that are met again" in said(before)) == (bent and before < 1)
