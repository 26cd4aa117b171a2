"""Held-out data confirm a name, refuse it, or cannot tell: an effect on fitted channels alone is none of theirs."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from reconciled_case import campaign_of, roving_scenario

from vgvt.data import Dof
from vgvt.effects import available_effects
from vgvt.reconcile.evidence import confirmation
from vgvt.reconcile.evidence.confirmation import confirmed_by_held_out, held_out_nats, takes_enough
from vgvt.reconcile.fitting.fit import Fit, fit
from vgvt.reconcile.question.data import Measured, MeasuredChannel
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.question.shared_noise import in_phase

CHANNELS, LINES = 8, 100
BEFORE: Any = SimpleNamespace(
    held_out_chi2_per_dof=1.0,
    held_out_noise_per_dof=1.0,
    train_chi2_per_dof=1.0,
    noise_per_dof=1.0,
    strain_sd=2.0,
    limits=SimpleNamespace(held_out_per_dof=1.2, chi2_per_dof=1.2, strain_sd=3.0),
)
STRAINED: Any = SimpleNamespace(**{**vars(BEFORE), "strain_sd": 60.0})
NEEDS: Any = SimpleNamespace(evidence_nats=9.0)


def white() -> Any:
    """A fit that leaves white noise (C, L); the first two channels are held out."""
    g = np.random.default_rng(0)
    shape = (CHANNELS, LINES)
    left = (g.standard_normal(shape) + 1j * g.standard_normal(shape)) / np.sqrt(2)
    held = np.arange(CHANNELS) < 2
    measured = SimpleNamespace(
        values=np.ones(shape, complex), sigma=np.ones(shape), noise=np.ones(shape), of_force=None
    )
    problem = SimpleNamespace(measured=measured, split=SimpleNamespace(held=held, train=~held))
    return SimpleNamespace(problem=problem, foretold=1 + left, scores=np.zeros(3))


@pytest.fixture
def confirmed(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Whether a name is confirmed by what is missed with it, the scores needed without, and what its effect does."""

    def asked(
        held_out: float, null_scores: float, apart: float = 0.0, felt: float = 1000.0, enough: bool = False,
        before: Any = BEFORE,
    ) -> bool:  # fmt: skip
        own = white()
        monkeypatch.setattr(confirmation, "_felt", lambda found: felt)
        monkeypatch.setattr(confirmation, "takes_enough", lambda *given: enough)
        gained = 2 * LINES * (before.held_out_chi2_per_dof - held_out)
        monkeypatch.setattr(
            confirmation,
            "held_out_nats",
            lambda judge, *given: gained * confirmation._worth(judge, judge.problem.split.held),
        )
        null: Any = SimpleNamespace(scores=np.array([null_scores, 0.0, 0.0]), foretold=own.foretold + apart)
        return confirmed_by_held_out(own, held_out, null, before, NEEDS)

    return asked


def test_held_out_data_must_speak_for_a_name(confirmed: Any) -> None:
    """A gain on fitted data alone is refused, unless it is the tolerances that speak and nothing speaks against it."""
    assert confirmed(0.9, 0.0)
    assert not confirmed(1.0, 0.0)
    assert not confirmed(1.1, 0.0)
    assert confirmed(1.0, 5.0)
    assert not confirmed(1.1, 5.0)
    # 200 held-out values: 6 nats against it are chance where the two predictions are 8 apart, and are not where 2.
    assert confirmed(1.03, 5.0, apart=0.2)
    assert not confirmed(1.03, 5.0, apart=0.05)
    assert not confirmed(1.03, 0.0, apart=0.2)


def fitted(left: float, bent: float = 0.0) -> Any:
    """A fit of a hundred values that leaves so much of each, with one of its two scores ``bent``."""
    scores = np.array([bent, 1.0])
    return SimpleNamespace(
        chi2=100 * left, cost=100 * left + scores @ scores, chi2_per_dof=left, points=100,
        scores=scores, u=scores, covariance=np.zeros((2, 2)),
        problem=SimpleNamespace(names=("a", "b")),
    )  # fmt: skip


@pytest.mark.parametrize(("left", "enough"), [(1.15, True), (28.0, False), (23.5, False), (22.5, True)])
def test_fitted_data_that_are_still_missed_must_be_met_much_better_too(left: float, enough: bool) -> None:
    """By a quarter of the 29 too much that there were; where nothing is missed any more by whatever there was."""
    assert takes_enough(fitted(left), fitted(30.0), BEFORE) is enough
    assert takes_enough(fitted(1.18), fitted(1.19), BEFORE)


@pytest.mark.parametrize(("bent", "enough"), [(30.0, False), (29.0, False), (25.0, True), (1.0, True)])
def test_what_the_tolerances_get_back_counts_as_well(bent: float, enough: bool) -> None:
    """A gain 30 of its deviations off misses nothing: 100 too much in the data beside the 900 that it costs."""
    assert takes_enough(fitted(1.9, bent), fitted(2.0, 30.0), BEFORE) is enough


def test_much_of_what_the_data_miss_will_do_whatever_the_tolerances_still_give() -> None:
    """Of two missing effects one may be in the data alone, and another in the tolerances alone: 900 beside 100."""
    assert takes_enough(fitted(1.7, 30.0), fitted(2.0, 30.0), BEFORE)
    assert not takes_enough(fitted(1.8, 30.0), fitted(2.0, 30.0), BEFORE)


def test_most_of_what_the_tolerances_gave_will_do_whatever_the_data_still_miss() -> None:
    """900 of 2900 beyond: a gain bent by thirty of its deviations is set right, and the data are missed as before."""
    assert takes_enough(fitted(30.0, 5.0), fitted(30.0, 10.0), STRAINED)
    assert not takes_enough(fitted(30.0, 9.0), fitted(30.0, 10.0), STRAINED)
    # What is no more than chance has nothing to give back.
    assert not takes_enough(fitted(30.0, 0.0), fitted(30.0, 2.0), BEFORE)


def test_held_out_data_that_miss_another_effect_need_not_be_met_much_better(confirmed: Any) -> None:
    """A mass that the tolerances had imitated, beside a mount that held-out data feel: they must not speak against."""
    missed: Any = SimpleNamespace(**{**vars(BEFORE), "held_out_chi2_per_dof": 1.5})
    assert confirmed(1.49, 5.0, enough=True, before=missed)
    assert not confirmed(1.49, 5.0, enough=False, before=missed)
    assert not confirmed(1.6, 5.0, enough=True, before=missed)
    assert confirmed(1.3, 5.0, enough=False, before=missed)


def test_of_what_they_do_not_feel_held_out_data_only_speak_against(confirmed: Any) -> None:
    assert confirmed(1.0, 0.0, felt=0.1)
    assert not confirmed(1.0, 0.0, felt=10.0)
    assert not confirmed(1.1, 0.0, felt=0.1)
    assert confirmed(1.03, 0.0, apart=0.2, felt=0.1)
    # And where they are missed they still have to be met much better.
    assert not confirmed(1.5, 0.0, felt=0.1)


def test_what_held_out_data_say_is_the_difference_of_their_likelihoods() -> None:
    """White noise, every value new: the drop of the square sum of 2 channels of 100 complex lines."""
    own = white()
    worse: Any = SimpleNamespace(problem=own.problem, foretold=own.foretold + np.sqrt(0.1), scores=own.scores)
    missed, without = (np.sum(np.abs(f.foretold - 1)[:2] ** 2) for f in (own, worse))
    assert held_out_nats(own, own, worse) == pytest.approx(without - missed, rel=0.15)
    assert held_out_nats(own, worse, own) == -held_out_nats(own, own, worse)


def test_noise_that_a_held_out_run_shares_is_not_news_of_it() -> None:
    """Two predictions of a run, one of them true, are 3 % apart by one factor; half of the noise is the force's.

    They are told apart by S ± sqrt(2 S) nats, S being the squared deviations between them; taken for noise of each
    channel its scatter is nearly twice that.
    """
    channels, draws, g = 5, 200, np.random.default_rng(6)

    def unit(*shape: int) -> NDArray[np.complex128]:
        return np.asarray((g.standard_normal(shape) + 1j * g.standard_normal(shape)) / np.sqrt(2))

    true = np.exp(0.5 * unit(channels, LINES))
    noise = (0.1 * np.abs(true)) ** 2
    held = np.ones(channels, bool)
    judged = Measured(
        np.linspace(1.0, 50.0, LINES),
        tuple(MeasuredChannel(0, 1, Dof.from_label(f"{k + 1}+Z"), k) for k in range(channels)),
        true, noise, {}, np.sqrt(noise), np.ones((1, LINES), complex), np.arange(LINES), 1.0, ((1, 2, 3, 4, 5),), 1e3,
        np.ones((1, 2)), of_force=in_phase(np.full(noise.shape, 0.5), true),
    )  # fmt: skip
    said = []
    for _ in range(draws):
        relative = 0.1 * np.sqrt(0.5) * (unit(1, LINES) + unit(channels, LINES))
        problem: Any = SimpleNamespace(
            measured=replace(judged, values=true * (1 + relative)), split=SimpleNamespace(held=held)
        )
        right, wrong = (SimpleNamespace(problem=problem, foretold=true * factor) for factor in (1.0, 1.03))
        between = confirmation._square_sum(confirmation._of(problem, held, wrong.foretold - right.foretold))
        worth = confirmation._worth(right, held)  # type: ignore[arg-type]
        nats = held_out_nats(right, right, wrong) / worth  # type: ignore[arg-type]
        said.append((nats - between) / np.sqrt(2 * between))
    assert np.std(said) == pytest.approx(1.0, abs=0.15)
    assert abs(np.mean(said)) < 0.2


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A campaign of roving sensors."""
    scenario = roving_scenario()
    return make_problem(campaign_of(scenario, 1), scenario, lines=150, cache=tmp_path_factory.mktemp("cache"))


def delayed(case: Problem, held: bool) -> Fit:
    """A delay of 1 ms on one channel, held out or not, as if it had been fitted."""
    where = case.split.held_channels if held else case.split.train
    label = str(case.measured.channels[int(np.flatnonzero(where)[0])].dof)
    hypothesis = Hypothesis(available_effects()["channel-delay"], {"channels": label})
    return fit(case, (hypothesis,), np.zeros(case.size), hypothesis.scores({"delay_s": 1e-3}), ())


def test_what_is_felt_is_what_the_effect_does_to_held_out_data(case: Problem) -> None:
    assert confirmation._felt(delayed(case, held=False)) == 0
    found = delayed(case, held=True)
    row = case.split.held_channels & np.any(
        found.predicted != fit(case, (), found.u, np.zeros(0), ()).predicted, axis=1
    )
    omega = 2 * np.pi * case.measured.frequency_hz
    wanted = np.abs(1 - np.exp(1j * omega * 1e-3)) * np.abs(found.predicted[row] / case.measured.sigma[row])
    assert confirmation._felt(found) == pytest.approx(float(np.sum(wanted**2)), rel=1e-9)
