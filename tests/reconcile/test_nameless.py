"""A smooth law at one place: what a thing there does, however large, and fitted with all that is uncertain."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.evidence import nameless, nameless_descent
from vgvt.reconcile.evidence.confirmation import not_spoken_against
from vgvt.reconcile.evidence.free_places import ON_BOTH_SIDES, free_places, on_centre_line, with_mirror_images
from vgvt.reconcile.evidence.lasting import lasting_evidence
from vgvt.reconcile.evidence.nameless import Nameless, with_nameless
from vgvt.reconcile.evidence.nameless_descent import Slopes, State
from vgvt.reconcile.evidence.smooth_law import TERMS, SmoothLaw, law_terms
from vgvt.reconcile.evidence.still_explained import StillExplained, still_explained
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.fitting.misfit import data_misfit, jacobian, standardised
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem

KNOWN = available_effects()
LARGE, SMALL = 20.0, 2.0
ALWAYS = (1.0, 1.0, 1.0, 1.0)


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    scenario = roving_scenario()
    return make_problem(campaign_of(scenario, 3), scenario, lines=120, cache=tmp_path_factory.mktemp("cache"))


def point(case: Problem, node: int) -> tuple[str, float, float]:
    """The label of a free place at a node, and where it is."""
    (found,) = (p for p in case.layouts.first.grid if p.dof.node == node)
    return f"force at {found.dof}", float(found.position_m[0]), float(found.position_m[1])


def damped(case: Problem, *nodes: int, damping: float = LARGE) -> Fit:
    """The stated aircraft with a damper to the ground at each of some nodes."""
    damper = Hypothesis(KNOWN["nonproportional-damper"], {})
    sizes = []
    for node in nodes:
        _, x, y = point(case, node)
        sizes.append(damper.scores({"damping_n_s_per_m": damping, "x_m": x, "y_m": y}))
    return fit(case, (damper,) * len(nodes), np.zeros(case.size), np.concatenate([np.zeros(0), *sizes]), ())


def changed(case: Problem, label: str, course: tuple[float, ...], law: Any) -> tuple[Any, Any, Any]:
    """A/F without a law, with it, and its slopes in the law."""
    u, e = np.zeros(case.size), np.zeros(0)
    here = anchor(case, u, (), e)
    places = with_mirror_images(free_places(case, here, case.split.train))[label]
    acting = SmoothLaw(places, np.array(course))
    return here.predict(u, e), acting.on(here, law).predict(u, e), acting.by_law(here, law, u, e)


def test_a_law_is_exact_however_large(plain: Problem) -> None:
    """A damper that changes A/F manifold, against the structure assembled with it; to first order it would be lost."""
    label, *_ = point(plain, 18)
    law = 2j * np.pi * plain.measured.frequency_hz * LARGE
    without, found, _ = changed(plain, label, ALWAYS, law)
    wanted = damped(plain, 18).predicted
    size = np.linalg.norm(wanted - without)
    _, _, slopes = changed(plain, label, ALWAYS, 0 * law)
    assert np.linalg.norm(without + slopes * law - wanted) > 0.5 * size
    # A sensor's row makes up for cells, and where a damper is fixed none does.
    assert np.linalg.norm(found - wanted) < 0.02 * size


def test_two_that_are_mirror_images_know_of_each_other(plain: Problem) -> None:
    left = next(p for p in plain.layouts.first.grid if p.dof.node == 18)
    x, y, _ = left.position_m
    (right,) = (p.dof.node for p in plain.layouts.first.grid if np.allclose(p.position_m[:2], (x, -y)))
    label, *_ = point(plain, 18 if y > 0 else right)
    law = 2j * np.pi * plain.measured.frequency_hz * LARGE
    without, found, _ = changed(plain, label + ON_BOTH_SIDES, ALWAYS, law)
    wanted = damped(plain, 18, right).predicted
    size = np.linalg.norm(wanted - without)
    assert np.linalg.norm(found - wanted) < 0.02 * size
    # Neither alone, nor the sum of what each does alone, is that.
    (one, other) = (changed(plain, point(plain, node)[0], ALWAYS, law)[1] for node in (18, right))
    assert np.linalg.norm(one + other - without - wanted) > 0.1 * size


@pytest.mark.parametrize("label", ["force at 18+Z", "force channel", "sensor-2 in every run"])
def test_slopes_are_those_of_differences_and_a_course_says_in_which_runs(plain: Problem, label: str) -> None:
    line = plain.measured.frequency_hz
    law, course = (3.0 + 0.5j * line) * (1.0 if "force at" in label else 0.01), (0.0, 0.5, 1.0, 0.0)
    step = 1e-6 * np.abs(law).max()
    without, found, slopes = changed(plain, label, course, law)
    _, more, _ = changed(plain, label, course, law + step)
    assert (more - found) / step == pytest.approx(slopes, rel=1e-4, abs=1e-4 * np.abs(slopes).max())
    run_of = np.array([c.run for c in plain.measured.channels])
    moved = np.abs(found - without).max(axis=1) > 1e-9 * np.abs(without).max()
    assert set(run_of[moved]) == {1, 2}
    # What creeps acts in part: half of the law in the second run.
    _, half, _ = changed(plain, label, ALWAYS, 0.5 * law)
    assert found[run_of == 1] == pytest.approx(half[run_of == 1])


@pytest.mark.parametrize("label", ["force at 18+Z", "factor"])
def test_slopes_in_all_that_is_uncertain_know_of_the_law(plain: Problem, label: str) -> None:
    """Against differences of predictions with the law in place; without it they would be of another response."""
    rng = np.random.default_rng(2)
    where, line = {"factor": "force channel"}.get(label, label), plain.measured.frequency_hz
    law = 2j * np.pi * line * LARGE if where == label else 0.5 * np.exp(0.1j * line)
    u, e = 0.3 * rng.standard_normal(plain.size), np.zeros(0)

    def on(scores: Any) -> Any:
        here = anchor(plain, scores, (), e)
        places = with_mirror_images(free_places(plain, here, plain.split.train))[where]
        return here, SmoothLaw(places, np.array(ALWAYS)).on(here, law)

    here, there = on(u)
    keep, step, predicted = plain.split.train, 1e-3, there.predict(u, e)
    slopes, without = (jacobian(model, u, e, predicted) for model in (there, here))
    known, told = len(plain.unknowns), []
    for k in [*range(0, known, 3), known]:
        sides = []
        for way in (step, -step):
            moved = u.copy()
            moved[k] += way
            sides.append(standardised(plain, on(moved)[1].predict(moved, e)[keep]).ravel())
        change = (sides[0] - sides[1]) / (2 * step)
        wanted = np.sqrt(2) * np.concatenate([change.real, change.imag])
        size = np.linalg.norm(wanted)
        if size > 1:
            told.append([np.linalg.norm(of[:, k] - wanted) / size for of in (slopes, without)])
    assert len(told) > 5
    assert np.max(told, axis=0)[0] < 0.05
    assert np.median(told, axis=0)[0] < 0.01
    assert np.median(told, axis=0)[1] > 0.2


def test_a_law_is_known_as_well_as_all_that_is_uncertain_leaves_it(plain: Problem) -> None:
    """And the scores as well as the law leaves them: both are blocks of one covariance."""
    u, e = np.zeros(plain.size), np.zeros(0)
    here = anchor(plain, u, (), e)
    places = with_mirror_images(free_places(plain, here, plain.split.train))[point(plain, 18)[0]]
    acting, terms = SmoothLaw(places, np.array(ALWAYS)), law_terms(plain.measured.frequency_hz)
    slopes = Slopes.of(State.at(here, acting, terms, u, e, np.zeros(TERMS, dtype=complex)))
    whole, law = np.linalg.inv(slopes.normal), slice(-2 * TERMS, None)
    known = whole[law, law] * np.outer(slopes.unit, slopes.unit)
    found = np.linalg.inv(slopes.of_law)
    assert np.diag(found) == pytest.approx(np.diag(known), rel=1e-3)
    # If nothing else were uncertain it would be known better.
    alone = np.linalg.inv(slopes.normal[law, law]) * np.outer(slopes.unit, slopes.unit)
    ratio = np.diag(known) / np.diag(alone)
    assert (ratio > 1.01).all() and ratio.max() > 5
    assert slopes.covariance == pytest.approx(whole[: plain.size, : plain.size], abs=1e-6)


def test_something_on_the_body_is_among_the_places(plain: Problem) -> None:
    """A damper on the nose is no force at any sensor, and was found at none."""
    here = anchor(plain, np.zeros(plain.size), (), np.zeros(0))
    labels = [p.label for p in free_places(plain, here, plain.split.train)]
    x = on_centre_line(plain)[-1][0]
    label = f"force on the body at x = {x:.2f} m"
    assert label in labels
    law = 2j * np.pi * plain.measured.frequency_hz * LARGE
    without, found, _ = changed(plain, label, ALWAYS, law)
    damper = Hypothesis(KNOWN["nonproportional-damper"], {"x_m": x, "y_m": 0.0})
    wanted = fit(plain, (damper,), np.zeros(plain.size), damper.scores({"damping_n_s_per_m": LARGE}), ()).predicted
    assert np.linalg.norm(found - wanted) < 0.01 * np.linalg.norm(wanted - without)


def with_data(case: Fit, seed: int) -> Problem:
    """The problem whose data a model foretells, with noise of what it is judged by."""
    measured = case.problem.measured
    noise = np.random.default_rng(seed).standard_normal((2, *measured.values.shape)) / np.sqrt(2)
    values = case.predicted + measured.sigma * (noise[0] + 1j * noise[1])
    return replace(case.problem, measured=replace(measured, values=values))


def searched(case: Problem, where: StillExplained, worthless: float = np.inf) -> Nameless:
    found = with_nameless(case, (), np.zeros(case.size), np.zeros(0), where, worthless)
    assert found is not None
    return found


def test_it_is_fitted_from_nothing_where_a_law_shows_and_is_what_is_there(plain: Problem) -> None:
    case = with_data(damped(plain, 18, damping=SMALL), 0)
    null = fit(case, (), np.zeros(case.size), np.zeros(0), ())
    where = still_explained(null)
    assert where is not None
    found = searched(case, replace(where, label=point(plain, 18)[0], course=ALWAYS))
    assert null.chi2_per_dof > 20
    assert found.chi2_per_dof == pytest.approx(1, abs=0.1)
    assert found.held_out_chi2_per_dof == pytest.approx(1, abs=0.25)
    wanted = 2j * np.pi * plain.measured.frequency_hz * SMALL
    assert np.linalg.norm(found.law.values - wanted) < 0.1 * np.linalg.norm(wanted)
    assert "force at 18+Z that is smooth over frequency" in found.in_words
    assert str(null.chi2_per_dof) not in found.in_words


@pytest.mark.parametrize(("course", "when"), [((0.0, 0.0, 1.0, 1.0), "from run 3"), ((0.0, 0.0, 0.0, 1.0), "in run 4")])
def test_of_courses_that_are_one_where_fitted_it_has_the_one_that_meets_held_out_data(
    plain: Problem, course: tuple[float, ...], when: str
) -> None:
    """Of four runs the third is held out: fitted alone it was "in run 4 alone", and the third refused it."""
    label, *_ = point(plain, 8)
    law = 2j * np.pi * plain.measured.frequency_hz * SMALL
    _, there, _ = changed(plain, label, course, law)
    null = fit(plain, (), np.zeros(plain.size), np.zeros(0), ())
    null = fit(with_data(replace(null, predicted=there), 0), (), np.zeros(plain.size), np.zeros(0), ())
    where = still_explained(null)
    assert where is not None and where.label == label
    assert {where.when, *(s.when for s in where.alike)} == {"from run 3 on", "in run 4 alone"}
    found = searched(null.problem, where)
    assert found.where.when.startswith(when) and found.where.course == course and not found.where.alike
    assert found.held_out_chi2_per_dof == pytest.approx(1, abs=0.25)
    assert not_spoken_against(found, null)
    # As it was: the other one misses what is held out, and all that is fitted is the same.
    for other in (where, *where.alike):
        alone = searched(null.problem, replace(other, alike=()))
        assert alone.predicted[plain.split.train] == pytest.approx(found.predicted[plain.split.train])
        assert alone.evidence_nats == pytest.approx(found.evidence_nats)
        missed = alone.held_out_chi2_per_dof
        assert missed is not None and (missed < 2) is (other.course == course)


def test_its_evidence_is_laplaces_of_all_that_is_uncertain(plain: Problem) -> None:
    """Where the law changes nothing that is there, that of the fit without it."""
    case = with_data(fit(plain, (), np.zeros(plain.size), np.zeros(0), ()), 1)
    where = StillExplained(point(plain, 18)[0], "structure", 0.0, "", ALWAYS, 1)
    found = searched(case, where)
    null = fit(case, (), found.u, np.zeros(0), NEAR)
    taken = 0.5 * (null.chi2 + null.u @ null.u - found.cost)
    # Eight values of noise are worth four nats.
    assert 0 < taken < 15
    assert found.evidence_nats - null.evidence_nats == pytest.approx(taken, abs=1)


def test_what_lasting_errors_leave_to_gain_is_asked_of_it_with_its_law(
    plain: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At its own scores it answers what it leaves, and where nothing hangs nothing."""
    asked: list[Any] = []

    def spied(*arguments: Any, aside: Any) -> float:
        asked.append(aside)
        return lasting_evidence(*arguments, aside=aside)

    monkeypatch.setattr(nameless, "lasting_evidence", spied)
    case = with_data(damped(plain, 18, damping=SMALL), 0)
    found = searched(case, StillExplained(point(plain, 18)[0], "structure", 0.0, "", ALWAYS, 1))
    (aside,) = asked
    np.testing.assert_allclose(aside(found.scores), data_misfit(case, found.predicted), atol=1e-6)
    # The law stays: without it the model is another one.
    bare = fit(case, (), found.u, np.zeros(0), ())
    assert np.linalg.norm(aside(found.scores)) < 0.5 * np.sqrt(bare.chi2)
    assert aside(np.full(found.scores.size, 1e6)) is None


def test_what_will_not_do_is_not_gone_on_with(plain: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a free step promises far too little it is given up, and what it has got to is told."""
    case = with_data(damped(plain, 18, damping=SMALL), 0)
    where = StillExplained(point(plain, 18)[0], "structure", 0.0, "", ALWAYS, 1)
    steps, lower = [], nameless_descent._lower
    monkeypatch.setattr(nameless_descent, "_lower", lambda *args: steps.append(args) or lower(*args))
    through = searched(case, where)
    whole = len(steps)
    given_up = searched(case, where, worthless=-1e9)
    # Peaks that are apart promise little at first: the third step is the first to be asked.
    assert len(steps) - whole == 3 < whole
    assert given_up.cost > through.cost
    # What it needs is within its reach: the same to the end.
    assert searched(case, where, worthless=1.01 * through.cost).cost == through.cost


def test_there_is_none_where_there_is_no_such_place(plain: Problem) -> None:
    where = StillExplained("force at 99+Z", "structure", 0.0, "", ALWAYS, 1)
    assert with_nameless(plain, (), np.zeros(plain.size), np.zeros(0), where) is None


def test_held_out_data_speak_against_what_misses_them(plain: Problem) -> None:
    case = with_data(damped(plain, 18, damping=SMALL), 0)
    names = fit(case, (), np.zeros(case.size), np.zeros(0), ())
    where = StillExplained(point(plain, 18)[0], "structure", 0.0, "", ALWAYS, 1)
    found = searched(case, where)
    assert not_spoken_against(found, names)
    # What foretells the same is not spoken against, nor is what differs by less than chance.
    same = replace(found, predicted=names.predicted)
    assert not_spoken_against(same, names)
    worse = found.predicted.copy()
    worse[case.split.held] = names.predicted[case.split.held] * 1.5
    assert not not_spoken_against(replace(found, predicted=worse), names)


def test_what_is_foretold_leaves_a_held_out_channels_own_gain_open(plain: Problem) -> None:
    """As of a fit: what no other record can tell is not held against it."""
    case = with_data(fit(plain, (), np.zeros(plain.size), np.zeros(0), ()), 1)
    null = fit(case, (), np.zeros(case.size), np.zeros(0), ())
    found = replace(
        searched(case, StillExplained("force channel", "drive", 0.0, "", ALWAYS, 1)), predicted=null.predicted
    )
    assert found.foretold == pytest.approx(null.foretold)
    assert found.held_out_chi2_per_dof == pytest.approx(null.held_out_chi2_per_dof)
    assert found.chi2_per_dof == pytest.approx(null.chi2_per_dof)
