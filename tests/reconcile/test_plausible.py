"""What is bent to do what another effect does is no such thing any more, and has no name."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, small_scenario

from vgvt.effects import available_effects
from vgvt.reconcile import Kind, reconcile
from vgvt.reconcile.decision import attribute as rounds
from vgvt.reconcile.decision.reasons import reasons_of
from vgvt.reconcile.evidence import plausible
from vgvt.reconcile.evidence.plausible import implausible
from vgvt.reconcile.outcome.account import _standing
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.candidates import freed
from vgvt.scenario import load_scenario

# The package's lazy name of the same spelling is the function.

ABSORBER = freed(Hypothesis(available_effects()["local-absorber"], {"x_m": 0.5, "y_m": 0.5}))
LIKELY = {"mass_kg": 0.1, "frequency_hz": 20.0, "damping_ratio": 0.02, "x_m": 0.5, "y_m": 0.5}
HYPOTHESES = (ABSORBER, Hypothesis(available_effects()["channel-gain"], {"channels": "force"}))
HATI = load_scenario("hati-unsymmetric")


@pytest.fixture(autouse=True)
def as_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plausible, "honest", lambda fit: fit)


def fit_of(sd: float = 0.01, **changed: float) -> Any:
    """A fit of an absorber on Hati and, after it, a gain far off; values known to a standard deviation."""
    u = np.array([9.0, -9.0])
    values = LIKELY | changed
    e = np.concatenate([ABSORBER.scores(values), HYPOTHESES[1].scores({"gain_error": 5.0})])
    own: list[dict[str, Any]] = [{k: (v, sd, "") for k, v in values.items()}, {"gain_error": (5.0, sd, "")}]
    return SimpleNamespace(
        u=u, scores=np.concatenate([u, e]), hypotheses=HYPOTHESES, values=lambda index: own[index],
        problem=SimpleNamespace(scenario=HATI),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("changed", "sd", "what"),
    [
        ({}, 0.01, ()),
        ({"frequency_hz": 120.0}, 0.01, ("frequency_hz",)),
        # Where values stop to follow their scores.
        ({"frequency_hz": 146.1}, 0.0, ("frequency_hz",)),
        ({"frequency_hz": 60.0}, 0.01, ()),
        # Hati is 1.17 m long and 3.06 m wide; a quarter of that, at either end, is near it.
        ({"x_m": 1.75}, 0.01, ("x_m",)),
        ({"x_m": 1.75}, 0.2, ()),
        ({"x_m": 1.4}, 0.01, ()),
        ({"x_m": -0.35, "y_m": 2.35}, 0.01, ("x_m", "y_m")),
        ({"y_m": -2.35}, 0.01, ("y_m",)),
        # How much there is of it, and how damped it is, is for the data to say.
        ({"mass_kg": 8.0, "damping_ratio": 0.6}, 0.01, ()),
    ],
)
def test_what_lies_surely_beyond_is_said(changed: dict[str, float], sd: float, what: tuple[str, ...]) -> None:
    found = implausible(fit_of(sd, **changed), 0)
    assert tuple(words.split(" of ")[0] for words in found) == what
    assert implausible(fit_of(sd, **changed)) == ()


def test_it_is_asked_of_the_effect_that_was_added_last() -> None:
    fit = fit_of(frequency_hz=120.0)
    split = fit.u.size + len(ABSORBER.parameters)
    fit.scores = np.concatenate([fit.u, fit.scores[split:], fit.scores[fit.u.size : split]])
    turned_round: Any = SimpleNamespace(
        u=fit.u, scores=fit.scores, hypotheses=HYPOTHESES[::-1], values=lambda index: fit.values(1 - index),
        problem=fit.problem,
    )  # fmt: skip
    assert len(implausible(turned_round)) == 1
    assert implausible(turned_round, 0) == ()


def test_a_frequency_that_data_may_set_to_any_size_is_not_asked() -> None:
    """The corner of a high-pass is how much of it there is."""
    corner = Hypothesis(available_effects()["high-pass-mismatch"], {"channels": "response"})
    fit: Any = SimpleNamespace(
        u=np.zeros(0), scores=corner.scores({"corner_hz": 30.0}), hypotheses=(corner,),
        values=lambda index: {"corner_hz": (30.0, 0.1, "Hz")}, problem=SimpleNamespace(scenario=HATI),
    )  # fmt: skip
    assert fit.scores[0] > 3
    assert implausible(fit) == ()


def test_it_is_said_with_what_would_be_plausible() -> None:
    assert implausible(fit_of(frequency_hz=120.0), 0) == ("frequency_hz of 120 Hz, where 3 to 40 Hz is plausible",)


@pytest.mark.parametrize(
    ("left", "plausible_one", "first"),
    [
        # Gain of evidence and what held-out data are missed by, of the plausible one; the other has 90 nats and 9.0.
        (0.8, (87.0, 9.9), "mass"),
        (0.8, (60.0, 8.0), "absorber"),
        # Where much is left, evidence weighs wrong unknowns: held-out data say what is as good.
        (20.0, (40.0, 9.4), "mass"),
        (20.0, (87.0, 18.0), "absorber"),
    ],
)
def test_a_plausible_rival_goes_first_where_it_does_as_well(
    monkeypatch: pytest.MonkeyPatch, left: float, plausible_one: tuple[float, float], first: str
) -> None:
    """One far behind does not: what is far ahead of all that could be says that something else is there."""

    def strange(rival_fit: Any) -> tuple[str, ...]:
        return ("far above the band",) if rival_fit.number == 0 else ()

    monkeypatch.setattr(plausible, "implausible", strange)
    monkeypatch.setattr(rounds, "implausible", strange)
    rows = (("absorber", 90.0, 9.0), ("mass", *plausible_one))
    rivals: Any = [
        SimpleNamespace(
            name=name,
            gain_nats=nats,
            held_out=held,
            fit=SimpleNamespace(number=k, chi2_per_dof=left),
            convinces=lambda limits: True,
        )
        for k, (name, nats, held) in enumerate(rows)
    ]
    limits: Any = SimpleNamespace(evidence_nats=9.0, set_nats=5.0)
    before: Any = SimpleNamespace(
        adequate=False,
        held_out_chi2_per_dof=None,
        train_chi2_per_dof=30.0,
        limits=SimpleNamespace(held_out_per_dof=1.0),
    )
    monkeypatch.setattr(rounds, "residual", lambda fit, thresholds: before)
    monkeypatch.setattr(rounds, "linear_first", lambda problem, hypotheses: (list(hypotheses), []))
    monkeypatch.setattr(rounds, "_tried", lambda *given: tuple(rivals))
    monkeypatch.setattr(rounds, "_restart", lambda null, winner: null)
    monkeypatch.setattr(rounds, "against", lambda current, fits: tuple(rivals))
    monkeypatch.setattr(rounds, "_passed", lambda *given: True)
    monkeypatch.setattr(rounds, "takes_enough", lambda *given: True)
    monkeypatch.setattr(rounds, "ended", lambda current, found, *given: found)
    monkeypatch.setattr(rounds, "straightened", lambda confirmed, set_nats: list(confirmed))
    monkeypatch.setattr(rounds, "held_out_nats", lambda fit, better: 0.0)
    monkeypatch.setattr(rounds, "controlled", lambda addition, *given: addition)
    monkeypatch.setattr(rounds, "plain_likenesses", lambda *given: ())
    monkeypatch.setattr(rounds, "needed", lambda found, current, thresholds: (found, current))
    monkeypatch.setattr(rounds, "reconsidered", lambda found, *asked: found)
    monkeypatch.setattr(rounds, "nowhere", lambda addition: False)
    null: Any = SimpleNamespace(problem=None, chi2_per_dof=30.0)
    found = rounds.attribute(null, (), limits, most=1)
    assert found.rounds[0].winner.name == first
    assert {r.name for r in found.rounds[0].equivalent} == {first}


@pytest.mark.slow
def test_a_mass_is_no_absorber_far_above_the_band(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where masses are not in the catalogue: below its resonance an absorber is one."""
    monkeypatch.undo()
    scenario, known = small_scenario(), available_effects()
    campaign = campaign_of(scenario, 14, known["added-mass"](mass_kg=0.15, x_m=0.75, y_m=0.9))
    found = reconcile(
        campaign, scenario, effects={"local-absorber": known["local-absorber"]}, lines=150, folder=tmp_path
    )
    assert found.kind is Kind.UNKNOWN, found.reasons
    (lead,) = found.leads
    assert lead.parameters["mass_kg"][0] == pytest.approx(0.15, rel=0.1)
    assert any(
        "; local-absorber with frequency_hz of" in reason and "is no plausible thing, and" in reason
        for reason in found.reasons
    )
    # Beside an earlier name that stays, or a rival that could be, it is told as refused.
    (addition,) = found.attribution.leads
    beside = replace(found.attribution, leads=(), led=None, vetoed=(addition.winner,))
    said = reasons_of(found.kind, beside, found.thresholds, None)
    assert sum("but it is no plausible thing (frequency_hz of" in reason for reason in said) == 1
    assert not any("speak against it" in reason for reason in said)
    assert _standing(addition.winner, None, beside, found.thresholds, "lead") == "no plausible thing"
