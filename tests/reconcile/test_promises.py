"""What a test promises, against what making it would come to: by the same noise, and with the same freedom."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from added_noise import Noise
from reconciled_case import (
    claimed,
    roving_problem,
    small_scenario,
    without_instrument_noise,
)

from vgvt.data import Campaign
from vgvt.effects import Effect, available_effects
from vgvt.effects.conformance import table_of
from vgvt.reconcile.evidence.rivals import against
from vgvt.reconcile.fitting.fit import NEAR, TO_THE_END, Fit, fit
from vgvt.reconcile.next_test import suggest as suggesting
from vgvt.reconcile.next_test.procedures import Procedure, changed, procedures
from vgvt.reconcile.next_test.suggest import expected_nats, foretold_by, found_nats, known_in, words_of_none
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.question.thresholds import noise_share
from vgvt.scenario import Scenario
from vgvt.simulation import simulated_campaign

DELAY = {"delay_s": 4e-5}


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return roving_problem(tmp_path_factory.mktemp("cache"), lines=60)


def test_a_foretold_campaign_is_judged_as_the_measured_one(case: Problem) -> None:
    """Where an explanation foretells what was measured: noise that is the same at peaks and between, and the floor."""
    plain = claimed(case, "channel-gain", {"gain_error": 0.0})
    noise = np.full_like(case.measured.noise, np.median(np.abs(plain.predicted)) ** 2 * 1e-4)
    share = np.sqrt(0.5) * np.exp(1j * np.angle(plain.predicted))
    measured = replace(case.measured, values=plain.predicted, noise=noise, of_force=share).with_floor(0.004)
    told, _ = foretold_by(plain, replace(case, measured=measured))
    assert np.allclose(told.measured.sigma, measured.sigma, rtol=1e-9)
    # What the force adds is seen once, however many channels share it, and turns with what is foretold.
    assert told.measured.of_force is not None
    assert np.allclose(told.measured.of_force, share)
    late = claimed(case, "channel-delay", {"delay_s": 1e-3})
    turned, _ = foretold_by(late, replace(case, measured=measured))
    assert turned.measured.of_force is not None
    assert np.allclose(turned.measured.of_force * np.exp(-1j * np.angle(late.predicted)), np.sqrt(0.5))
    # A channel without data is asked nothing.
    lost = np.arange(len(case.measured.channels)) == 3
    without = replace(measured, sigma=np.where(lost[:, None], np.inf, measured.sigma), lost=lost)
    judged = foretold_by(plain, replace(case, measured=without))[0].measured.sigma
    assert np.isinf(judged[lost]).all() and np.isfinite(judged[~lost]).all()


def test_an_explanation_is_not_told_from_itself(case: Problem) -> None:
    """Whatever its unknowns cost it: fitted again, either of the two gives way alike."""
    hypothesis = Hypothesis(available_effects()["channel-delay"])
    u = np.random.default_rng(1).standard_normal(case.size)
    found = fit(case, (hypothesis,), u, hypothesis.scores(DELAY), ())
    assert expected_nats(found, found, case) == pytest.approx(0.0, abs=0.01)
    # Half of |u|² is 30 and more; what is left is how straight the way is.
    assert found_nats(found, found, case) == pytest.approx(0.0, abs=1.5)


@pytest.mark.parametrize("words", ["half as stiff", pytest.param("average 16 sweeps", marks=pytest.mark.slow)])
def test_nats_are_promised_as_a_verdict_counts_them(case: Problem, words: str) -> None:
    """Of data that are judged by the model's form, where one value is worth a third of one, or a fifth."""
    size = np.abs(case.measured.values) ** 2
    quiet = replace(case.measured, noise=0.3 * 0.004**2 * size).with_floor(0.004)
    loud = replace(case, measured=quiet)
    right = claimed(loud, "channel-delay", DELAY)
    wrong = claimed(loud, "channel-gain", {"gain_error": 0.0})
    after = changed(loud, next(p for p in procedures(loud) if words in p.words))
    data = replace(after.measured, values=fit(after, right.hypotheses, right.u, right.e, ()).predicted)
    data = data.with_floor(0.004)
    counted = []
    for seed in (1, 2, 3):
        drawn = np.random.default_rng(seed).standard_normal((2, *data.values.shape)) * data.sigma / np.sqrt(2)
        told = replace(after, measured=replace(data, values=data.values + drawn[0] + 1j * drawn[1]))
        fits = [fit(told, f.hypotheses, f.u, f.e, NEAR) for f in (right, wrong)]
        nats = {r.name: r.gain_nats for r in against(fit(told, (), right.u, np.zeros(0), ()), fits)}
        counted.append(nats["channel-delay"] - nats["channel-gain"])
    assert noise_share(after.measured, after.split.train).worth < 0.4
    for promised in (expected_nats(right, wrong, after), found_nats(right, wrong, after)):
        assert promised == pytest.approx(np.mean(counted), rel=0.2)


@pytest.mark.parametrize(("count", "hollow", "unfollowed"), [(12, 8, 0), (12, 12, 0), (30, 30, 6)])
def test_promises_are_followed_until_one_holds_and_what_was_not_followed_is_said(
    case: Problem, monkeypatch: pytest.MonkeyPatch, count: int, hollow: int, unfollowed: int
) -> None:
    """The first ones do not hold theirs: that says nothing of those behind them."""
    tests = tuple(Procedure(f"{k}", lambda s: s, 5.0) for k in range(count))
    monkeypatch.setattr(suggesting, "checks", lambda problem: ())
    monkeypatch.setattr(suggesting, "procedures", lambda problem: tests)
    monkeypatch.setattr(suggesting, "changed", lambda problem, p: int(p.words))
    monkeypatch.setattr(suggesting, "expected_nats", lambda one, other, problem: 49.0 - problem)
    monkeypatch.setattr(suggesting, "found_nats", lambda one, other, problem: 1.0 if problem < hollow else 30.0)
    one = claimed(case, "channel-gain", {"gain_error": 0.05})
    told = suggesting.suggest([one, one])
    if hollow < count:
        assert (told[0].test, told[0].nats) == (f"{hollow}", 30.0)
        assert not words_of_none(told, 5.0)
        return
    assert told[0].unfollowed == unfollowed
    assert "unfollowed" not in told[0].document()
    (said,) = words_of_none(told, 5.0)
    assert said.startswith("None of the tests that were " + ("followed" if unfollowed else "compared"))
    assert (f"{unfollowed} more promise more" in said) == bool(unfollowed)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "sizes", "settings", "words"),
    [
        ("channel-delay", DELAY, {}, "half as stiff"),
        ("added-mass", {"mass_kg": 0.004}, {"x_m": 0.9, "y_m": 1.1}, "mirror image"),
    ],
)
def test_a_campaign_brings_the_nats_that_were_promised(
    tmp_path: Path, name: str, sizes: dict[str, float], settings: dict[str, float], words: str
) -> None:
    stated, effect = small_scenario(), available_effects()[name](**sizes, **settings)
    case = make_problem(_recorded(stated, 1, effect), stated, lines=200, cache=tmp_path)
    gain = Hypothesis(available_effects()["channel-gain"])
    pair = ((Hypothesis(available_effects()[name], dict(settings)), sizes), (gain, {"gain_error": 0.0}))
    one, other = (_as_stated(case, h, values) for h, values in pair)
    (procedure,) = (p for p in procedures(case) if words in p.words)
    promised = expected_nats(one, other, changed(case, procedure))
    edited = procedure.edit(stated)
    brought = []
    for seed in (2, 3, 4):
        again = make_problem(_recorded(edited, seed, effect), edited, lines=200, cache=tmp_path)
        without = fit(again, (), known_in(again, one), np.zeros(0), TO_THE_END)
        ends = [fit(again, f.hypotheses, known_in(again, f), f.e, TO_THE_END) for f in (one, other)]
        nats = {rival.name: rival.gain_nats for rival in against(without, ends)}
        brought.append(nats[name] - nats["channel-gain"])
    assert promised is not None
    assert np.mean(brought) / 1.5 < promised < np.mean(brought) * 1.5


def _recorded(scenario: Scenario, seed: int, effect: Effect) -> Campaign:
    """One per cent of noise on what the aircraft as stated does with an effect."""
    true = without_instrument_noise(scenario).model_copy(update={"effect": (table_of(effect),)})
    return Noise(0.01, False).on(simulated_campaign(true, engine="linear"), np.random.default_rng(seed))


def _as_stated(case: Problem, hypothesis: Hypothesis, values: dict[str, float]) -> Fit:
    """An effect of a given size beside the stated values, the chain as coarse as the scenario says."""
    u = np.zeros(case.size)
    u[len(case.unknowns) - 1] = -6.0
    return fit(case, (hypothesis,), u, hypothesis.scores(values), ())
