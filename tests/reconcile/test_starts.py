"""Where a candidate's fit starts."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import drawn_scores, problem

from vgvt.effects.added_mass import AddedMass
from vgvt.effects.local_absorber import LocalAbsorber
from vgvt.effects.root_compliance import RootCompliance
from vgvt.effects.suspension_surge import SuspensionSurge
from vgvt.reconcile.evidence import rivals
from vgvt.reconcile.evidence.rivals import against
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import NEAR, Fit, cost_at, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import SMOOTHED, stored_thresholds
from vgvt.reconcile.search import candidate_fits
from vgvt.reconcile.search.screened import Screened, parted
from vgvt.reconcile.search.stand import Stand

THERE, ELSEWHERE = {"x_m": 0.9, "y_m": 1.1}, {"x_m": 0.9, "y_m": -1.1}


@pytest.fixture(scope="module")
def named(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """A scenario whose added mass has its name already."""
    case = problem(tmp_path_factory.mktemp("cache"), 1, AddedMass(mass_kg=0.04, **THERE))
    hypothesis = Hypothesis(AddedMass, THERE)
    return fit(case, (hypothesis,), drawn_scores(case, 1), hypothesis.scores({"mass_kg": 0.04}), NEAR)


def test_a_second_effect_starts_with_the_first_where_the_screen_moved_it(named: Fit) -> None:
    """What the first effect gives way by belongs to the start: without it the misfit there is another one."""
    second = Hypothesis(AddedMass, ELSEWHERE)
    followed = Stand.of(named).followed(second, {"mass_kg": 0.01})
    assert followed is not None
    scores = followed[1]
    assert scores.shape == named.scores.shape
    assert abs(scores[-1] - named.e[0]) > 0
    _, u, e = candidate_fits._start(named, Screened(second, {"mass_kg": 0.01}, 1.0, start=scores))
    assert np.array_equal(np.concatenate([u, e[: named.e.size]]), scores)
    fixed = Hypothesis(AddedMass, {**ELSEWHERE, "mass_kg": 0.01})
    both = (*named.hypotheses, fixed)
    assert cost_at(named.problem, both, u, e[: named.e.size]) < 0.5 * cost_at(named.problem, both, u, named.e)


def test_a_fit_sets_out_from_the_better_start(named: Fit, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the screen's straight lines lead astray, from little of the effect beside the model as it is."""
    seen: list[Any] = []

    def spy(problem: Any, hypotheses: Any, u: Any, e: Any, stages: Any, tell: Any) -> Any:
        seen.append((u, e))
        return named

    monkeypatch.setattr(candidate_fits, "fit", spy)
    second = Hypothesis(AddedMass, ELSEWHERE)
    astray = named.scores + 3.0
    candidate_fits.fitted_from(named, Screened(second, {"mass_kg": 0.01}, 1.0, start=astray), NEAR, lambda f, m: None)
    u, e = seen[0]
    assert np.array_equal(u, named.u) and np.array_equal(e[: named.e.size], named.e)
    here = Hypothesis(AddedMass).values(e[named.e.size :])
    assert here["mass_kg"] < 0.01


@pytest.mark.parametrize(("stated_nats", "from_stated"), [(-400.0, True), (-40_000.0, False)])
def test_far_off_a_candidate_begins_where_a_few_steps_do_best(
    named: Fit, monkeypatch: pytest.MonkeyPatch, stated_nats: float, from_stated: bool
) -> None:
    """Where the screen stood, or where peaks overlap, with what is named already as it is."""
    asked: list[Any] = []

    def fitted(problem: Any, hypotheses: Any, u: Any, e: Any, stages: Any, tell: Any, judged: float) -> Any:
        asked.append((u, e, stages[0][0], stages[-1][0], judged))
        return SimpleNamespace(evidence_nats=-10_000.0 if u.any() else stated_nats, u=u)

    monkeypatch.setattr(candidate_fits, "fit", fitted)
    monkeypatch.setattr(candidate_fits, "rough_start", lambda problem, hypotheses, e: (np.zeros(named.u.size), e))
    second = Hypothesis(AddedMass, ELSEWHERE)
    scores = np.concatenate([np.full(named.u.size, 12.0), named.e])
    found = candidate_fits._begun(named, Screened(second, {"mass_kg": 0.01}, 1.0, start=scores), lambda f, m: None)
    assert found is not None
    assert found.u.any() != from_stated
    (screened, one, coarse, last, judged), (stated, other, coarser, same, alike) = asked
    assert (screened == 12.0).all() and not stated.any()
    assert np.array_equal(one, other)
    assert one[0] == named.e[0]
    # Both judged by what they end with; from where peaks overlap steps forgive more at first.
    assert 0 < coarse == last == same == judged == alike < coarser


def test_a_size_that_is_left_to_its_prior_has_no_part() -> None:
    """A start at the frequency that the residual shows says nothing of a size."""
    tuned = Screened(Hypothesis(LocalAbsorber, THERE), {"frequency_hz": 9.0}, 1.0)
    assert parted(tuned, 0.125) == {"frequency_hz": 9.0}
    sized = Screened(Hypothesis(LocalAbsorber, THERE), {"frequency_hz": 9.0, "mass_kg": 0.08}, 1.0)
    assert parted(sized, 0.125) == {"frequency_hz": 9.0, "mass_kg": pytest.approx(0.01)}


def judged_alone(noise: float, chi2: float, evidence_nats: float, lasting_nats: float = 50.0) -> Any:
    """A fit as a rival of one that leaves χ² of 1600, where ``noise`` is a share of what both are judged by.

    ``lasting_nats`` are its evidence where an error of the model lasts; that of the other is 20.
    """
    g = np.random.default_rng(0)
    shape = (8, 100)
    white = g.standard_normal(shape) + 1j * g.standard_normal(shape)
    measured = SimpleNamespace(
        values=np.ones(shape, complex), sigma=np.ones(shape), noise=np.full(shape, noise), of_force=None
    )
    split = SimpleNamespace(train=np.ones(8, bool), held=np.zeros(8, bool))
    found: Any = SimpleNamespace(
        problem=SimpleNamespace(measured=measured, split=split), predicted=1 + white, points=1600, chi2=chi2,
        evidence_nats=evidence_nats, lasting_nats=lasting_nats, held_out_chi2_per_dof=None,
    )  # fmt: skip
    null: Any = SimpleNamespace(chi2=1600.0, evidence_nats=0.0, lasting_nats=20.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rivals, "lasting_nats", lambda fit: fit.lasting_nats)
        (rival,) = against(null, [found])
    return rival


def test_what_a_fit_loses_counts_whole_whatever_its_gain_would_be_worth() -> None:
    """Astray, a fit keeps every tolerance that a bent calibration gave away: that is no evidence for it."""
    lost = judged_alone(0.0, chi2=3600.0, evidence_nats=-700.0)
    assert lost.gain_nats == lost.raw_nats == -700.0


def test_a_model_error_that_is_mended_is_not_paid_for_on_every_line() -> None:
    """The same fall of χ², judged by noise alone or by the declared error of the model alone."""
    gains = []
    for noise in (1.0, 0.0):
        rival = judged_alone(noise, chi2=1500.0, evidence_nats=50.0)
        gains.append(rival.gain_nats)
        assert rival.raw_nats == 50.0
    # 100 of χ² are 50 nats; white residuals of eight channels are worth nearly all of their lines.
    assert 40 < gains[0] <= 50
    assert gains[1] == pytest.approx(gains[0] / SMOOTHED, rel=1e-6)


def test_a_name_is_given_for_what_either_view_of_the_models_error_grants() -> None:
    """Forty nats line by line are no name where an error that lasts would be worth them, nor the other way round."""
    limits = stored_thresholds()
    told = judged_alone(1.0, chi2=1500.0, evidence_nats=50.0, lasting_nats=30.0)
    assert told.lasting_nats == 10.0 < told.gain_nats
    assert told.convinces(replace(limits, evidence_nats=9.0))
    assert not told.convinces(replace(limits, evidence_nats=11.0))
    little = judged_alone(1.0, chi2=1500.0, evidence_nats=8.0, lasting_nats=80.0)
    assert little.lasting_nats == 60.0
    assert not little.convinces(replace(limits, evidence_nats=9.0))


def test_two_starts_of_an_effect_that_have_met_are_one_finalist(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same bottom of the same effect is fitted to its end once; another effect's as deep one, too."""
    nats = iter([-10.0, -10.4, -10.2, -30.0, -40.0, -50.0])
    other = Hypothesis(LocalAbsorber, ELSEWHERE)
    chosen = [Screened(Hypothesis(AddedMass, ELSEWHERE), {}, 1.0)] * 2 + [Screened(other, {}, 1.0)] * 4

    def begun(current: Any, s: Screened, tell: Any) -> Any:
        return SimpleNamespace(evidence_nats=next(nats), values=lambda k: {}, scores=np.zeros(2))

    monkeypatch.setattr(candidate_fits, "_begun", begun)
    current: Any = SimpleNamespace(hypotheses=(), scores=np.zeros(2))
    found = candidate_fits.finalists(current, chosen, lambda f, m: None)
    assert [s.hypothesis.name for s in found] == ["added-mass", *["local-absorber"] * 3]


@pytest.mark.parametrize(
    ("settings", "values", "kept"),
    [
        (({"side": "left"}, {"side": "right"}), ({}, {}), 2),
        (({"side": "left"}, {"side": "left"}), ({}, {}), 1),
        (
            ({"x_m": 0.5, "y_m": 0.9}, {"x_m": 0.5, "y_m": -0.9}),
            ({"x_m": 0.52, "y_m": 0.9}, {"x_m": 0.5, "y_m": 0.8}),
            1,
        ),
        (
            ({"x_m": 0.5, "y_m": 0.9}, {"x_m": 0.5, "y_m": -0.9}),
            ({"x_m": 0.5, "y_m": 0.9}, {"x_m": 0.5, "y_m": -0.9}),
            2,
        ),
    ],
)
def test_other_variants_of_an_effect_have_not_met_however_alike_they_do(
    monkeypatch: pytest.MonkeyPatch, settings: Any, values: Any, kept: int
) -> None:
    """Of either side, or at places that are apart, they are two; of two grid points that came to one place one."""
    cls = AddedMass if "x_m" in settings[0] else RootCompliance
    chosen = [Screened(Hypothesis(cls, s), {}, 1.0) for s in settings]

    def begun(current: Any, s: Screened, tell: Any) -> Any:
        there = values[[c is s for c in chosen].index(True)]
        return SimpleNamespace(
            evidence_nats=-10.0, values=lambda k: {n: (v, 0.0, "m") for n, v in there.items()}, scores=np.zeros(2)
        )

    monkeypatch.setattr(candidate_fits, "_begun", begun)
    current: Any = SimpleNamespace(hypotheses=(), scores=np.zeros(2))
    assert len(candidate_fits.finalists(current, chosen, lambda f, m: None)) == kept


@pytest.mark.slow
def test_a_sharp_resonance_that_moves_with_an_unknown_is_reached(tmp_path_factory: pytest.TempPathFactory) -> None:
    """A heavy spring's surges follow its stiffness: a calibration without them bends far, and tangents lead nowhere."""
    case = problem(tmp_path_factory.mktemp("cache"), 3, SuspensionSurge(mass_kg=0.4, loss_factor=0.007))
    bent = calibrate(case)
    assert bent.chi2_per_dof > 10
    start = Screened(Hypothesis(SuspensionSurge), {"mass_kg": 0.38}, 1.0)
    reached = candidate_fits._begun(bent, start, lambda f, m: None)
    assert reached is not None
    assert reached.values(0)["mass_kg"][0] == pytest.approx(0.4, rel=0.06)
    assert reached.chi2_per_dof < 0.2
