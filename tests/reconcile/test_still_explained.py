"""A law at one place that explains what a name leaves: seen where another thing sits there, not where nothing does."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from lead_case import found as found_by
from lead_case import left
from reconciled_case import campaign_of, roving_scenario

from vgvt.effects import available_effects
from vgvt.reconcile.decision import beyond_names
from vgvt.reconcile.decision.beyond_names import asked_beyond_names
from vgvt.reconcile.decision.leads import why_no_name
from vgvt.reconcile.decision.one_level import bends_at_one_level
from vgvt.reconcile.evidence import still_explained as evidence
from vgvt.reconcile.evidence.free_places import ON_BOTH_SIDES, FreePlace, free_places, mirror_images
from vgvt.reconcile.evidence.smooth_law import law_terms
from vgvt.reconcile.evidence.still_explained import (
    StillExplained,
    _columns,
    _courses,
    _views,
    still_explained,
    surprise,
)
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import FAR, NEAR, TO_THE_END, Fit, fit
from vgvt.reconcile.fitting.misfit import data_misfit
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem

PLACE = {"x_m": 0.82, "y_m": 1.05}
KNOWN = available_effects()


@pytest.fixture(scope="module")
def damped(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A campaign with a damper to the ground on a wing."""
    scenario = roving_scenario()
    damper = KNOWN["nonproportional-damper"](damping_n_s_per_m=1.0, **PLACE)
    cache = tmp_path_factory.mktemp("cache")
    return make_problem(campaign_of(scenario, 3, damper), scenario, lines=160, cache=cache)


@pytest.fixture(scope="module")
def null(damped: Problem) -> Fit:
    return calibrate(damped)


def fitted(null: Fit, name: str, values: dict[str, float]) -> Fit:
    hypothesis, case = Hypothesis(KNOWN[name], {}), null.problem
    begun = fit(case, (hypothesis,), null.u, hypothesis.scores({**values, **PLACE}), FAR)
    return fit(case, (hypothesis,), begun.u, begun.e, (*NEAR, *TO_THE_END))


@pytest.fixture(scope="module")
def right(null: Fit) -> Fit:
    return fitted(null, "nonproportional-damper", {"damping_n_s_per_m": 0.8})


def test_the_right_name_leaves_nothing_to_explain(right: Fit) -> None:
    still = still_explained(right)
    assert still is not None
    assert still.nats < 0


def test_an_absorber_bent_into_a_damper_does(null: Fit) -> None:
    bent = fitted(null, "local-absorber", {"mass_kg": 0.07, "frequency_hz": 2.5, "damping_ratio": 0.5})
    still = still_explained(bent)
    assert still is not None
    assert still.nats > 9


def with_noise(case: Fit, seed: int, factor: Any = 1.0) -> Fit:
    """The same model and data that it foretells, times a factor on A/F (C, L), with noise of what it is judged by."""
    measured = case.problem.measured
    noise = np.random.default_rng(seed).standard_normal((2, *measured.values.shape)) / np.sqrt(2)
    values = case.predicted * factor + measured.sigma * (noise[0] + 1j * noise[1])
    problem = replace(case.problem, measured=replace(measured, values=values))
    return fit(problem, case.hypotheses, case.u, case.e, ())


def test_noise_is_hardly_ever_explained(right: Fit) -> None:
    nats = [found.nats for k in range(8) if (found := still_explained(with_noise(right, k)))]
    assert len(nats) == 8
    # At any of the places, chance does as much in one of exp(nats).
    assert max(nats) < 3


def test_a_factor_on_one_sensor_is_seen_where_it_is(damped: Problem, right: Fit) -> None:
    mine = np.flatnonzero(damped.split.train)[3]
    line = np.log(damped.measured.frequency_hz)
    factor = np.ones(damped.measured.values.shape, dtype=complex)
    factor[mine] += 0.06j * (line - line.mean())
    still = still_explained(with_noise(right, 0, factor))
    assert still is not None
    assert still.words == f"factor on {damped.measured.channels[mine].label}"
    assert still.nats > 9


@pytest.mark.parametrize(
    ("runs", "when"), [((0, 1, 2, 3), ""), ((1, 2, 3), " from run 2 on"), ((1,), " in run 2 alone")]
)
def test_a_law_that_acts_in_some_runs_is_seen_there(
    damped: Problem, right: Fit, runs: tuple[int, ...], when: str
) -> None:
    """What the force gauge reads of what it is pushed with, turned by a fifth of a radian at the ends of the band."""
    line = np.log(damped.measured.frequency_hz)
    run_of = np.array([c.run for c in damped.measured.channels])
    factor = 1 + 0.15j * (line - line.mean()) ** 2 * np.isin(run_of, runs)[:, None]
    still = still_explained(with_noise(right, 0, factor))
    assert still is not None
    assert still.words == f"factor on the force channel{when}"
    assert still.nats > 9


def test_what_acts_on_both_sides_is_seen_there_at_once(
    damped: Problem, right: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two dampers, as an aircraft has of most things: a law on either side explains the half of it."""
    damper = Hypothesis(KNOWN["nonproportional-damper"], {})
    sizes = [damper.scores({"damping_n_s_per_m": 3.0, **PLACE, "y_m": side * PLACE["y_m"]}) for side in (1, -1)]
    both = fit(damped, (damper, damper), right.u, np.concatenate(sizes), ())
    none = fit(damped, (), right.u, np.zeros(0), ())
    case = with_noise(none, 0, both.predicted / none.predicted)
    still = still_explained(case)
    assert still is not None
    assert still.words.startswith("force at ") and still.words.endswith(ON_BOTH_SIDES)
    monkeypatch.setattr(evidence, "mirror_images", lambda places: [])
    still_explained.cache_clear()
    single = still_explained(case)
    assert single is not None
    assert single.nats < still.nats - 9


def test_mirror_images_move_alike_on_either_side() -> None:
    def place(y: float | None, motion: str, x: float = 0.5) -> FreePlace:
        at = None if y is None else (x, y, 0.0)
        return FreePlace(f"{motion} at {x} {y}", "structure", at, None, None, motion=motion)

    sides = [place(y, motion) for motion in ("PLUS_Z", "PLUS_X", "bending") for y in (-1.0, 1.0)]
    alone = [place(0.0, "PLUS_Z"), place(None, "PLUS_Z"), place(1.2, "PLUS_Z"), place(-1.2, "PLUS_Z", x=0.6)]
    assert mirror_images(sides + alone) == [(1, 0), (3, 2), (5, 4)]


def test_runs_are_called_by_the_numbers_that_the_campaign_gives_them() -> None:
    """Of runs 1, 2, 5 and 7 the third is run 5, as in every label of its channels."""
    place: Any = SimpleNamespace(kind="structure")
    courses = dict(_courses(place, np.arange(4), np.arange(4), dict(enumerate((1, 2, 5, 7)))))
    assert list(courses) == [
        "", "from run 2 on", "from run 5 on", "in run 1 alone", "in run 2 alone", "in run 5 alone", "in run 7 alone",
        "more from run to run", "more from run to run, ever more slowly",
    ]  # fmt: skip
    assert courses["from run 5 on"] == pytest.approx([0, 0, 1, 1])
    assert courses["in run 2 alone"] == pytest.approx([0, 1, 0, 0])
    assert courses["more from run to run"] == pytest.approx([0, 1 / 3, 2 / 3, 1])


def test_a_course_is_the_law_by_so_much_in_each_run(damped: Problem, right: Fit) -> None:
    """What a law takes by a course is what its columns take that are multiplied by it, run by run."""
    keep = damped.split.train
    run_of = np.array([c.run for c in damped.measured.channels])[keep]
    here = anchor(damped, right.u, right.hypotheses, right.e, slopes=False)
    place = free_places(damped, here, keep)[3]
    laws = law_terms(damped.measured.frequency_hz)
    columns = _columns(right, here, place, here.chain(right.u, right.e), laws)
    course = np.array([0.0, 0.3, 0.7, 1.0])
    by_row = np.tile(np.repeat(course[run_of], damped.measured.frequency_hz.size), 2)
    for view in _views(with_noise(right, 4)):
        (by_course,) = view.nats(columns, run_of, [course])
        (by_hand,) = view.nats(columns * by_row[:, None], run_of, [np.ones(4)])
        assert by_course == pytest.approx(by_hand)
        assert by_course != pytest.approx(view.nats(columns, run_of, [np.ones(4)])[0])


def test_a_law_acts_in_runs_that_are_held_out_too() -> None:
    """Of four runs the third is held out: what begins in the second acts there."""
    place: Any = SimpleNamespace(kind="structure")
    courses = dict(_courses(place, np.array([0, 1, 3]), np.arange(4), dict(enumerate((1, 2, 3, 4)))))
    assert courses["from run 2 on"] == pytest.approx([0, 1, 1, 1])


def test_what_is_rough_over_frequency_is_no_law(damped: Problem, right: Fit) -> None:
    """As much on one sensor that turns from line to line is for the residual's own test to see."""
    mine = np.flatnonzero(damped.split.train)[3]
    line = np.log(damped.measured.frequency_hz)
    smooth = 0.06j * (line - line.mean())
    signs = (-1.0) ** np.arange(line.size)
    nats = []
    for change in (smooth, smooth * signs):
        factor = np.ones(damped.measured.values.shape, dtype=complex)
        factor[mine] += change
        still = still_explained(with_noise(right, 0, factor))
        assert still is not None
        nats.append(still.nats)
    assert nats[1] < 0.1 * nats[0]


def test_terms_share_out_one_and_chance_is_that_of_noise() -> None:
    frequency = np.geomspace(3, 35, 50)
    laws = law_terms(frequency)
    assert laws.sum(axis=1) == pytest.approx(1)
    # A straight line in the logarithm is among them, and so is a cubic.
    wanted = np.log(frequency) ** 3
    assert laws @ np.linalg.lstsq(laws, wanted, rcond=None)[0] == pytest.approx(wanted)
    drawn = 0.5 * np.sum(np.random.default_rng(0).standard_normal((20_000, 2 * laws.shape[1])) ** 2, axis=1)
    # Of noise, minus the logarithm of a chance is exponential: its mean is one, and beyond three lies exp(-3).
    nats = np.array([surprise(h) for h in drawn])
    assert nats.mean() == pytest.approx(1, abs=0.03)
    assert np.mean(nats > 3) == pytest.approx(np.exp(-3), abs=0.006)


@pytest.mark.parametrize(("nats", "one_level", "kept"), [(13.0, False, True), (8.0, False, False), (13.0, True, False)])
def test_what_takes_as_much_as_a_name_is_told(
    monkeypatch: pytest.MonkeyPatch, nats: float, one_level: bool, kept: bool
) -> None:
    beside = StillExplained("force at 5+Z", "structure", nats)
    monkeypatch.setattr(beyond_names, "still_explained", lambda fit: beside)
    monkeypatch.setattr(beyond_names, "bends_at_one_level", lambda found: one_level)
    monkeypatch.setattr(beyond_names, "replace", lambda found, still: SimpleNamespace(**vars(found) | {"still": still}))
    monkeypatch.setattr(beyond_names, "takes_nearly_all", lambda found: True)
    found: Any = SimpleNamespace(rounds=(None,), final=None, still=None, null_residual=left(5.0))
    limits: Any = SimpleNamespace(evidence_nats=9.0)
    assert asked_beyond_names(found, limits).still is (beside if kept else None)
    nameless: Any = SimpleNamespace(rounds=(), final=None, still=None)
    assert asked_beyond_names(nameless, limits).still is None


@pytest.mark.parametrize(("missed", "after", "names"), [(2.0, 0.8, 1), (2.0, 0.85, 0), (0.9, 0.85, 1)])
def test_names_that_leave_a_law_more_than_a_tenth_of_what_was_too_much_are_leads(
    monkeypatch: pytest.MonkeyPatch, missed: float, after: float, names: int
) -> None:
    """Another hang was a payload that had changed: data were met, a fifth was left."""
    monkeypatch.setattr(beyond_names, "still_explained", lambda fit: StillExplained("force at 5+Z", "structure", 13.0))
    monkeypatch.setattr(beyond_names, "bends_at_one_level", lambda found: False)
    case = found_by((missed, 0.9), (after, 0.9))
    case = replace(case, null_residual=left(0.9, adequate=missed < 1.0))
    judged = asked_beyond_names(case, SimpleNamespace(evidence_nats=9.0))
    assert len(judged.rounds) == names
    assert (judged.still is not None) == (names > 0)
    assert len(judged.leads) == 1 - names


@pytest.mark.parametrize(("missed", "nats", "names"), [(2.0, 13.0, 0), (2.0, 8.0, 2), (0.9, 13.0, 2)])
def test_several_names_that_leave_a_thing_to_one_place_are_leads(
    monkeypatch: pytest.MonkeyPatch, missed: float, nats: float, names: int
) -> None:
    """Another payload was a drift and another hang, and the way of the force in that run explained 25 nats more."""
    beside = StillExplained("force channel", "drive", nats, "in run 5 alone")
    monkeypatch.setattr(beyond_names, "still_explained", lambda fit: beside)
    monkeypatch.setattr(beyond_names, "bends_at_one_level", lambda found: False)
    case = found_by((missed, 0.9), (0.75, 0.9), names=2)
    case = replace(case, null_residual=left(0.9, adequate=missed < 1.0))
    judged = asked_beyond_names(case, SimpleNamespace(evidence_nats=9.0))
    assert len(judged.rounds) == names
    assert len(judged.leads) == 2 - names
    if not names:
        assert "beside all of them a factor on the force channel in run 5 alone that is smooth" in why_no_name(judged)


@pytest.mark.parametrize(
    ("name", "waits"), [("rattling-mass", False), ("cubic-root-stiffness", True), ("control-surface-freeplay", True)]
)
def test_a_joint_that_depends_on_level_waits_for_another_one(damped: Problem, name: str, waits: bool) -> None:
    """A loose mass is foretold as it lies on its seat, by superposition: a law may be asked for beside it."""
    own, other = (SimpleNamespace(hypothesis=Hypothesis(KNOWN[n], {})) for n in (name, "added-mass"))
    for winner, alike in ((own, (own,)), (other, (other, own))):
        found: Any = SimpleNamespace(
            null=SimpleNamespace(problem=damped), rounds=(SimpleNamespace(winner=winner, alike=alike),)
        )
        assert bends_at_one_level(found) is waits


def test_a_law_is_what_a_thing_at_the_place_does(damped: Problem) -> None:
    """A small damper at a sensor's point changes the prediction as its law does: i omega times what moves there."""
    point = next(p for p in damped.layouts.first.grid if p.dof.node == 13)
    x, y, _ = (float(v) for v in point.position_m)
    none = fit(damped, (), np.zeros(damped.size), np.zeros(0), ())
    damper = Hypothesis(KNOWN["nonproportional-damper"], {"x_m": x, "y_m": y})
    there = fit(damped, (damper,), none.u, damper.scores({"damping_n_s_per_m": 1e-3}), ())
    wanted = data_misfit(damped, there.predicted) - data_misfit(damped, none.predicted)
    here = anchor(damped, none.u, (), none.e)
    (place,) = (p for p in free_places(damped, here, damped.split.train) if p.label == f"force at {point.dof}")
    # Its force on the aircraft is -i omega c times what moves: the imaginary part of one real law.
    law = -2 * np.pi * damped.measured.frequency_hz[:, None] * 1e-3
    told = _columns(none, here, place, here.chain(none.u, none.e), law)[:, 1]
    # A sensor's row makes up for cells, and where a damper is fixed none does.
    assert told @ wanted / np.linalg.norm(told) / np.linalg.norm(wanted) > 0.99
    assert np.linalg.norm(told) == pytest.approx(np.linalg.norm(wanted), rel=0.05)
