"""What is told of a name: no size that nothing shows, and errors of the aircraft with all that acts on it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, drawn_scores, problem, roving_scenario, small_scenario

from vgvt.effects import available_effects
from vgvt.effects.re_hang import ReHang
from vgvt.reconcile import reconcile
from vgvt.reconcile.decision import told
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.told import polished, with_told_parameters
from vgvt.reconcile.evidence.posterior import honest
from vgvt.reconcile.fitting import spare_sizes
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.fitting.spare_sizes import leaner
from vgvt.reconcile.prediction.carried import Structures
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.local_slopes import Origin, whole_near
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.question.thresholds import stored_thresholds

HUNG_AGAIN = Hypothesis(available_effects()["re-hang"], {"from_run": 2, "shift_y_m": 0.0})
ROOT = Hypothesis(available_effects()["root-compliance"], {"side": "both"})
SHIFT_M = 0.02


@pytest.fixture(scope="module")
def rehung(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """Four runs of roving sensors, the aircraft hung up again after the first."""
    scenario = roving_scenario()
    campaign = campaign_of(scenario, 1, ReHang(shift_x_m=SHIFT_M, from_run=2))
    return make_problem(campaign, scenario, lines=200, cache=tmp_path_factory.mktemp("cache"))


def slopes(case: Problem, u: Any, hypotheses: tuple[Hypothesis, ...], e: Any, whole: bool) -> Any:
    return anchor(case, u, hypotheses, e, structures=Structures(case, whole=whole)).slopes()


@pytest.mark.parametrize(("which", "missing"), [("hook z", 0.2), ("the shift itself", 0.04)])
def test_what_an_effect_does_to_an_unknown_is_in_slopes_of_the_whole(
    rehung: Problem, which: str, missing: float
) -> None:
    """How far a hook was moved tips the aircraft the more, the lower the hook: against assembled differences."""
    e, u, step = HUNG_AGAIN.scores({"shift_x_m": SHIFT_M}), np.zeros(rehung.size), 0.01
    # Two deviations lower than stated: there a shift does twice what it does to the stated aircraft.
    hook = rehung.names.index("hook z")
    u[hook] = -2.0
    k = hook if which == "hook z" else len(rehung.unknowns)
    ends = []
    for side in (step, -step):
        aside_u, aside_e = u.copy(), e.copy()
        if which == "hook z":
            aside_u[k] += side
        else:
            aside_e[0] += side
        there = anchor(rehung, aside_u, (HUNG_AGAIN,), aside_e, slopes=False)
        ends.append(there.mechanical(aside_u, aside_e))
    expected = (ends[0] - ends[1]) / (2 * step)
    wrong = [
        np.linalg.norm(slopes(rehung, u, (HUNG_AGAIN,), e, whole)[k] - expected) / np.linalg.norm(expected)
        for whole in (True, False)
    ]
    assert wrong[0] < 0.02
    assert wrong[1] > missing


def test_slopes_of_the_whole_serve_where_they_were_taken() -> None:
    u, e = np.zeros(3), np.ones(2)
    here = whole_near(u, e, None)
    assert here.whole
    assert whole_near(u + 0.05, e, here) is here
    assert whole_near(u, e + 0.2, here) is not here
    assert whole_near(u, np.ones(1), here) is not here
    assert whole_near(u, e, Origin(u, e)).whole


@pytest.mark.slow
def test_the_error_of_a_shift_knows_how_badly_the_hooks_height_is_known(rehung: Problem) -> None:
    """Only their ratio shows: by slopes of the stated aircraft each seemed to be known by itself."""
    fitted = fit(rehung, (HUNG_AGAIN,), drawn_scores(rehung, 1), HUNG_AGAIN.scores({"shift_x_m": SHIFT_M}), NEAR)
    better = polished(fitted)
    hook = rehung.names.index("hook z")

    def known(found: Fit) -> tuple[float, float]:
        covariance = honest(found).covariance
        sd = np.sqrt(np.diag(covariance))
        return float(sd[-1]), float(covariance[hook, -1] / sd[hook] / sd[-1])

    (before, apart), (after, together) = known(fitted), known(better)
    assert abs(apart) < 0.5 < together
    assert after > 2 * before
    value, std, _ = honest(better).values(0)["shift_x_m"]
    assert abs(value - SHIFT_M) < 2 * std


@pytest.mark.slow
@pytest.mark.parametrize(("torsion", "left"), [(0.0, {"bending"}), (0.08, {"bending", "torsion"})])
def test_a_size_that_nothing_shows_is_left_out(
    tmp_path_factory: pytest.TempPathFactory, torsion: float, left: set[str]
) -> None:
    gives = available_effects()["root-compliance"](bending=0.05, torsion=torsion)
    case = problem(tmp_path_factory.mktemp("cache"), 1, gives)
    start = ROOT.scores({"bending": 0.05, "torsion": max(torsion, 0.004)})
    # From the truth the bottom is near.
    found = fit(case, (ROOT,), drawn_scores(case, 1), start, ((0.0, 6),))
    lean = leaner(found)
    assert set(lean.values(0)) == left
    assert lean.evidence_nats >= found.evidence_nats
    assert lean.hypotheses[0].settings == {"side": "both"} | dict.fromkeys({"bending", "torsion"} - left, 0.0)


def test_only_sizes_of_effects_with_more_than_one_may_go(monkeypatch: pytest.MonkeyPatch) -> None:
    """A mass without its mass is no effect; what holds the aircraft up stays."""
    mass = Hypothesis(available_effects()["added-mass"], {})
    delay = Hypothesis(available_effects()["channel-delay"], {"channels": "response"})
    found: Any = SimpleNamespace(hypotheses=(mass, delay), evidence_nats=1.0)
    assert leaner(found) is found
    both: Any = SimpleNamespace(
        hypotheses=(mass, ROOT), evidence_nats=1.0, e=np.arange(5.0), problem=None, u=np.zeros(2)
    )
    asked = []

    def falls(problem: Any, hypotheses: Any, u: Any, e: Any, *_: Any) -> Any:
        asked.append((dict(hypotheses[1].settings), e.tolist()))
        raise NoStructureError("it falls")

    monkeypatch.setattr(spare_sizes, "fit", falls)
    assert leaner(both) is both
    assert asked == [
        ({"side": "both", "bending": 0.0}, [0.0, 1.0, 2.0, 4.0]),
        ({"side": "both", "torsion": 0.0}, [0.0, 1.0, 2.0, 3.0]),
    ]


def test_which_size_goes_is_a_choice_and_only_the_last_effect_is_asked_where_that_is_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = []

    def fitted(problem: Any, hypotheses: Any, u: Any, e: Any, *_: Any) -> Any:
        asked.append([dict(h.settings) for h in hypotheses])
        return SimpleNamespace(hypotheses=hypotheses, evidence_nats=2.0, chi2=1.0, e=e, problem=None, u=u)

    monkeypatch.setattr(spare_sizes, "fit", fitted)
    monkeypatch.setattr(spare_sizes, "finished", lambda near, _: near)
    shared = replace(ROOT, share=0.5)
    both: Any = SimpleNamespace(
        hypotheses=(ROOT, shared), evidence_nats=1.0, chi2=1.0, e=np.arange(4.0), problem=None, u=np.zeros(2)
    )
    lean = leaner(both, last=True)
    assert [settings[0] for settings in asked] == [{"side": "both"}] * 2
    assert [h.share for h in lean.hypotheses] == [1.0, 0.25]
    assert len(leaner(both).hypotheses[0].parameters) == 1


def test_what_is_far_behind_without_a_size_is_not_gone_on_with(monkeypatch: pytest.MonkeyPatch) -> None:
    found: Any = SimpleNamespace(
        hypotheses=(ROOT,), evidence_nats=1.0, chi2=100.0, e=np.arange(2.0), problem=None, u=np.zeros(2)
    )
    # Bending is needed, torsion is not.
    monkeypatch.setattr(
        spare_sizes,
        "fit",
        lambda problem, hypotheses, *_: SimpleNamespace(
            hypotheses=hypotheses, evidence_nats=0.0, chi2=900.0 if "bending" in hypotheses[0].settings else 300.0
        ),
    )
    gone_on: list[Any] = []
    monkeypatch.setattr(spare_sizes, "finished", lambda near, _: gone_on.append(near) or near)
    assert leaner(found) is found
    assert [f.hypotheses[0].settings for f in gone_on] == [{"side": "both", "torsion": 0.0}]


@pytest.mark.parametrize(("rounds", "linear"), [((), True), ((None,), False)])
def test_without_a_name_or_with_a_joint_that_depends_on_level_nothing_is_told_anew(
    rounds: tuple[None, ...], linear: bool
) -> None:
    found: Any = SimpleNamespace(rounds=rounds, final=SimpleNamespace(hypotheses=(SimpleNamespace(linear=linear),)))
    assert with_told_parameters(found, stored_thresholds()) is found


@pytest.mark.slow
def test_what_is_told_replaces_the_final_fit_and_what_it_leaves(rehung: Problem) -> None:
    whole = replace(HUNG_AGAIN, settings={"from_run": 2})
    start = whole.scores({"shift_x_m": SHIFT_M, "shift_y_m": 0.003})
    final = fit(rehung, (whole,), drawn_scores(rehung, 1), start, NEAR)
    unasked: Any = None
    found = Attribution(final, unasked, (unasked,), final, unasked, (), ())
    told_anew = with_told_parameters(found, stored_thresholds())
    assert told_anew.final.hypotheses[0].settings == HUNG_AGAIN.settings
    assert told_anew.final_residual.train_chi2_per_dof == pytest.approx(told_anew.final.chi2_per_dof)
    assert told_anew.null is final


@dataclass(frozen=True)
class Stub:
    """A fit by hand, by some slopes."""

    cost: float
    by: str = "whole"
    converged: bool = True
    problem: Any = None
    hypotheses: tuple[Any, ...] = ()
    u: Any = None
    e: Any = None


def test_a_fit_that_whole_slopes_make_worse_stays_where_it_is_with_errors_by_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By other slopes a size seemed three times as well known as it was."""
    here = Stub(10.0, "others")
    for more, kept in ((Stub(11.0), Stub(10.2, "there")), (Stub(9.0), Stub(9.0))):
        there = Stub(10.2, "there", converged=False)
        monkeypatch.setattr(told, "fit", lambda *given, whole, m=more, t=there: m if given[4] else t)
        assert polished(here) == kept  # type: ignore[arg-type]

    def falls(*_: Any, whole: bool) -> Any:
        raise NoStructureError("it falls")

    monkeypatch.setattr(told, "fit", falls)
    assert polished(here) is here  # type: ignore[arg-type, comparison-overlap]


def test_intervals_are_straight_in_scores(rehung: Problem) -> None:
    """A positive size is as far from its ends by a factor, a signed one by a difference."""
    mass = Hypothesis(available_effects()["added-mass"], {"x_m": 0.7})
    found = fit(rehung, (mass,), np.zeros(rehung.size), mass.scores({"mass_kg": 0.05, "y_m": 0.4}), ())
    values, ends = found.values(0), found.ranges(0)
    assert ends["mass_kg"][1] / values["mass_kg"][0] == pytest.approx(values["mass_kg"][0] / ends["mass_kg"][0])
    assert np.mean(ends["y_m"]) == pytest.approx(values["y_m"][0])
    assert np.diff(ends["y_m"])[0] == pytest.approx(2 * 1.96 * values["y_m"][1], rel=1e-3)


@pytest.mark.slow
def test_the_verdict_tells_what_it_names_without_the_spare_size() -> None:
    """Of a root that gives way in bending alone, through the whole loop, to the scenario that is written back."""
    scenario = small_scenario()
    softer = available_effects()["root-compliance"](bending=0.05)
    known = {"root-compliance": available_effects()["root-compliance"]}
    verdict = reconcile(campaign_of(scenario, 1, softer), scenario, effects=known, lines=60)
    (named,) = verdict.effects
    assert named.settings == {"side": "both", "torsion": 0.0}
    assert set(named.parameters) == set(named.ranges) == {"bending"}
    low, high = named.ranges["bending"]
    assert low < named.parameters["bending"][0] < high
    table, *gains = verdict.scenario.effect
    assert table.name == "root-compliance" and dict(table)["torsion"] == 0.0
    # What was calibrated of the instruments is written back, too.
    assert {gain.name for gain in gains} == {"channel-gain"}
    # Twice as many cells are in its error: there are no stretches here.
    final = verdict.attribution.final
    assert final.unseen is not None and final.unseen.shape == (1, final.scores.size)
    narrow = honest(replace(final, unseen=None)).values(0)["bending"][1]
    assert named.parameters["bending"][1] > narrow > 0
    # It was judged without it, too.
    assert verdict.attribution.rounds[0].winner.hypothesis.settings == named.settings
