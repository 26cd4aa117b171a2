"""A joint that depends on level, found from the stated values beside the linear effect that it resembles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from reconciled_case import roving_scenario, small_scenario, without_instrument_noise
from test_levels import FRICTION, PLAY, ROOT, driven, predicted, truth

from vgvt.effects import available_effects
from vgvt.reconcile.fitting.fit import FAR, Fit, fit
from vgvt.reconcile.next_test.suggest import suggest
from vgvt.reconcile.question.harmonics import Harmonic
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import make_problem
from vgvt.reconcile.search import likeness, shortlist
from vgvt.reconcile.search.candidate_fits import finalists, fitted_from
from vgvt.reconcile.search.candidates import candidates
from vgvt.reconcile.search.likeness import beside_likeness
from vgvt.reconcile.search.screened import Screened
from vgvt.reconcile.work.progress import Progress, silent
from vgvt.reconcile.work.team import Team
from vgvt.simulation import simulated_campaign

NAMES = ("root-compliance", "root-freeplay", "cubic-root-stiffness")
WIDE = 4.0


@pytest.fixture(scope="module")
def stated(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """The model as stated beside what a joint whose play is shaken open would give it."""
    scenario = driven(without_instrument_noise(small_scenario()), 1.0)
    campaign = simulated_campaign(scenario, engine="linear")
    case = make_problem(campaign, scenario, lines=120, cache=tmp_path_factory.mktemp("cache"))
    values = predicted(case, (PLAY,), WIDE)
    size = np.abs(values)
    sigma = 0.01 * np.hypot(size, np.median(size, axis=1, keepdims=True))
    measured = replace(case.measured, pushed=WIDE * case.measured.pushed, values=values, sigma=sigma)
    case = replace(case, measured=measured)
    return fit(case, (), truth(case), np.zeros(0), ())


@pytest.fixture(scope="module")
def offered(stated: Fit) -> tuple[Hypothesis, ...]:
    return candidates(stated.problem, {n: available_effects()[n] for n in NAMES})


@pytest.fixture(scope="module")
def found(stated: Fit, offered: tuple[Hypothesis, ...]) -> tuple[Screened, ...]:
    joints, told = [h for h in offered if not h.linear], list[float]()
    starts = beside_likeness(stated, joints, offered, lambda fraction, message: told.append(fraction))
    assert told == sorted(told)
    return starts


@pytest.mark.slow
def test_a_joint_with_play_is_found_beside_a_soft_root(stated: Fit, found: tuple[Screened, ...]) -> None:
    """Its size and stiffness, with unknowns within their tolerances; from the stated values nothing overlaps."""
    first, second = found
    assert first.hypothesis.name == PLAY.name
    assert first.hypothesis.settings == {"kind": "bending", "side": "both"}
    assert first.values["gap_rad"] == pytest.approx(PLAY.settings["gap_rad"], rel=0.05)
    # EI takes what the root's stiffness lacks, and which share is left to rounding: 1886 or 2000 by BLAS' kernels.
    assert first.values["root_stiffness_n_m_per_rad"] == pytest.approx(ROOT["root_stiffness_n_m_per_rad"], rel=0.1)
    assert first.start is not None
    assert np.abs(first.start).max() < 4
    assert first.remaining < stated.points < 0.001 * stated.chi2
    # Another law is no match for it.
    assert second.hypothesis.name == "cubic-root-stiffness"
    assert second.remaining > 20 * first.remaining


@pytest.mark.slow
def test_where_a_joint_has_arrived_coarse_steps_leave_it(stated: Fit, found: tuple[Screened, ...]) -> None:
    """They would lead away from what is as sharp as that, and what is begun again from there ends no higher."""
    kept = next(s for s in finalists(stated, found, silent) if s.hypothesis == found[0].hypothesis)
    assert kept.values == pytest.approx(found[0].values, rel=1e-12)
    assert kept.start is not None and found[0].start is not None
    assert np.array_equal(kept.start, found[0].start)
    ended = fitted_from(stated, kept, FAR, silent)
    assert ended is not None
    assert ended.chi2 <= found[0].remaining * (1 + 1e-9)
    away = fitted_from(stated, replace(kept, arrived=False), ((0.6, 2),), silent)
    assert away is not None
    # By far more than decides between two names.
    assert ended.evidence_nats - away.evidence_nats > 50


@pytest.mark.slow
def test_another_level_tells_it_from_what_came_next(stated: Fit, found: tuple[Screened, ...]) -> None:
    """A joint with play from one that stiffens, by sweeps at other levels and nothing else."""
    fits = [fitted_from(stated, s, FAR, silent) for s in found]
    tests = suggest([f for f in fits if f is not None], levels_alone=True)
    assert tests and all(t.test.startswith("sweep again with") for t in tests)
    assert tests[0].rivals == (PLAY.name, "cubic-root-stiffness")
    assert tests[0].nats > 50


@pytest.mark.slow
def test_a_joint_that_sticks_in_one_run_and_slips_in_another_is_begun_from_the_stated_values(tmp_path: Path) -> None:
    """It is like no linear effect."""
    scenario = driven(without_instrument_noise(roving_scenario()), 1.0)
    case = make_problem(simulated_campaign(scenario, engine="linear"), scenario, lines=120, cache=tmp_path)
    louder = np.array([0.25, 0.25, 2.0, 2.0])[:, None]
    measured = replace(case.measured, pushed=louder * case.measured.pushed, force=louder * case.measured.force)
    case = replace(case, measured=measured)
    values = predicted(case, (FRICTION,))
    size = np.abs(values)
    sigma = 0.01 * np.hypot(size, np.median(size, axis=1, keepdims=True))
    case = replace(case, measured=replace(measured, values=values, sigma=sigma))
    current = fit(case, (), truth(case), np.zeros(0), ())
    (first, *_) = beside_likeness(current, candidates(case, {"root-friction": FRICTION.cls}), (), silent)
    assert first.hypothesis.settings == {"kind": "bending", "side": "both"}
    assert first.values["friction_n_m"] == pytest.approx(FRICTION.settings["friction_n_m"], rel=0.1)
    assert first.values["root_stiffness_n_m_per_rad"] == pytest.approx(ROOT["root_stiffness_n_m_per_rad"], rel=0.1)
    assert first.remaining < 0.01 * current.chi2


@pytest.mark.parametrize(("between", "looked_at"), [(1.5, False), (90.0, True)])
def test_at_one_level_joints_are_begun_there_where_something_is_seen_not_to_be_linear(
    stated: Fit, offered: tuple[Hypothesis, ...], monkeypatch: pytest.MonkeyPatch, between: float, looked_at: bool
) -> None:
    """What slips throws what it makes between the multiples of the sweep, too."""
    joints, asked = [h for h in offered if not h.linear], list[Hypothesis]()

    def softest(current: Fit, scores: object, variants: Sequence[Hypothesis], tell: Progress) -> list[Screened]:
        asked.extend(variants)
        return []

    monkeypatch.setattr(likeness, "_softest", softest)
    seen = replace(stated.problem.measured, harmonics=(Harmonic(1, 3, 1.6, between),))
    current = replace(stated, problem=replace(stated.problem, measured=seen))
    assert beside_likeness(current, joints, (), silent) == ()
    assert set(asked) == (set(joints) if looked_at else set())


@pytest.mark.parametrize(("per_value", "both"), [(0.9, False), (1.6, True)])
def test_joints_that_do_not_meet_the_data_beside_their_likeness_are_begun_from_where_its_fit_began_too(
    stated: Fit, offered: tuple[Hypothesis, ...], monkeypatch: pytest.MonkeyPatch, per_value: float, both: bool
) -> None:
    """A soft root's fit that arrived at its bottom had bent the unknowns by 73 deviations: no joint came back."""
    joints = [h for h in offered if not h.linear]
    root = next(h for h in offered if h.name == "root-compliance" and h.settings["side"] == "both")
    bent = replace(stated, hypotheses=(root,), u=np.full(stated.u.size, 9.0), e=np.zeros(len(root.parameters)))
    begun: list[tuple[float, str]] = []

    def begin(
        current: Fit, scores: np.ndarray, variants: Sequence[Hypothesis], stages: object, tell: Progress
    ) -> Screened:
        away = scores[0] == 0.0
        assert stages == (likeness.GENTLY[:1], likeness.GENTLY[1:])
        begun.append((float(scores[0]), variants[0].name))
        left = 0.5 if away else per_value
        return Screened(variants[0], {}, 0.0, remaining=left * current.points, start=scores)

    monkeypatch.setattr(likeness, "from_stated", lambda *_: (Screened(root, {}, 0.0, start=np.zeros(stated.u.size)),))
    monkeypatch.setattr(likeness, "_fitted", lambda *_: bent)
    monkeypatch.setattr(likeness, "_begun", begin)
    starts = beside_likeness(stated, joints, offered, silent)
    names = sorted({h.name for h in joints})
    wanted = [(9.0, name) for name in names] + [(0.0, name) for name in names] * both
    assert sorted(begun) == sorted(wanted)
    # Of each the better start goes on.
    assert sorted(s.hypothesis.name for s in starts) == names
    assert {s.remaining / stated.points for s in starts} == {0.5 if both else per_value}


@pytest.mark.parametrize(("named", "asked"), [(False, True), (True, False)])
def test_asked_for_where_a_calibration_is_bent_and_nothing_has_a_name(
    stated: Fit, offered: tuple[Hypothesis, ...], monkeypatch: pytest.MonkeyPatch, named: bool, asked: bool
) -> None:
    """Of joints alone, beside all that is known: what is asked for second at one level is begun beside the first."""
    joints = [h for h in offered if not h.linear]
    soft = [h for h in offered if h.linear]
    u = stated.u.copy()
    u[0] = 20.0
    current = replace(stated, u=u, hypotheses=(soft[0],) if named else ())
    large = Screened(joints[0], {}, 1.0, arrived=True)
    calls = list[tuple[list[Hypothesis], list[Hypothesis]]]()

    def beside(
        at: Fit, wanted: list[Hypothesis], linear: Sequence[Hypothesis], tell: Progress, team: Team
    ) -> tuple[Screened, ...]:
        calls.append((wanted, list(linear)))
        return (large,)

    monkeypatch.setattr(shortlist, "screen", lambda *a, **more: ())
    monkeypatch.setattr(shortlist, "from_stated", lambda *a: ())
    monkeypatch.setattr(shortlist, "beside_likeness", beside)
    chosen = shortlist.second_list(current, joints, soft, 9.0, silent)
    assert (large in chosen) == asked
    assert calls == ([(joints, soft)] if asked else [])
