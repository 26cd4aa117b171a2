"""An error of the model's form that lasts from line to line is one error, and buys an effect no more than one does."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scipy.stats
from numpy.typing import NDArray
from reconciled_case import problem

from vgvt.effects import available_effects
from vgvt.reconcile.evidence.lasting import LENGTH, SHARE, Imitated, lasting, lasting_evidence
from vgvt.reconcile.evidence.rivals import Rival, against
from vgvt.reconcile.fitting.fit import NEAR, TO_THE_END, fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import stored_thresholds

Array = NDArray[np.float64]
NOTHING = np.zeros(0)


@dataclass(eq=False)
class Records:
    """Of what was measured, what such errors depend on."""

    values: NDArray[np.complex128]
    sigma: Array
    noise: Array
    frequency_hz: Array


def case(generator: np.random.Generator, channels: int, lines: int, noise: float) -> Any:
    """A problem of so many channels, one of them held out, whose noise is that share of what it is judged by."""
    values = generator.standard_normal((channels, lines)) + 1j * generator.standard_normal((channels, lines))
    sigma = generator.uniform(0.5, 2.0, (channels, lines))
    measured = Records(values, sigma, noise * sigma**2, np.linspace(3, 35, lines))
    return SimpleNamespace(measured=measured, split=SimpleNamespace(train=np.arange(channels) > 0))


def errors(of: Any, generator: np.random.Generator, noise: float) -> Array:
    """Noise, and an error of the form in two parts: one that is new on every line and one that drifts along them.

    Standardised as misfits are, (2 N,).
    """
    values = of.measured.values[of.split.train]
    count, lines = values.shape
    kept = np.exp(-1 / (LENGTH * lines))

    def fresh(*shape: int) -> NDArray[np.complex128]:
        return generator.standard_normal(shape) + 1j * generator.standard_normal(shape)

    drift = np.empty(values.shape, complex)
    drift[:, 0] = fresh(count)
    for k in range(1, lines):
        drift[:, k] = kept * drift[:, k - 1] + np.sqrt(1 - kept**2) * fresh(count)
    form = np.sqrt(1 - SHARE) * fresh(count, lines) + np.sqrt(SHARE) * drift * values / np.abs(values)
    whole = np.sqrt(noise) * fresh(count, lines) + np.sqrt(1 - noise) * form
    return np.concatenate([whole.real.ravel(), whole.imag.ravel()])


@pytest.mark.parametrize("noise", [0.0, 0.3, 1.0])
def test_errors_as_they_are_declared_are_white_afterwards(noise: float) -> None:
    """Each drawn line by line, which knows nothing of a matrix: as much on every line, and nothing that lasts."""
    generator = np.random.default_rng(1)
    of = case(generator, 4, 60, noise)
    drawn = np.array([errors(of, generator, noise) for _ in range(1500)])
    white = lasting(of, drawn.T).T.reshape(-1, 2, 3, 60)
    assert np.abs((white**2).mean(axis=0) - 1).max() < 0.2
    for lag in (1, 5, 20):
        assert abs((white[..., lag:] * white[..., :-lag]).mean()) < 0.01
        before = drawn.reshape(-1, 2, 3, 60)
        turned = (before[:, 0] + 1j * before[:, 1]) * np.exp(-1j * np.angle(of.measured.values[1:]))
        together = (turned[..., lag:] * turned[..., :-lag].conj()).real.mean() / 2
        assert together == pytest.approx((1 - noise) * SHARE * np.exp(-lag / (LENGTH * 60)), abs=0.03)
    if noise == 1.0:
        np.testing.assert_allclose((white**2).sum(axis=(1, 2, 3)), (drawn**2).sum(axis=1))


@pytest.mark.slow
def test_the_evidence_is_the_probability_of_the_data() -> None:
    """The density of such errors and of all that the priors allow, at the bottom by the other measure, not by this one.

    Their covariance is checked against draws, the rest is another formula.
    """
    generator = np.random.default_rng(2)
    noise, of = 0.4, case(generator, 3, 12, 0.4)
    size = 2 * 2 * 12
    unit = np.linalg.inv(lasting(of, np.eye(size)))
    drawn = np.array([errors(of, generator, noise) for _ in range(60_000)])
    covariance = unit @ unit.T
    np.testing.assert_allclose(np.cov(drawn.T), covariance, atol=0.03)
    apart, wide, narrow = (generator.standard_normal((size, k)) for k in (1, 3, 2))
    values = []
    for slopes in (wide, narrow):
        bottom = -np.linalg.solve(slopes.T @ slopes + np.eye(slopes.shape[1]), slopes.T @ apart[:, 0])
        told = lasting_evidence(of, apart[:, 0] + slopes @ bottom, slopes, bottom, 0.0)
        values.append((told, scipy.stats.multivariate_normal(cov=covariance + slopes @ slopes.T).logpdf(apart[:, 0])))
    (told_wide, true_wide), (told_narrow, true_narrow) = values
    assert told_wide - told_narrow == pytest.approx(true_wide - true_narrow, abs=1e-6)
    bare = (of, apart[:, 0], apart[:, :0], NOTHING)
    assert lasting_evidence(*bare, -2.5) == pytest.approx(lasting_evidence(*bare, 0.0) - 2.5)


def test_steps_go_no_further_than_slopes_carry() -> None:
    """Of the way to the bottom by this measure, what twenty deviations take off: their cost there, worked out anew."""
    generator = np.random.default_rng(6)
    of = case(generator, 3, 12, 0.0)
    slopes = generator.standard_normal((48, 2))
    apart = 1e3 * generator.standard_normal(48)
    bottom = -np.linalg.solve(slopes.T @ slopes + np.eye(2), slopes.T @ apart)
    judged = lasting(of, np.column_stack([apart, slopes]))
    whole = np.vstack([judged[:, 1:], np.eye(2)])
    other = np.linalg.lstsq(whole, np.append(-judged[:, 0], np.zeros(2)))[0]
    far = np.abs(other - bottom).max()
    assert far > 30
    there = bottom + 20 / far * (other - bottom)
    cost = np.sum((judged[:, 0] + judged[:, 1:] @ there) ** 2) + there @ there
    occam = 0.5 * np.linalg.slogdet(whole.T @ whole)[1]
    told = lasting_evidence(of, apart + slopes @ bottom, slopes, bottom, 0.0)
    assert told == pytest.approx(-0.5 * cost - occam, rel=1e-9)


def test_slopes_that_promise_what_is_not_there_are_not_believed() -> None:
    """Where noise is all, this measure is the fit's own: at its bottom nothing is left, whatever wrong slopes say."""
    generator = np.random.default_rng(5)
    of = case(generator, 3, 12, 1.0)
    misfit, slopes = generator.standard_normal(48), generator.standard_normal((48, 3))
    scores = -np.linalg.solve(slopes.T @ slopes + np.eye(3), slopes.T @ misfit)
    wrong = slopes + 0.5 * generator.standard_normal((48, 3))
    left = misfit + slopes @ scores
    assert np.abs(wrong.T @ left + scores).max() > 1
    occam = 0.5 * np.linalg.slogdet(wrong.T @ wrong + np.eye(3))[1]
    assert lasting_evidence(of, left, wrong, scores, 0.0) == pytest.approx(
        -0.5 * (left @ left + scores @ scores) - occam
    )


def test_a_fit_that_was_broken_off_promises_no_less_than_nothing() -> None:
    """A square sum of -7756: what a fit still has to gain was taken off what another measure sees of its misfit."""
    generator = np.random.default_rng(7)
    of = case(generator, 3, 40, 0.0)
    values = of.measured.values[of.split.train]
    turned = values / np.abs(values)
    slopes = np.concatenate([turned.real.ravel(), turned.imag.ravel()])[:, None]
    misfit, scores = 3.0 * slopes[:, 0], np.zeros(1)
    white = lasting(of, slopes)
    whole = np.vstack([white, np.eye(1)])
    aside = np.append(3.0 * white[:, 0], 0.0)
    left = aside - whole @ np.linalg.lstsq(whole, aside)[0]
    occam = 0.5 * np.linalg.slogdet(whole.T @ whole)[1]
    assert lasting_evidence(of, misfit, slopes, scores, 0.0, arrived=False) == pytest.approx(
        -0.5 * float(left @ left) - occam, abs=1e-9
    )
    assert lasting_evidence(of, misfit, slopes, scores, 0.0) == pytest.approx(-occam)


@pytest.mark.parametrize("noise", [0.0, 0.4, 1.0])
def test_at_the_bottom_of_a_fit_it_is_all_one_whether_it_says_so(noise: float) -> None:
    """Names rest on this figure: of fits that have ended it is what it has always been."""
    generator = np.random.default_rng(8)
    of = case(generator, 3, 12, noise)
    slopes, apart = generator.standard_normal((48, 3)), generator.standard_normal(48)
    bottom = -np.linalg.solve(slopes.T @ slopes + np.eye(3), slopes.T @ apart)
    left = apart + slopes @ bottom
    judged = lasting(of, np.column_stack([left, slopes]))
    downhill = judged[:, 1:].T @ judged[:, 0] + bottom
    precision = judged[:, 1:].T @ judged[:, 1:] + np.eye(3)
    cost = judged[:, 0] @ judged[:, 0] + bottom @ bottom - downhill @ np.linalg.solve(precision, downhill)
    always = -0.5 * (cost + np.linalg.slogdet(precision)[1])
    for arrived in (True, False):
        assert lasting_evidence(of, left, slopes, bottom, 0.0, arrived=arrived) == pytest.approx(always, rel=1e-12)


def test_what_the_unknowns_imitate_shows_no_deviation() -> None:
    generator = np.random.default_rng(3)
    of = case(generator, 3, 20, 0.2)
    slopes = 1e4 * generator.standard_normal((80, 2))
    told = Imitated.of(of, slopes)
    assert told.deviations(np.concatenate([slopes @ [2e-4, -1e-4], np.zeros(2)])) < 1e-3
    # What tolerances give counts where data say nothing.
    assert Imitated.of(of, 0 * slopes).deviations(np.concatenate([np.zeros(80), [3.0, 4.0]])) < 1e-12
    other = np.concatenate([generator.standard_normal(80), np.zeros(2)])
    assert told.deviations(other) < np.linalg.norm(lasting(of, other[:80, None]))
    assert told.deviations(other) > 1


@pytest.mark.slow
def test_a_lasting_error_of_one_channel_gets_no_name_and_moved_peaks_do(tmp_path: Path) -> None:
    """What grows with frequency is what a loose sensor would read, and none is loose; a mass moves peaks."""
    stated = problem(tmp_path, 1)
    start = np.zeros(stated.size)
    foretold = fit(stated, (), start, NOTHING, ()).predicted
    data = replace(stated.measured, values=foretold.copy(), noise=0.2 * stated.measured.sigma**2)

    limits, generator = stored_thresholds(), np.random.default_rng(4)
    white = generator.standard_normal((2, *foretold.shape)) * np.sqrt(data.noise / 2)

    def gains(values: NDArray[np.complex128], hypothesis: Hypothesis, begin: Array) -> Rival:
        here = replace(stated, measured=replace(data, values=values + white[0] + 1j * white[1]))
        null = fit(here, (), start, NOTHING, TO_THE_END)
        (rival,) = against(null, [fit(here, (hypothesis,), null.u, begin, NEAR)])
        return rival

    channel = int(np.flatnonzero(stated.split.train)[2])
    floor = np.sqrt(data.sigma[channel] ** 2 - data.noise[channel])
    error = 4 * floor * (data.frequency_hz / data.frequency_hz[-1]) ** 2
    drifting = foretold.copy()
    drifting[channel] += error * np.exp(1j * np.angle(foretold[channel]))
    loose = Hypothesis(available_effects()["loose-sensor-mount"], {"node": data.channels[channel].dof.node})
    imagined = gains(drifting, loose, loose.scores({"period_s": 2e-3}))
    assert imagined.gain_nats > limits.evidence_nats > imagined.lasting_nats
    assert not imagined.convinces(limits)
    heavier = Hypothesis(available_effects()["added-mass"], {"x_m": 0.9, "y_m": 1.1})
    there = fit(stated, (heavier,), start, heavier.scores({"mass_kg": 0.005}), ())
    real = gains(there.predicted, heavier, there.e)
    assert real.lasting_nats > 0.2 * real.raw_nats
    assert real.convinces(limits)
