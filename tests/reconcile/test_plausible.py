"""What is bent to do what another effect does is no such thing any more, and has no name."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, small_scenario

from vgvt.effects import available_effects
from vgvt.reconcile import Kind, plausible, reconcile
from vgvt.reconcile.candidates import freed
from vgvt.reconcile.hypothesis import Hypothesis
from vgvt.reconcile.plausible import implausible, likelier

ABSORBER = freed(Hypothesis(available_effects()["local-absorber"], {"x_m": 0.5, "y_m": 0.5}))
LIKELY = {"mass_kg": 0.1, "frequency_hz": 20.0, "damping_ratio": 0.02, "x_m": 0.5, "y_m": 0.5}
HYPOTHESES = (ABSORBER, Hypothesis(available_effects()["channel-gain"], {"channels": "force"}))


@pytest.fixture(autouse=True)
def as_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plausible, "honest", lambda fit: fit)


def fit_of(sd: float = 0.1, **changed: float) -> Any:
    """A fit of an absorber and, after it, a gain far off; all scores known to a standard deviation."""
    u = np.array([9.0, -9.0])
    values = LIKELY | changed
    e = np.concatenate([ABSORBER.scores(values), HYPOTHESES[1].scores({"gain_error": 5.0})])
    scores = np.concatenate([u, e])
    return SimpleNamespace(
        u=u, scores=scores, covariance=sd**2 * np.eye(scores.size), hypotheses=HYPOTHESES,
        values=lambda index: {k: (v, sd, "") for k, v in values.items()},
    )  # fmt: skip


@pytest.mark.parametrize(
    ("changed", "sd", "what"),
    [
        ({}, 0.1, ()),
        ({"frequency_hz": 120.0}, 0.1, ("frequency_hz",)),
        # A little beyond, or perhaps not beyond.
        ({"frequency_hz": 60.0}, 0.1, ()),
        ({"frequency_hz": 120.0}, 1.0, ()),
        ({"x_m": 1.75}, 0.1, ("x_m",)),
        ({"x_m": -0.5, "y_m": 2.4}, 0.1, ("x_m", "y_m")),
        # How much there is of it is for the data to say.
        ({"mass_kg": 8.0}, 0.1, ()),
    ],
)
def test_what_lies_surely_beyond_is_said(changed: dict[str, float], sd: float, what: tuple[str, ...]) -> None:
    found = implausible(fit_of(sd, **changed), 0)
    assert tuple(words.split(" of ")[0] for words in found) == what
    assert implausible(fit_of(sd, **changed)) == ()


def test_an_angle_comes_round() -> None:
    """Five radians to the left are one and a quarter to the right."""
    tilt = Hypothesis(available_effects()["sensor-tilt"], {"sensors": "7+Z"})
    scores = tilt.scores({"angle_rad": 0.05, "azimuth_rad": 5.0})
    assert abs(scores[1]) > 3
    fit: Any = SimpleNamespace(u=np.zeros(0), scores=scores, covariance=1e-4 * np.eye(2), hypotheses=(tilt,))
    assert implausible(fit) == ()


def test_it_is_said_with_what_would_be_plausible() -> None:
    assert implausible(fit_of(frequency_hz=120.0), 0) == ("frequency_hz of 120 Hz, where 3 to 40 Hz is plausible",)


@pytest.mark.parametrize(("behind", "kept"), [(3.0, ["mass"]), (30.0, ["absorber", "mass"])])
def test_a_plausible_rival_within_reach_goes_first(
    monkeypatch: pytest.MonkeyPatch, behind: float, kept: list[str]
) -> None:
    """One far behind does not: what is far ahead of all that could be says that something else is there."""
    monkeypatch.setattr(plausible, "implausible", lambda fit: ("far above the band",) if fit == "absorber" else ())
    rivals: Any = [
        SimpleNamespace(name="absorber", fit="absorber", gain_nats=90.0),
        SimpleNamespace(name="mass", fit="mass", gain_nats=90.0 - behind),
    ]
    assert [r.name for r in likelier(rivals, 5.0)] == kept
    assert likelier(rivals[:1], 5.0) == rivals[:1]
    assert likelier([], 5.0) == []


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
    assert any("it is no plausible thing (frequency_hz of" in reason for reason in found.reasons)
