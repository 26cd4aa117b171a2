"""Two levels that are answered alike show no joint that depends on level: its linear likeness has the name."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import roving_scenario, without_instrument_noise

from vgvt.effects import available_effects
from vgvt.reconcile.evidence import bending
from vgvt.reconcile.evidence.bending import level_nats, plain_likenesses, straightened
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.simulation import simulated_campaign

NOTHING = np.zeros(0)


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """Two runs of a linear aircraft, the second four times as loud."""
    scenario = without_instrument_noise(roving_scenario())
    problem = make_problem(simulated_campaign(scenario, engine="linear"), scenario, lines=80)
    measured = problem.measured
    assert len(measured.runs) > 1
    louder = np.where(np.arange(len(measured.runs)) > 0, 4.0, 1.0)[:, None]
    return replace(problem, measured=replace(measured, force=louder * measured.force, pushed=louder * measured.pushed))


def looked_at(case: Problem, name: str, **values: float) -> Fit:
    """An effect as it is, nothing fitted."""
    settings = {"kind": "bending", "side": "both", "root_stiffness_n_m_per_rad": 2000.0, **values}
    return fit(case, (Hypothesis(available_effects()[name], settings),), np.zeros(case.size), NOTHING, ())


def test_play_that_its_load_keeps_shut_answers_alike_at_any_level(case: Problem) -> None:
    shut = level_nats(looked_at(case, "root-freeplay", gap_rad=1e-7))
    assert shut < 1
    assert level_nats(looked_at(case, "root-friction", friction_n_m=0.3)) > 100


def rival(name: str, gain_nats: float, linear: bool, alike: tuple[str, ...] = ()) -> Any:
    hypothesis = SimpleNamespace(linear=linear, cls=SimpleNamespace(confused_with=alike))
    return SimpleNamespace(name=name, gain_nats=gain_nats, hypothesis=hypothesis, fit=SimpleNamespace(problem=None))


@pytest.mark.parametrize(
    ("levels", "seen_nats", "soft_nats", "kept"),
    [
        (True, 0.1, 98.0, ["soft"]),
        (True, 30.0, 98.0, ["play", "soft"]),
        (True, 0.1, 80.0, ["play", "soft"]),
        (False, 0.1, 98.0, ["play", "soft"]),
    ],
)
def test_where_nothing_bends_the_linear_likeness_has_the_name(
    monkeypatch: pytest.MonkeyPatch, levels: bool, seen_nats: float, soft_nats: float, kept: list[str]
) -> None:
    """With several levels, none answered otherwise, and a likeness within reach; else both stay."""
    monkeypatch.setattr(bending, "several_levels", lambda problem: levels)
    monkeypatch.setattr(bending, "level_nats", lambda found: seen_nats)
    both = [rival("play", 100.0, False, ("soft",)), rival("soft", soft_nats, True), rival("soft", 10.0, True)]
    assert list(dict.fromkeys(r.name for r in straightened(both, 5.0))) == kept


def test_nothing_confirmed_stays_nothing() -> None:
    assert straightened([], 5.0) == []


@pytest.mark.parametrize(
    ("linear", "levels", "seen_nats", "beside"),
    [
        (False, False, 99.0, ["mass"]),
        (False, True, 0.1, ["mass"]),
        (False, True, 30.0, []),  # the levels are answered otherwise: that no mass does
        (True, False, 0.0, []),
    ],
)
def test_a_plain_likeness_that_meets_the_data_stands_beside_what_no_level_shows(
    monkeypatch: pytest.MonkeyPatch, linear: bool, levels: bool, seen_nats: float, beside: list[str]
) -> None:
    """A mass of 81 g was a rattling one, 27 nats ahead by a seat of 112 Hz, and the mass was not in the answer."""
    monkeypatch.setattr(bending, "several_levels", lambda problem: levels)
    monkeypatch.setattr(bending, "level_nats", lambda fit: seen_nats)
    met = ("mass", "inertia", "absorber")
    monkeypatch.setattr(
        bending, "residual", lambda fit, thresholds: SimpleNamespace(adequate=getattr(fit, "of", None) in met)
    )
    alike = ("mass", "root", "absorber")
    rows = (("mass", 520.3, True), ("mass", 520.4, True), ("inertia", 530.0, True), ("root", 500.0, True))
    confirmed = [rival(*row) for row in (*rows, ("absorber", 545.0, True))]
    for r in confirmed:
        r.fit.of = r.name
    winner = rival("rattling", 547.1, linear, alike)
    equal = (winner, confirmed[-1])
    found = plain_likenesses(winner, [winner, *confirmed], equal, SimpleNamespace(set_nats=5.0))  # type: ignore[arg-type]
    assert [r.name for r in found] == beside
    assert [r.gain_nats for r in found] == [520.4] * len(beside)
