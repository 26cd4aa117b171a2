"""Where tolerances that are far exceeded meet the data, a calibration that may not bend shows what they imitate."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import available_effects, make_effect
from vgvt.reconcile.decision import fitted_list
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import FAR, NEAR, Fit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.problem import CELLS, make_problem
from vgvt.reconcile.search import shortlist
from vgvt.reconcile.search.candidate_fits import fitted_from
from vgvt.reconcile.search.candidates import candidates
from vgvt.reconcile.search.from_stated import bent
from vgvt.reconcile.search.screen import screen
from vgvt.reconcile.search.screened import Screened
from vgvt.reconcile.search.shortlist import BIASED, shortened
from vgvt.reconcile.search.upright import held, upright
from vgvt.reconcile.work.progress import silent

# The package's lazy name of the same spelling is the function.
TRUE_KG_M2 = 0.05
KNOWN = ("added-inertia", "stiffness-asymmetry", "added-mass", "sensor-position-error", "stinger-moment")


@pytest.fixture(scope="module")
def swallowed(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """A calibration that meets what rolls with the aircraft by a body whose inertia is far outside its tolerance."""
    heavier = make_effect("added-inertia", "here", roll_inertia_kg_m2=TRUE_KG_M2)
    campaign = campaign_of(roving_scenario(), 1, heavier)
    return calibrate(make_problem(campaign, roving_scenario(), lines=60, cache=tmp_path_factory.mktemp("cache")))


def test_held_unknowns_are_the_same_aircraft(swallowed: Fit) -> None:
    """At scores that are as many times as large; the chain's cells and the gains are not held."""
    problem = swallowed.problem
    stiff, shares = held(problem, 0.1)
    u = swallowed.u / shares
    there = anchor(stiff, u, slopes=False).predict(u, np.zeros(0))
    np.testing.assert_allclose(there, swallowed.predicted, rtol=1e-5, atol=1e-6)
    free = [k for k, name in enumerate(problem.names) if name == CELLS.name or k >= len(problem.unknowns)]
    assert (shares[free] == 1).all() and (np.delete(shares, free) == 0.1).all()
    # So are the scores where slopes were taken.
    moved = replace(problem, centre=np.arange(1.0, len(problem.unknowns) + 1))
    again, _ = held(moved, 0.1)
    assert [k.amount(float(u)) for k, u in zip(again.unknowns, again.at, strict=True)] == pytest.approx(
        [k.amount(float(u)) for k, u in zip(moved.unknowns, moved.at, strict=True)]
    )


@pytest.mark.slow
def test_what_was_imitated_comes_first_and_leads_to_the_truth(swallowed: Fit) -> None:
    assert bent(swallowed) and swallowed.chi2_per_dof < BIASED
    offered = candidates(swallowed.problem, {n: available_effects()[n] for n in KNOWN})
    first, *rest = upright(swallowed, shortlist._forgiving(swallowed), offered, silent)
    assert first.hypothesis.name == "added-inertia" and first.upright
    assert first.gain_nats > 5 * max(s.gain_nats for s in rest if s.hypothesis.name != first.hypothesis.name)
    # From where the unknowns are bent it promises a hundredth of that.
    assert first.gain_nats > 20 * max(s.gain_nats for s in screen(swallowed, offered))
    # Its start is in scores of the problem as it is, and within the tolerances.
    assert first.start is not None
    # How coarse the chain is has an end, which a score reaches wherever it goes.
    others = np.delete(np.arange(first.start.size), swallowed.problem.unknowns.index(CELLS))
    assert np.abs(first.start[others]).max() < 2 < 4 < np.abs(swallowed.u[others]).max()
    found = fitted_from(swallowed, first, FAR, silent)
    assert found is not None
    assert found.values(0)["roll_inertia_kg_m2"][0] == pytest.approx(TRUE_KG_M2, rel=0.1)
    assert found.evidence_nats > swallowed.evidence_nats + 50


@pytest.mark.parametrize(
    ("left", "moved", "falls", "looked"),
    [
        (20.0, 3.0, False, ["near"]),
        (20.0, 38.0, False, ["near", "upright"]),
        (0.4, 12.0, False, ["upright"]),
        (0.4, 12.0, True, ["near"]),
    ],
)
def test_it_is_looked_for_so_where_data_are_met_and_where_unknowns_are_bent(
    monkeypatch: pytest.MonkeyPatch, left: float, moved: float, falls: bool, looked: list[str]
) -> None:
    """And where an aircraft that may not bend does not hang, from where the calibration stands.

    A body whose halves rock against each other had bent its unknowns by 38 deviations, which met none of its data.
    """
    asked = list[str]()

    def seen(which: str) -> Any:
        def look(*given: Any) -> tuple[()]:
            if which == "upright" and falls:
                raise NoStructureError("falls")
            asked.append(which)
            return ()

        return look

    forgiving: Any = "forgiving"

    def sizing(stand: Any, *given: Any) -> list[Any]:
        asked.append("far" if stand is forgiving else "near")
        return []

    monkeypatch.setattr(shortlist, "upright", seen("upright"))
    monkeypatch.setattr(shortlist, "screen", lambda *given, **more: seen("near")())
    monkeypatch.setattr(shortlist, "sizing", sizing)
    monkeypatch.setattr(shortlist, "held", lambda *given: ())
    monkeypatch.setattr(shortlist, "_forgiving", lambda current, tell: forgiving)
    monkeypatch.setattr(shortlist, "_asked", lambda current, left, *more: (list(left), []))
    monkeypatch.setattr(shortlist, "localise", lambda current, everywhere: SimpleNamespace(places=()))
    before: Any = SimpleNamespace(train_chi2_per_dof=left)
    current: Any = SimpleNamespace(u=np.array([0.1, -moved]), hypotheses=())
    assert shortened(current, (), before, 9.0, silent, afar=True) == ()
    assert sorted(asked) == sorted(["far", *looked])
    # Where data are not met once is enough, before anything has a name.
    for later, again in ((SimpleNamespace(u=current.u, hypotheses=("known",)), False), (current, True)):
        asked.clear()
        shortened(later, (), before, 9.0, silent, again=again, afar=True)
        assert sorted(asked) == sorted(["far", looked[0]])


def test_coarse_steps_have_no_say_in_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """They choose among the others; what was seen upright is fitted to the end beside those that they chose."""
    small: Any = Screened("small", {}, 30.0, upright=True)  # type: ignore[arg-type]
    others = [replace(small, hypothesis=n, upright=False) for n in ("large", "lost")]
    judged, fitted = list[str](), list[str]()

    def finalists(current: Any, chosen: Any, *more: Any) -> tuple[Screened, ...]:
        judged.extend(s.hypothesis for s in chosen)
        return tuple(chosen[:1])

    monkeypatch.setattr(fitted_list, "finalists", finalists)
    monkeypatch.setattr(fitted_list, "fitted_from", lambda current, s, stages, tell: fitted.append(s.hypothesis))
    monkeypatch.setattr(fitted_list, "best_course", lambda found, hypotheses: found)
    monkeypatch.setattr(fitted_list, "in_other_courses", lambda *given: [])
    monkeypatch.setattr(fitted_list, "at_next_items", lambda *given, placed: [])
    monkeypatch.setattr(fitted_list, "against", lambda current, fits: tuple(fits))
    current: Any = SimpleNamespace(evidence_nats=0.0, chi2=1000.0, hypotheses=())
    team: Any = SimpleNamespace(work_off=lambda tasks, tell: [f(*given, silent) for f, given in tasks])
    fitted_list.fit_all(current, [*others, small], (), silent, team, afar=True)
    assert judged == ["large", "lost"]
    assert sorted(fitted) == ["large", "small"]


@pytest.mark.parametrize(
    ("strain", "named", "again", "sees", "asked"),
    [
        (31.0, (), False, (), True),
        (31.0, (), False, ("in sight",), True),
        (5.0, (), False, (), False),
        (5.0, (), False, ("in sight",), False),
        (31.0, ("known",), False, (), False),
        (31.0, (), True, (), False),
    ],
)
def test_where_tolerances_lean_a_calibration_that_may_not_bend_is_asked_too(
    monkeypatch: pytest.MonkeyPatch, strain: float, named: Any, again: bool, sees: tuple[str, ...], asked: bool
) -> None:
    """What a gauge felt of a moment hid behind seven deviations, in data less missed than what is swallowed.

    And whether something is in sight or not: of a mass of 21 g what tolerances had left looked like an inertia.
    """
    plain: dict[str, Any] = {n: SimpleNamespace(name=n, settings={}) for n in (*sees, "hidden")}
    seen = tuple(Screened(plain[n], {}, 50.0) for n in sees)
    hidden = Screened(plain["hidden"], {}, 3000.0, upright=True)
    monkeypatch.setattr(shortlist, "screen", lambda *given, **more: seen)
    monkeypatch.setattr(shortlist, "_upright", lambda *given: (hidden,))
    monkeypatch.setattr(shortlist, "freed", lambda hypothesis: SimpleNamespace(parameters=()))
    monkeypatch.setattr(shortlist, "_strained", lambda current, needed: True)
    limits = SimpleNamespace(strain_sd=6.0)
    before: Any = SimpleNamespace(train_chi2_per_dof=1.2, strain_sd=strain, limits=limits)
    current: Any = SimpleNamespace(u=np.array([7.4]), hypotheses=named)
    assert shortened(current, (), before, 9.0, silent, again=again, afar=False) == (
        *seen,
        *((hidden,) if asked else ()),
    )


def test_what_was_seen_upright_is_fitted_from_afar_though_the_rest_is_near(monkeypatch: pytest.MonkeyPatch) -> None:
    names: tuple[Any, ...] = ("small", "near")
    small, near = (Screened(name, {}, 30.0, upright=name == "small") for name in names)
    stages_of: dict[str, Any] = {}
    monkeypatch.setattr(
        fitted_list, "fitted_from", lambda current, s, stages, tell: stages_of.update({s.hypothesis: stages})
    )
    monkeypatch.setattr(fitted_list, "in_other_courses", lambda *given: [])
    monkeypatch.setattr(fitted_list, "at_next_items", lambda *given, placed: [])
    monkeypatch.setattr(fitted_list, "against", lambda current, fits: tuple(fits))
    current: Any = SimpleNamespace(evidence_nats=0.0, chi2=1000.0, hypotheses=())
    team: Any = SimpleNamespace(work_off=lambda tasks, tell: [f(*given, silent) for f, given in tasks])
    fitted_list.fit_all(current, [small, near], (), silent, team, afar=False)
    assert stages_of == {"small": FAR, "near": NEAR}
