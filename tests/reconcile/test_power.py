"""The smallest size that a campaign could see is one that would move its data by five honest standard deviations."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.effects.added_mass import AddedMass
from vgvt.reconcile.evidence.lasting import Imitated, lasting, lasting_nats
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.fitting.fit import NEAR, fit
from vgvt.reconcile.next_test.nameable import nameable_ratio
from vgvt.reconcile.next_test.power import power
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import SMOOTHED, noise_share, stored_thresholds
from vgvt.reconcile.search.stand import Stand

NOTHING = np.zeros(0)


def test_the_smallest_size_moves_the_data_by_five_deviations(tmp_path: Path) -> None:
    """Beyond what the unknowns imitate, 25 of χ² by the view that sees less: an error of the model lasts for lines."""
    null = calibrate(problem(tmp_path, 1))
    heavier = Hypothesis(AddedMass, {"x_m": 0.9, "y_m": 1.1})
    (found,) = power(null, [heavier])
    stand = Stand.of(null)
    part = 0.01
    moved = stand.change(heavier, {"mass_kg": part * found.smallest})
    assert moved is not None
    left = stand.projected(moved) / part
    measured, train = null.problem.measured, null.problem.split.train
    noise = float(np.mean(measured.noise[train] / measured.sigma[train] ** 2))
    assert noise < 0.9
    data = lasting(null.problem, np.column_stack([null.tangent, moved[: null.points] / part]))
    slopes = np.vstack([data[:, :-1], np.eye(null.scores.size)])
    change = np.append(data[:, -1], np.zeros(null.scores.size))
    _, (lasts,), *_ = np.linalg.lstsq(slopes, change, rcond=None)
    # What peaks do is seen beside an error that drifts along the lines, but less well.
    assert (noise + (1 - noise) / SMOOTHED) * float(left @ left) > 1.1 * lasts
    assert lasts == pytest.approx(25.0, rel=0.05)


def test_what_grows_with_the_square_of_its_size_is_seen_at_its_root(tmp_path: Path) -> None:
    """A loose sensor far above the band reads (1 + (f T)²) times too much: twice the period, four times the change."""
    case = problem(tmp_path, 1)
    null = fit(case, (), np.zeros(case.size), np.zeros(0), ())
    loose = Hypothesis(available_effects()["loose-sensor-mount"], {"node": 6})
    found = next(p for p in power(null, [loose]) if p.parameter == "period_s")
    stand = Stand.of(null)
    change = stand.change(loose, {"period_s": found.smallest, "damping_ratio": 0.05})
    assert change is not None
    worth = noise_share(case.measured, case.split.train).worth ** 0.5
    views = (worth * np.linalg.norm(stand.projected(change)), Imitated.of(case, null.tangent).deviations(change))
    assert min(views) == pytest.approx(5.0, rel=0.05)
    # Amounts and structures grow as slopes.
    gain = Hypothesis(available_effects()["channel-gain"], {"channels": "6+Z"})
    mass = Hypothesis(available_effects()["added-mass"], {"x_m": 0.9, "y_m": 1.1})
    for hypothesis in (gain, mass):
        assert stand.squared(hypothesis, {}, hypothesis.parameters[0]) is None


def test_what_gets_a_name_pays_for_its_freedom_and_for_chance(tmp_path: Path) -> None:
    """By fits to what such a size foretells, with the effect and without: they gain a name and what it pays."""
    case = problem(tmp_path, 1)
    stated = np.zeros(case.size)
    heavier = Hypothesis(AddedMass, {"x_m": 0.9, "y_m": 1.1}, share=1 / 16)
    (found,) = power(fit(case, (), stated, NOTHING, ()), [heavier])
    share = noise_share(case.measured, case.split.train)
    needed = stored_thresholds().evidence_nats

    def gained(mass_kg: float) -> float:
        """Nats by the view that grants less, which is one and the same here."""
        there = fit(case, (heavier,), stated, heavier.scores({"mass_kg": mass_kg}), ())
        exact = replace(case, measured=replace(case.measured, values=there.predicted))
        told = fit(exact, (heavier,), stated, there.e, NEAR)
        blind = fit(exact, (), stated, NOTHING, NEAR)
        line_by_line = told.evidence_nats - blind.evidence_nats
        tempered = line_by_line - 0.5 * (1 - share.worth) * (blind.chi2 - told.chi2)
        lasts = lasting_nats(told) - lasting_nats(blind)
        assert lasts < tempered
        return lasts

    deviations = 5 * found.named / found.smallest
    # Its place, told here, is taken for two parameters that each change everything.
    place = math.log1p(deviations**2)
    # Slopes foretell it; the unknowns bend by two deviations, and take more than slopes say: 6 to 18 % at five places.
    assert gained(found.named) == pytest.approx(needed + place + 1.645 * deviations, rel=0.2)
    assert gained(found.smallest) < needed + place


def test_sizes_that_get_a_name() -> None:
    """More of what is tried and of what a name needs ask for more; what never shows never has one."""
    added = available_effects()["added-mass"]
    one = Hypothesis(added, {"x_m": 0.9, "y_m": 1.1})
    mass = one.parameters[0]

    def ratio(hypothesis: Hypothesis, smallest: float = 0.01, needed: float = 9.0, grows: int = 1) -> float:
        return nameable_ratio(hypothesis, mass, smallest, deviations=5.0, raw=5.6, threshold_nats=needed, power=grows)

    plain = ratio(one)
    assert 1.3 < plain < 1.8
    assert plain < ratio(replace(one, share=1 / 64)) < plain * 1.3
    # One of 64 places that are fitted costs no more than a place that is.
    assert ratio(replace(one, share=1 / 64, places=64)) == plain
    assert ratio(replace(one, share=1 / 64, places=16)) == ratio(replace(one, share=1 / 4))
    assert plain < ratio(one, needed=30.0)
    # Twice as many deviations at a size that is only larger by the root of two.
    assert ratio(one, grows=2) == pytest.approx(plain**0.5, rel=0.05)
    # A hundred times lighter than plausible: the prior speaks against it.
    assert ratio(one, smallest=2e-5) > ratio(one, smallest=2e-3)
    assert ratio(one, smallest=math.inf) == math.inf == ratio(one, needed=1e9)


def test_a_campaign_is_asked_for_what_its_own_share_of_noise_asks(tmp_path: Path) -> None:
    """Where placebos of the model's form gain more, a name needs more, and what is just visible is what it was."""
    case = problem(tmp_path, 1)
    stated = fit(case, (), np.zeros(case.size), NOTHING, ())
    heavier = Hypothesis(AddedMass, {"x_m": 0.9, "y_m": 1.1})
    usual = replace(stored_thresholds(), evidence_form_nats=0.0)
    strict = replace(usual, evidence_form_nats=60.0)
    (few,), (many,) = (power(stated, [heavier], thresholds=t) for t in (usual, strict))
    own = strict.at(noise_share(case.measured, case.split.train))
    (known,) = power(stated, [heavier], thresholds=replace(own, evidence_form_nats=0.0))
    assert many.smallest == few.smallest
    assert many.named == pytest.approx(known.named)
    assert many.named > 1.1 * few.named


def test_what_shows_by_round_off_alone_never_shows(tmp_path: Path) -> None:
    """A clock that runs fast by a factor of ten million would, says the slope; a hum of a hundred million volts too."""
    case = problem(tmp_path, 1)
    stated = fit(case, (), np.zeros(case.size), NOTHING, ())
    unseen = [Hypothesis(available_effects()[name]) for name in ("clock-skew", "aliased-interference")]
    seen = Hypothesis(available_effects()["transducer-mass"])
    *never, sometimes = power(stated, [*unseen, seen])
    assert {p.smallest for p in never} == {p.named for p in never} == {math.inf}
    assert not any(p.alike for p in never)
    assert all(p.document()["smallest"] is None is p.document()["named"] for p in never)
    assert sometimes.smallest < sometimes.named < math.inf


def test_what_gets_a_name_is_more_than_shows_by_whatever_tolerances_give(tmp_path: Path) -> None:
    """A gain that the tolerances imitate in part: five deviations are 12.5 nats, and chance and a name take theirs."""
    case = problem(tmp_path, 1)
    stated = fit(case, (), np.zeros(case.size), NOTHING, ())
    limits = replace(stored_thresholds(), evidence_form_nats=0.0)
    known = available_effects()
    tried = [Hypothesis(known["channel-gain"], {"channels": "force"}), Hypothesis(known["drive-point-offset"])]
    deviations = 1.645 + math.sqrt(1.645**2 + 2 * limits.evidence_nats)
    for found in power(stated, tried, thresholds=limits):
        assert found.named > deviations / 5 * found.smallest
