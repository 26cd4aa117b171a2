"""Effects too large for a tangent, found from the stated values where a calibration has bent itself to imitate them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search import shortlist
from vgvt.reconcile.search.candidate_fits import finalists
from vgvt.reconcile.search.candidates import candidates
from vgvt.reconcile.search.from_stated import _sizes, bent, from_stated
from vgvt.reconcile.search.screened import Screened
from vgvt.reconcile.work.progress import silent
from vgvt.reconcile.work.team import FORKS, Team

TRUE = 0.2
NAMES = ("root-compliance", "bend-twist-coupling", "hook-offset", "channel-gain", "run-drift", "local-absorber")


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """A campaign whose wing roots give way by a fifth of the wing, and the nominal model as it stands."""
    root = available_effects()["root-compliance"](bending=TRUE, torsion=0.0)
    case = problem(tmp_path_factory.mktemp("cache"), 1, root)
    return fit(case, (), np.zeros(case.size), np.zeros(0), ())


@pytest.fixture(scope="module")
def offered(calibrated: Fit) -> tuple[Hypothesis, ...]:
    """Every variant of a few effects."""
    return candidates(calibrated.problem, {n: available_effects()[n] for n in NAMES})


@pytest.fixture(scope="module")
def told() -> list[float]:
    """What progress there was."""
    return []


@pytest.fixture(scope="module")
def found(calibrated: Fit, offered: tuple[Hypothesis, ...], told: list[float]) -> tuple[Screened, ...]:
    """The starts from the stated values."""
    return from_stated(calibrated, offered, lambda fraction, message: told.append(fraction))


def test_a_root_that_gives_way_a_lot_comes_first_and_near(
    calibrated: Fit, found: tuple[Screened, ...], told: list[float]
) -> None:
    assert found[0].hypothesis.name == "root-compliance"
    assert found[0].hypothesis.settings["side"] == "both"
    assert found[0].values["bending"] == pytest.approx(TRUE, rel=0.1)
    # What of the data is left at 60 % allowance: next to nothing, as peaks overlap.
    assert found[0].remaining < 0.05 * calibrated.points
    assert len({s.hypothesis.name for s in found}) == len(found)
    assert told == sorted(told)


@pytest.mark.slow
@pytest.mark.skipif(not FORKS, reason="no process is forked here")
def test_helpers_change_nothing_of_what_is_found(
    calibrated: Fit, offered: tuple[Hypothesis, ...], found: tuple[Screened, ...]
) -> None:
    assert len(found) > 1
    alone = finalists(calibrated, found, silent)
    with Team(2, (calibrated.problem, *offered)) as team:
        shared = finalists(calibrated, found, silent, team)
    assert [s.values for s in shared] == [s.values for s in alone]
    assert [s.hypothesis for s in shared] == [s.hypothesis for s in alone]
    for one, other in zip(shared, alone, strict=True):
        assert one.start is not None and other.start is not None
        assert np.array_equal(one.start, other.start)


def test_channels_places_and_changes_between_runs_have_other_ways(calibrated: Fit) -> None:
    names = ("channel-gain", "run-drift", "local-absorber")
    hypotheses = candidates(calibrated.problem, {n: available_effects()[n] for n in names})
    assert from_stated(calibrated, hypotheses, silent) == ()


def test_a_calibration_is_bent_where_an_unknown_is_far_off(calibrated: Fit) -> None:
    assert not bent(calibrated)
    u = calibrated.u.copy()
    u[0] = -11.0
    assert bent(replace(calibrated, u=u))


@pytest.mark.parametrize(("far_off", "named", "asked"), [(20.0, False, True), (5.0, False, False), (20.0, True, False)])
def test_asked_for_where_a_calibration_is_bent_and_nothing_has_a_name(
    calibrated: Fit, monkeypatch: pytest.MonkeyPatch, far_off: float, named: bool, asked: bool
) -> None:
    """Joints with a law of their own are then asked for there alone: beside bent unknowns they are no use."""
    soft, stiffening = (Hypothesis(available_effects()[n]) for n in ("root-compliance", "cubic-root-stiffness"))
    u = np.zeros(calibrated.u.size)
    u[0] = far_off
    current = replace(calibrated, u=u, hypotheses=(soft,) if named else ())
    large, screened = Screened(soft, {"bending": TRUE}, 1.0), list[list[str]]()

    def looked(at: Fit, left: tuple[Hypothesis, ...], *more: object, **rest: object) -> list[Any]:
        screened.append([h.name for h in left])
        return []

    monkeypatch.setattr(shortlist, "screen", looked)
    monkeypatch.setattr(shortlist, "sizing", looked)
    monkeypatch.setattr(shortlist, "held", lambda *given: ())
    monkeypatch.setattr(shortlist, "_forgiving", lambda at, tell: at)
    monkeypatch.setattr(shortlist, "localise", lambda at, everywhere: SimpleNamespace(places=()))
    monkeypatch.setattr(shortlist, "from_stated", lambda at, left, tell, team: (large,))
    monkeypatch.setattr(shortlist, "beside_likeness", lambda at, joints, linear, tell, team: ())
    before: Any = SimpleNamespace(train_chi2_per_dof=30.0)
    chosen = shortlist.shortened(current, (soft, stiffening), before, 9.0, silent, afar=True)
    assert (large in chosen) == asked
    wanted = [soft.name] if far_off > 10 else [soft.name, stiffening.name]
    assert screened == [wanted, wanted]
    screened.clear()
    assert (large in shortlist.second_list(current, (soft, stiffening), (), 9.0, silent)) == asked
    assert screened == [wanted]


def test_at_one_level_every_size_of_a_joint_is_tried(calibrated: Fit) -> None:
    """Two sizes of its law by three of its stiffness: one size was too far from a root that slips more."""
    slipping = Hypothesis(available_effects()["root-friction"], {"kind": "bending", "side": "both"})
    tried = [slipping.values(e) for e in _sizes(calibrated, slipping)]
    assert len({v["friction_n_m"] for v in tried}) == 2
    assert len({v["root_stiffness_n_m_per_rad"] for v in tried}) == 3
    assert len(tried) == 6


@pytest.mark.parametrize(("left", "moved", "taken"), [(0.8, 3.0, False), (0.8, -17.9, True), (2.0, 3.0, True)])
def test_what_is_met_by_an_unknown_far_out_is_looked_for_as_what_is_missed(
    left: float, moved: float, taken: bool
) -> None:
    """A mass on a wing that eighteen deviations of the wing's own imitated got no look that forgives."""
    at: Any = SimpleNamespace(u=np.array([0.5, moved]))
    assert shortlist.swallowed(at, SimpleNamespace(train_chi2_per_dof=left)) is taken
