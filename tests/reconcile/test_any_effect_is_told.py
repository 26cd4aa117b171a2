"""A verdict with any effect of the catalogue has its account, its page and its scenario, whatever it changes where."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_scenario

from vgvt.data import Campaign
from vgvt.effects import available_effects
from vgvt.reconcile import Kind, Verdict, loop, reconcile, searches
from vgvt.reconcile.decision import beyond_names
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.leads import led_by_all
from vgvt.reconcile.evidence.fitted_law import FittedLaw
from vgvt.reconcile.evidence.nameless import Nameless
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.evidence.rivals import Rival
from vgvt.reconcile.evidence.smooth_law import TERMS
from vgvt.reconcile.evidence.still_explained import StillExplained
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.outcome.account import account_of
from vgvt.reconcile.outcome.cells import at_whole_cells
from vgvt.reconcile.outcome.instruments import gain_tables
from vgvt.reconcile.question.problem import Problem
from vgvt.scenario import load_scenario
from vgvt.view.reconcile_page import render_reconcile_page

# From run to run, so that runs differ in structure.
IN_CI = ("run-drift",)
LINES = 60


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Derivatives are worked out once for all effects."""
    return tmp_path_factory.mktemp("told")


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    """Nothing is missing in it: what is named here was never found."""
    return campaign_of(roving_scenario(), 1)


def as_stated(problem: Problem, *_: Any, **__: Any) -> Fit:
    """Instead of a calibration."""
    return fit(problem, (), np.zeros(problem.size), np.zeros(0), ())


def naming(name: str) -> Any:
    """Instead of a search: one that ends with an effect of the middle of its plausible range."""

    def attributed(null: Fit, hypotheses: Any, thresholds: Any, **_: Any) -> Attribution:
        h = max((h for h in hypotheses if h.name == name), key=lambda h: h.settings.get("from_run", 0))
        middle = h.values(np.zeros(len(h.parameters)))
        values = {p.name: 0.5 * p.high if middle[p.name] == 0 else middle[p.name] for p in h.parameters}
        named = fit(null.problem, (h,), null.u, h.scores(values), ())
        rival = Rival(named, 100.0, 100.0, 100.0, 1.0)
        first, last = residual(null, thresholds), residual(named, thresholds)
        return Attribution(null, first, (Addition(rival, (rival,), (rival,), 2.0),), named, last, (rival,), ())

    return attributed


def told(
    folder: Path, campaign: Campaign, name: str, monkeypatch: pytest.MonkeyPatch, against: Any = lambda found, *_: found
) -> Verdict:
    """The verdict that names an effect, with all that follows a search."""
    monkeypatch.setattr(loop, "calibrate", as_stated)
    monkeypatch.setattr(searches, "attribute", naming(name))
    monkeypatch.setattr(loop, "as_leads", lambda found, thresholds: found)
    monkeypatch.setattr(beyond_names, "takes_nearly_all", lambda found: True)
    monkeypatch.setattr(searches, "strange_names", lambda found: frozenset())
    monkeypatch.setattr(loop, "turned", lambda found: None)
    monkeypatch.setattr(loop, "with_told_parameters", lambda found, *_: found)
    monkeypatch.setattr(loop, "set_against_nameless", against)
    known = {name: available_effects()[name]}
    return reconcile(campaign, roving_scenario(), effects=known, lines=LINES, folder=folder)


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n in IN_CI else pytest.mark.slow) for n in sorted(available_effects())]
)
def test_it_has_its_account_its_page_and_its_scenario(
    folder: Path, campaign: Campaign, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = told(folder, campaign, name, monkeypatch)
    assert found.kind is not Kind.ADEQUATE
    assert [e.name for e in found.effects] == [name]
    written = load_scenario(folder / "reconciled.toml")
    gains = len(gain_tables(written, at_whole_cells(found.attribution.final)))
    assert [t.name for t in written.effect[: len(written.effect) - gains]] == [name]
    again = found.resimulated
    assert again.comparison is not None or again.remark
    account = account_of(found, title="told")
    assert account.modes and all(row.train_percent[1] >= 0 for row in account.modes)
    page = render_reconcile_page(account)
    assert name in page and "</html>" in page
    assert not re.search(r"\bnan\b", page.split("<script", 1)[0], re.IGNORECASE)


def test_what_a_nameless_thing_does_without_is_a_lead_and_the_thing_is_told(
    folder: Path, campaign: Campaign, monkeypatch: pytest.MonkeyPatch
) -> None:
    line = np.linspace(3.0, 35.0, LINES)
    law = FittedLaw(line, np.full(TERMS, 40.0 + 0j), np.eye(2 * TERMS), "structure", False)

    def against(found: Attribution, *_: Any) -> Attribution:
        null = found.null
        where = StillExplained("force at 18+Z", "structure", 40.0, "from run 2 on", (0.0, 1.0, 1.0, 1.0), 100)
        nameless = Nameless(
            where, null.problem, (), null.u, null.e, null.covariance, law, null.predicted, null.chi2, 0.0, 0.0, 0.0,
            ("run-drift",), 31.0,
        )  # fmt: skip
        return replace(led_by_all(found), nameless=nameless)

    def unasked(*_: Any) -> None:
        raise AssertionError("what has no name beside it is asked of names that are none any more")

    monkeypatch.setattr(loop, "asked_beyond_names", unasked)
    found = told(folder, campaign, "run-drift", monkeypatch, against)
    assert found.kind is Kind.UNKNOWN and not found.effects
    assert [e.name for e in found.leads] == ["run-drift"]
    words = "a force at 18+Z from run 2 on that is smooth over frequency and reads as a stiffness of 40"
    assert any(words in said for said in found.reasons)
    assert words in repr(found)
    document = json.loads(json.dumps(found.document()))["nameless"]
    assert document["place"] == "force at 18+Z" and document["when"] == "from run 2 on"
    assert document["instead_of"] == ["run-drift"] and document["ahead_nats"] == 31.0
    page = render_reconcile_page(account_of(found, title="told"))
    assert words in page and "takes 31 nats more than run-drift" in page
    assert document["law"]["real"] == pytest.approx([40.0] * 33)
