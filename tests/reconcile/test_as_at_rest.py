"""What depends on level and is foretold as it is at rest has no name that nothing in the data could show."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from lead_case import fitted, left
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.reconcile.decision import leads, reasons
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.as_at_rest import rests, shows_nothing_of_it
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.kinds import Kind, kind_of
from vgvt.reconcile.decision.leads import as_leads, why_no_name
from vgvt.reconcile.question.harmonics import Harmonic
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem

KNOWN = available_effects()


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return problem(tmp_path_factory.mktemp("slopes"), 1)


@pytest.fixture(autouse=True)
def plausible_things(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (leads, reasons):
        monkeypatch.setattr(module, "implausible", lambda fit, index=-1: ())


def rival(name: str, fit: Any = None) -> Any:
    return SimpleNamespace(
        name=name, hypothesis=Hypothesis(KNOWN[name], {}), fit=fit, gain_nats=90.0, held_out=0.9,
        convinces=lambda thresholds: True,
    )  # fmt: skip


def rounds_of(case: Problem, *named: tuple[str, ...], before: float = 5.0) -> Attribution:
    """Rounds whose names meet the data; the first of each wins, and the others do as well."""
    fits = [fitted(900.0 if k == len(named) - 1 else 1500.0) for k in range(len(named))]
    for k, fit in enumerate(fits):
        fit.hypotheses = tuple(Hypothesis(KNOWN[names[0]], {}) for names in named[: k + 1])
    rounds = []
    for names, fit in zip(named, fits, strict=True):
        alike = tuple(rival(name, fit) for name in names)
        rounds.append(Addition(alike[0], alike, alike, 5.0))
    null = fitted(1000 * before, bent=50.0 if before > 1 else 0.0)
    for fit in (null, *fits):
        fit.problem = case
        fit.scores = np.resize(fit.scores, case.size) * (np.arange(case.size) < fit.scores.size)
    start = left(before, adequate=before < 1)
    return Attribution(null, start, tuple(rounds), fits[-1], left(0.9, True), rounds[-1].rivals, ())


@pytest.mark.parametrize(
    ("name", "at_rest"),
    [
        ("rattling-mass", True), ("mount-lift-off", True), ("shaker-backlash", True),
        ("control-surface-freeplay", True),
        ("added-mass", False), ("control-surface", False),
        ("cubic-root-stiffness", False), ("root-freeplay", False), ("root-friction", False),
    ],
)  # fmt: skip
def test_only_joints_are_followed_by_level(case: Problem, name: str, at_rest: bool) -> None:
    assert rests(case, rival(name)) is at_rest


@pytest.mark.parametrize(("power", "rest"), [(3.0, True), (9.0, False)])
def test_harmonics_that_the_force_does_not_explain_show_that_something_is_loose(
    case: Problem, power: float, rest: bool
) -> None:
    heard = replace(case, measured=replace(case.measured, harmonics=(Harmonic(1, 2, power, 1.0),)))
    assert rests(heard, rival("rattling-mass")) is rest


@pytest.mark.parametrize(
    ("alike", "nothing"),
    [
        (("rattling-mass",), True),
        (("rattling-mass", "mount-lift-off"), True),
        (("rattling-mass", "added-mass"), False),
        (("added-mass", "rattling-mass"), False),
        (("rattling-mass", "root-freeplay"), False),
    ],
)
def test_something_linear_or_followed_beside_it_says_what_it_could_be(
    case: Problem, alike: tuple[str, ...], nothing: bool
) -> None:
    found = rounds_of(case, alike)
    assert shows_nothing_of_it(case, found.rounds[0]) is nothing
    judged = as_leads(found, SimpleNamespace())  # type: ignore[arg-type]
    assert (judged.rounds == ()) is nothing
    assert kind_of(judged) is (Kind.UNKNOWN if nothing else Kind.AMBIGUOUS)


def test_a_mass_that_nothing_shows_to_rattle_is_a_lead(case: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    """An added mass that was taken out of the catalogue was "ambiguous", one that rattles, in three seeds."""
    found = rounds_of(case, ("rattling-mass",))
    judged = as_leads(found, SimpleNamespace())  # type: ignore[arg-type]
    assert [a.winner.name for a in judged.leads] == ["rattling-mass"]
    monkeypatch.setattr(leads, "strain_sd", lambda fit: 0.0)
    judged.led.held_out_chi2_per_dof = 0.9  # type: ignore[union-attr]
    said = why_no_name(judged)
    assert said.startswith("rattling-mass depends on level and is foretold as it is at rest")
    assert "halve the level" in said


def test_what_was_named_before_it_keeps_its_name(case: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(leads, "residual", lambda fit, thresholds: left(1.5, True))
    judged = as_leads(rounds_of(case, ("root-compliance",), ("rattling-mass",)), SimpleNamespace())  # type: ignore[arg-type]
    assert [a.winner.name for a in judged.rounds] == ["root-compliance"]
    (said,) = reasons._of_one_at_rest(judged)
    assert said.startswith("rattling-mass would gain 90 nats, but rattling-mass depends on level")


def test_what_was_named_beside_it_rests_on_it(case: Problem) -> None:
    judged = as_leads(rounds_of(case, ("rattling-mass",), ("root-compliance",)), SimpleNamespace())  # type: ignore[arg-type]
    assert judged.rounds == ()
    assert [a.winner.name for a in judged.leads] == ["rattling-mass", "root-compliance"]


def test_where_nothing_is_missing_it_is_told_that_it_lost_its_name(case: Problem) -> None:
    judged = as_leads(rounds_of(case, ("rattling-mass",), before=0.8), SimpleNamespace())  # type: ignore[arg-type]
    assert judged.rounds == judged.leads == ()
    assert kind_of(judged) is Kind.ADEQUATE
    assert [r.name for r in judged.vetoed] == ["rattling-mass"]
    assert reasons._of_one_at_rest(judged)
    limits: Any = SimpleNamespace(evidence_nats=9.0)
    judged.null_residual.train_chi2_per_dof = 0.8  # type: ignore[misc]
    assert "takes too little" not in " ".join(reasons._of_an_adequate_model(judged, limits))
