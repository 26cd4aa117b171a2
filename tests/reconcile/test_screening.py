"""The screen looks closer only at what could be asked for, and far-off rounds fit only their best to the end."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.effects.added_inertia import AddedInertia
from vgvt.effects.local_absorber import LocalAbsorber
from vgvt.effects.loose_sensor_mount import LooseSensorMount
from vgvt.effects.suspension_surge import SuspensionSurge
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search import candidate_fits, shortlist
from vgvt.reconcile.search.candidate_fits import FINALISTS, finalists
from vgvt.reconcile.search.candidates import candidates
from vgvt.reconcile.search.scan import scan_of
from vgvt.reconcile.search.screen import at_sizes, screen, sizing
from vgvt.reconcile.search.screened import Screened, parted
from vgvt.reconcile.search.stand import Stand
from vgvt.reconcile.search.stand_on import stand_on
from vgvt.reconcile.work.progress import silent
from vgvt.reconcile.work.team import Team

NAMES = ("added-mass", "local-absorber", "root-compliance", "channel-gain", "stiffness-asymmetry")


@pytest.fixture(scope="module")
def null(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """A calibrated scenario that lacks an absorber."""
    absorber = LocalAbsorber(mass_kg=0.01, frequency_hz=18.0, x_m=0.9, y_m=1.1)
    return calibrate(problem(tmp_path_factory.mktemp("cache"), 1, absorber))


@pytest.fixture(scope="module")
def hypotheses(null: Fit) -> Any:
    return candidates(null.problem, {n: available_effects()[n] for n in NAMES})


def counted(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the effects whose unknowns were followed all the way, as they come."""
    seen: list[str] = []
    followed = Stand.followed

    def spy(self: Stand, hypothesis: Any, *values: dict[str, float]) -> Any:
        seen.append(hypothesis.name)
        return followed(self, hypothesis, *values)

    monkeypatch.setattr(Stand, "followed", spy)
    return seen


def test_the_true_effect_comes_first(null: Fit, hypotheses: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """And of its many places only a few are looked at closely."""
    seen = counted(monkeypatch)
    found = screen(null, hypotheses)
    assert found[0].hypothesis.name == "local-absorber"
    assert 17 < found[0].values["frequency_hz"] < 19
    assert len({s.hypothesis for s in found}) == len(found) == len(hypotheses)
    assert len(set(seen)) > 1
    assert len(seen) < len(hypotheses)


def test_a_team_sees_the_same(null: Fit, hypotheses: Any) -> None:
    """Each of it sizes its share of the variants; which those are changes nothing."""
    few = [*hypotheses[:8], *hypotheses[-3:]]
    with Team(2, (null.problem, *few)) as team:
        assert len(sizing(null, few, team)) == team.workers
        shared = screen(null, few, team=team)
    alone = screen(null, few)
    assert [s.hypothesis for s in shared] == [s.hypothesis for s in alone]
    for one, other in zip(shared, alone, strict=True):
        assert one.values == other.values and one.gain_nats == other.gain_nats


def test_a_stand_is_kept_for_the_same_fit_alone(null: Fit) -> None:
    """Sent to a helper once more it is another object, and the same fit."""
    here = stand_on(null)
    assert stand_on(replace(null)) is here
    scores = null.u.copy()
    scores[0] += 0.1
    there = stand_on(replace(null, u=scores))
    assert there is not here and there.fit.u[0] == scores[0]
    assert stand_on(null).fit.u[0] == null.u[0]


@pytest.mark.slow
def test_what_promises_little_stays_unchecked(null: Fit, hypotheses: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = counted(monkeypatch)
    screen(null, hypotheses)
    every = len(seen)
    seen.clear()
    found = screen(null, hypotheses, least_nats=1e9)
    assert not seen and every > 0
    # An effect of two sizes may stand there without the one that is not asked for.
    assert Counter(s.hypothesis.name for s in found) == Counter(h.name for h in hypotheses)


@pytest.mark.slow
def test_what_the_unknowns_imitate_is_not_lost(tmp_path_factory: pytest.TempPathFactory) -> None:
    """An inertia that the body's own takes over far beyond its tolerance: it must come out on top all the same."""
    inertia = AddedInertia(roll_inertia_kg_m2=0.05)
    swallowed = calibrate(problem(tmp_path_factory.mktemp("cache"), 1, inertia))
    every = {n: available_effects()[n] for n in (*NAMES, "added-inertia")}
    found = screen(swallowed, candidates(swallowed.problem, every))
    assert found[0].hypothesis.name == "added-inertia"
    assert found[0].gain_nats > 10


@pytest.mark.parametrize("mass_kg", [0.1165, pytest.param(0.31, marks=pytest.mark.slow)])
def test_a_sharp_resonance_between_the_steps_of_a_scan_is_met(tmp_path: Path, mass_kg: float) -> None:
    """A spring's surge, ten times narrower than a step: nor is an eighth of its mass a little of it."""
    case = problem(tmp_path, 1, SuspensionSurge(mass_kg=mass_kg, loss_factor=0.005))
    coarse = fit(case, (), np.zeros(case.size), np.zeros(0), ((0.6, 4), (0.1, 8)), judged=0.1)
    found = screen(coarse, candidates(case, {"suspension-surge": SuspensionSurge}))
    assert found[0].gain_nats > 0.02 * coarse.chi2
    assert found[0].values["mass_kg"] == pytest.approx(mass_kg, rel=0.05)
    assert found[0].tuned == "mass_kg"
    assert parted(found[0], 0.125) == found[0].values


def test_a_sensor_that_resonates_in_the_band_is_met(tmp_path: Path) -> None:
    """Its period is a size where it lies far above the band, and none within: there its peak is where it is."""
    case = problem(tmp_path, 1, LooseSensorMount(node=6, period_s=0.033, damping_ratio=0.11))
    null = fit(case, (), np.zeros(case.size), np.zeros(0), ())
    found = screen(null, candidates(case, {"loose-sensor-mount": LooseSensorMount}))
    assert found[0].hypothesis.settings["node"] == 6
    assert found[0].gain_nats > 10 * max(1.0, found[1].gain_nats)
    # The closed form knows it to a step of the scan, and from where the screen begins a fit arrives.
    best = max(at_sizes(stand_on(null), found[0].hypothesis), key=lambda s: s.gain_nats)
    assert best.values["period_s"] == pytest.approx(0.033, rel=0.06)
    arrived = fit(case, (found[0].hypothesis,), null.u, found[0].hypothesis.scores(found[0].values))
    assert arrived.values(0)["period_s"][0] == pytest.approx(0.033, rel=1e-3)
    # Far above the band the closed form still has its say.
    starts = scan_of(case, found[0].hypothesis).starts
    assert "period_s" not in starts[0] and all("period_s" in s for s in starts[1:])
    slowest = 1 / (3 * case.measured.frequency_hz[-1])
    assert min(s["period_s"] for s in starts[1:]) == pytest.approx(slowest, rel=0.15)


@pytest.mark.slow
def test_only_finalists_are_fitted_to_the_end(null: Fit, hypotheses: Any) -> None:
    """The best by a few forgiving steps, from where these arrived, best first; those that met are one."""
    chosen = screen(null, hypotheses)[: FINALISTS + 2]
    kept = finalists(null, chosen, lambda fraction, message: None)
    assert 0 < len(kept) <= FINALISTS
    assert {s.hypothesis for s in kept} < {s.hypothesis for s in chosen}
    assert kept[0].start is not None and np.abs(kept[0].start - null.scores).max() > 0


def one_of(label: str) -> Hypothesis:
    """A variant of the effect that a label begins with, that has no place."""
    named = SimpleNamespace(name=label[0], label=label, cls=AddedInertia, settings={})
    return cast(Hypothesis, SimpleNamespace(**vars(named), same=lambda other: other.name == named.name))


@pytest.mark.parametrize(
    ("foremost", "kept"), [(None, "abad"), ("b", "abad"), ("f", "abadf"), ("e-too", "abade")], ids=str
)
def test_what_came_first_without_forgiveness_is_fitted_too(
    monkeypatch: pytest.MonkeyPatch, foremost: str | None, kept: str
) -> None:
    """A surge that promised most of all was the last by coarse steps; two starts of one that have met are one."""
    nats = {"a": 9.0, "b": 8.0, "a-far": 7.0, "d": 6.0, "e": 5.0, "e-too": 4.9, "f": 1.0}

    def begun(current: Any, s: Screened, tell: Any) -> Any:
        label = s.hypothesis.label
        return SimpleNamespace(evidence_nats=nats[label], values=lambda k: {}, scores=np.zeros(3))

    monkeypatch.setattr(candidate_fits, "_begun", begun)
    chosen = [Screened(one_of(label), {}, 1.0, foremost=label == foremost) for label in reversed(nats)]
    current: Any = SimpleNamespace(hypotheses=(), scores=np.zeros(3))
    assert "".join(s.hypothesis.name for s in finalists(current, chosen, silent)) == kept


@pytest.mark.parametrize(("left", "foremost"), [(20.0, [True, False]), (1.2, [False, False])])
def test_where_data_are_missed_the_first_by_their_own_errors_is_foremost(
    monkeypatch: pytest.MonkeyPatch, left: float, foremost: list[bool]
) -> None:
    plain: list[Any] = [SimpleNamespace(name=name, settings={}) for name in ("surge", "mass")]
    near = tuple(Screened(p, {}, 50.0) for p in plain)
    monkeypatch.setattr(shortlist, "bent", lambda current: True)
    monkeypatch.setattr(shortlist, "_asked", lambda current, left, *more: (list(left), []))
    monkeypatch.setattr(shortlist, "_looks", lambda *given, **more: ((), near, ()))
    monkeypatch.setattr(shortlist, "localise", lambda current, everywhere: SimpleNamespace(places=()))
    monkeypatch.setattr(shortlist, "freed", lambda hypothesis: SimpleNamespace(parameters=()))
    before: Any = SimpleNamespace(train_chi2_per_dof=left)
    current: Any = SimpleNamespace(u=np.zeros(1), hypotheses=())
    seen = shortlist.shortened(current, (), before, 9.0, silent, afar=True)
    assert [s.hypothesis for s in seen] == plain
    assert [s.foremost for s in seen] == foremost


@pytest.mark.parametrize(("strained", "fitted"), [(True, ["settled", "open"]), (False, ["open"])])
def test_from_a_strained_calibration_less_has_to_be_in_sight(
    monkeypatch: pytest.MonkeyPatch, strained: bool, fitted: list[str]
) -> None:
    """An asymmetry imitated by five deviations of EI promised 5.6 nats of the 25 that its fit then gained."""
    size = SimpleNamespace(neutral=0.0, name="size")
    place = SimpleNamespace(neutral=None, name="place")

    def promised(name: str, nats: float, *parameters: Any) -> Any:
        hypothesis = SimpleNamespace(name=name, settings={}, parameters=parameters)
        return SimpleNamespace(hypothesis=hypothesis, gain_nats=nats, visible=True)

    screened = [promised("settled", 5.6, size), promised("open", 3.0, size, place), promised("nothing", 1.0, size)]
    monkeypatch.setattr(shortlist, "freed", lambda hypothesis: hypothesis)
    chosen = shortlist.short_list(screened, 6, needed=9.0, strained=strained)
    assert [s.hypothesis.name for s in chosen] == fitted


def test_a_calibration_is_strained_where_its_scores_hold_more_than_a_name() -> None:
    """Sixty of one deviation each are what is uncertain; the same sixty and two of five are not."""
    quiet: Any = SimpleNamespace(scores=np.ones(60))
    bent: Any = SimpleNamespace(scores=np.concatenate([np.ones(58), [5.0, -5.0]]))
    assert not shortlist._strained(quiet, 9.0)
    assert shortlist._strained(bent, 9.0)
    assert not shortlist._strained(bent, 30.0)


def test_what_is_damped_by_a_loss_factor_is_begun_as_a_strong_damper_too(null: Fit) -> None:
    """A moment path of clay: 0.3 at 1.9 Hz damps thirty times as much as 0.05 at 10 Hz."""
    known = available_effects()
    for name, starts in (("stinger-moment", 2), ("mount-compliance", 2), ("hysteretic-damping", 1), ("added-mass", 1)):
        variants = candidates(null.problem, {name: known[name]})
        found = scan_of(null.problem, variants[0])
        assert (len(found.starts), found.tuned) == (starts, ""), name
    (hypothesis,) = candidates(null.problem, {"stinger-moment": known["stinger-moment"]})
    weak, strong = scan_of(null.problem, hypothesis).starts
    assert strong["loss_factor"] / strong["frequency_hz"] > 15 * weak["loss_factor"] / weak["frequency_hz"]
