"""Slopes far from the scenario as stated, against differences of whole predictions, with and without an effect."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.reconcile.fitting import calibration, descent
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import STAGES, fit
from vgvt.reconcile.fitting.rough_start import rough_start
from vgvt.reconcile.prediction.local_slopes import Origin, from_elsewhere, origin_at
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, Problem, recentred

# The package's lazy name of the same spelling is the function.
STEP = 2e-3


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """The small scenario and its campaign."""
    return problem(tmp_path_factory.mktemp("cache"), 1)


def worst(case: Problem, u: Any, hypotheses: tuple[Hypothesis, ...], e: Any) -> float:
    """Largest error of any unknown's slope, over the slope: those that do next to nothing left out."""
    known = anchor(case, u, hypotheses, e).slopes()
    errors, sizes = [], []
    for k in range(len(case.unknowns)):
        aside = [u + s * STEP * np.eye(u.size)[k] for s in (1, -1)]
        ends = [anchor(case, a, hypotheses, e, slopes=False).mechanical(a, e) for a in aside]
        wanted = (ends[0] - ends[1]) / (2 * STEP)
        errors.append(np.linalg.norm(known[k] - wanted))
        sizes.append(np.linalg.norm(wanted))
    return float(np.max(np.array(errors) / np.maximum(sizes, 0.01 * np.max(sizes))))


def imitating(case: Problem) -> Any:
    """Scores of a calibration that stands in for something: a heavy body, a soft inner wing."""
    u = np.zeros(case.size)
    for k, unknown in enumerate(case.unknowns):
        if unknown.name in ("mass body", "EI wing"):
            u[k] = 25.0 if unknown.name == "mass body" else -4.0
    return u


@pytest.mark.slow
def test_within_the_tolerances_the_slopes_of_where_it_ended_are_right_and_those_of_the_stated_values_are_not(
    case: Problem,
) -> None:
    """A stretch's factor multiplies that of its whole wing: slopes at home are off by what the wing is."""
    u = np.zeros(case.size)
    u[[k.name for k in case.unknowns].index("EI wing")] = 1.5
    there = recentred(case, u)
    assert np.array_equal(there.at, u[: len(case.unknowns)])
    assert not case.at.any()
    assert worst(case, u, (), np.zeros(0)) > 0.05
    assert worst(there, u, (), np.zeros(0)) < 0.03
    # They serve until that is far from where they were taken.
    assert origin_at(there, u, np.zeros(0)) is None
    assert origin_at(there, -4 * u, np.zeros(0)) is not None


@pytest.mark.slow
def test_what_others_are_fitted_next_to_has_the_slopes_of_where_it_is(case: Problem) -> None:
    """Slopes that mislead are taken anew on the way: it ends at the bottom, which those of where it ended confirm."""
    stopped = fit(case, (), rough_start(case)[0], np.zeros(0), STAGES, exact=True)
    found = calibrate(case)
    assert stopped.converged
    assert np.array_equal(found.problem.at, stopped.u[: len(case.unknowns)])
    # A fit stops where a step promises less than so many nats: two fits of one bottom may end that far apart.
    unsettled = 0.5 * descent._ENOUGH * (found.chi2 + float(found.scores @ found.scores))
    assert abs(found.evidence_nats - stopped.evidence_nats) < 2 * unsettled
    again = calibrate(found.problem, found.u)
    assert abs(again.evidence_nats - found.evidence_nats) < unsettled


@pytest.mark.slow
def test_a_calibration_that_imitates_something_leaves_the_slopes_at_home(
    case: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    bent = replace(calibrate(case), problem=case, u=imitating(case))
    monkeypatch.setattr(calibration, "fit", lambda *a, **k: bent)
    assert calibrate(case).problem is case


def test_a_gauge_on_a_mount_that_gives_moves_with_the_push(case: Problem) -> None:
    """The structure does not carry its mass below the sensing element as stiffly as the bare aircraft's slope says."""
    hypothesis = Hypothesis(available_effects()["mount-compliance"])
    e = hypothesis.scores({"compliance_m_per_n": 2e-4, "loss_factor": 0.5, "frequency_hz": 3.0})
    index = [k.name for k in case.unknowns].index("transducer end mass")
    u = np.zeros(case.size)
    known = anchor(case, u, (hypothesis,), e).slopes()[index]
    aside = [u + s * STEP * np.eye(u.size)[index] for s in (1, -1)]
    ends = [anchor(case, a, (hypothesis,), e, slopes=False).mechanical(a, e) for a in aside]
    wanted = (ends[0] - ends[1]) / (2 * STEP)
    assert np.linalg.norm(known - wanted) < 0.02 * np.linalg.norm(wanted)
    bare = anchor(case, u).slopes()[index]
    assert np.linalg.norm(bare - wanted) > 0.1 * np.linalg.norm(wanted)


def test_where_a_calibration_has_wandered(case: Problem) -> None:
    u = imitating(case)
    assert np.abs(u).max() > 5
    assert worst(case, u, (), np.zeros(0)) < 0.05


def test_where_an_effect_moves_the_masses_too(case: Problem) -> None:
    """A wing that turns at its root: the bare aircraft's slopes know nothing of that joint."""
    cls = available_effects()["root-compliance"]
    hypothesis = Hypothesis(cls, {"side": "both"})
    e = hypothesis.scores({"bending": 0.1, "torsion": 0.1})
    assert worst(case, imitating(case), (hypothesis,), e) < 0.05


def test_where_a_root_gives_way_a_lot_though_no_unknown_has_moved(case: Problem) -> None:
    """The stated values' slopes are of rigid roots: a winglet's mass then does several times as much."""
    hypothesis = Hypothesis(available_effects()["root-compliance"], {"side": "both"})
    e = hypothesis.scores({"bending": 0.2, "torsion": 0.002})
    assert worst(case, np.zeros(case.size), (hypothesis,), e) < 0.05
    assert origin_at(case, np.zeros(case.size), e, (hypothesis,)) is not None
    little = hypothesis.scores({"bending": 0.005, "torsion": 0.005})
    assert origin_at(case, np.zeros(case.size), little, (hypothesis,)) is None
    known = Origin(np.zeros(case.size), e)
    assert not from_elsewhere(case, np.zeros(case.size), e + 0.1, known, (hypothesis,))
    assert from_elsewhere(case, np.zeros(case.size), e - 0.5, known, (hypothesis,))


@pytest.mark.parametrize(
    ("name", "settings", "sizes"),
    [
        ("carry-through-torsion", {}, {"compliance_rad_per_n_m": 5e-4}),
        (
            "control-surface",
            {"item": "flap-outer", "side": "both"},
            {"compliance_rad_per_n_m": 5.0, "arm_m": 0.03, "damping_ratio": 0.05},
        ),
    ],
)
def test_where_a_part_of_the_aircraft_turns_against_the_rest(
    case: Problem, name: str, settings: dict[str, Any], sizes: dict[str, float]
) -> None:
    """A body in two halves, a flap on its hinge: slopes of the aircraft in one piece are off by 60 % and more."""
    hypothesis, u = Hypothesis(available_effects()[name], settings), np.zeros(case.size)
    e = hypothesis.scores(sizes)
    assert worst(case, u, (hypothesis,), e) < 0.05
    # Whoever only looks at it, and fits nothing of it, keeps what there is.
    fixed = Hypothesis(available_effects()[name], {**settings, **sizes})
    assert not fixed.parameters and origin_at(case, u, np.zeros(0), (fixed,)) is None


def test_which_slopes_may_mislead(case: Problem) -> None:
    """Those of far away, as far as the way from the stated values says what that is."""
    count, nothing = len(case.unknowns), np.zeros(0)
    home, near, far, further = (np.zeros(case.size) for _ in range(4))
    home[0], near[0], far[0], further[0] = 0.9, 4.0, 8.0, 9.5
    # Within the tolerances those of the stated values serve, and still may be what misleads a fit.
    assert origin_at(case, near, nothing) is None
    assert from_elsewhere(case, near, nothing, None)
    assert not from_elsewhere(case, home, nothing, None)
    first = origin_at(case, far, nothing)
    assert isinstance(first, Origin) and first.u[0] == 8.0
    assert from_elsewhere(case, far, nothing, None)
    assert not from_elsewhere(case, far, nothing, first)
    # Of a longer way a share is as good as there.
    assert not from_elsewhere(case, further, nothing, first)
    further[0] = 14.0
    assert from_elsewhere(case, further, nothing, first)
    assert from_elsewhere(case, near, nothing, first)
    # Instruments' gains have no part in it.
    gains = np.zeros(case.size)
    gains[count:] = 50.0
    assert origin_at(case, gains, nothing) is None


def test_given_slopes_are_kept_however_far(case: Problem) -> None:
    """Whoever walks on with them says when they mislead."""
    far, further = np.zeros(case.size), np.zeros(case.size)
    far[0], further[0] = 8.0, 20.0
    first = origin_at(case, far, np.zeros(0))
    assert anchor(case, further, origin=first).origin is first
    anew = anchor(case, further).origin
    assert anew is not None and anew.u[0] == 20.0


def test_at_the_end_of_its_range_an_unknown_changes_nothing(case: Problem) -> None:
    """Cells can be as coarse as stated and no coarser: a score far beyond has no slope, and is no error."""
    u = np.zeros(case.size)
    coarse = case.unknowns.index(CELLS)
    u[coarse] = -100.0
    slopes = anchor(case, u, (), np.zeros(0)).slopes()
    assert np.isfinite(slopes).all()
    assert not slopes[coarse].any()
    assert slopes[coarse - 1].any()
