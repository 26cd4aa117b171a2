"""An error that all channels of a run have from their force counts once; errors of their own count each for itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from added_noise import Noise

from vgvt.data import Campaign, ChannelRole, Dof
from vgvt.reconcile.evidence.localise import localise
from vgvt.reconcile.fitting.fit import fit
from vgvt.reconcile.fitting.misfit import coarse_sigma, data_misfit, jacobian, standardised
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.data import Measured, MeasuredChannel, measured_frfs
from vgvt.reconcile.question.problem import problem_of
from vgvt.reconcile.question.shared_noise import apart, in_phase
from vgvt.scenario import load_scenario
from vgvt.simulation import simulated_campaign

LINES, OF_RUN = 400, (3, 1, 2)
EVERY = np.ones(sum(OF_RUN), dtype=bool)


def judged(share: float, floor: float = 0.0) -> Measured:
    """Three runs of three, one and two channels, with a share of their noise that is the force's."""
    g = np.random.default_rng(3)
    channels = tuple(
        MeasuredChannel(r, r + 1, Dof.from_label(f"{10 * r + k + 1}+Z"), k)
        for r, count in enumerate(OF_RUN)
        for k in range(count)
    )
    values = np.exp(0.7 * g.standard_normal((len(channels), LINES)) + 2j * np.pi * g.random((len(channels), LINES)))
    noise = (0.1 * np.abs(values)) ** 2
    nodes = tuple(tuple(c.dof.node for c in channels if c.run == r) for r in range(len(OF_RUN)))
    return Measured(
        np.arange(LINES) + 1.0, channels, values, noise, {}, np.sqrt(noise), np.ones((len(OF_RUN), LINES), complex),
        np.arange(LINES), 1.0, nodes, 1e3, np.ones((len(OF_RUN), 2)),
        of_force=in_phase(np.full(noise.shape, share), values),
    ).with_floor(floor)  # fmt: skip


def drawn(measured: Measured, share: float, draws: int = 60) -> np.ndarray:
    """What noise does to A/F in standard deviations, (draws, C, L): a factor for the whole run, and each its own."""
    g = np.random.default_rng(4)

    def unit(*shape: int) -> np.ndarray:
        return (g.standard_normal(shape) + 1j * g.standard_normal(shape)) / np.sqrt(2)

    run = np.array([c.run for c in measured.channels])
    factor = unit(draws, len(OF_RUN), LINES)[:, run]
    own = unit(draws, run.size, LINES)
    relative = 0.1 * (np.sqrt(share) * factor + np.sqrt(1 - share) * own)
    return relative * measured.values / measured.sigma


@pytest.mark.parametrize("share", [0.3, 0.85])
def test_noise_of_any_share_becomes_independent(share: float) -> None:
    measured = judged(share)
    seen = drawn(measured, share)
    turned = np.array([apart(measured, EVERY, one) for one in seen])
    phase = np.exp(-1j * np.angle(measured.values))
    for noise, shared in ((seen, share), (turned, 0.0)):
        rows = (noise * phase).transpose(1, 0, 2).reshape(EVERY.size, -1)
        correlation = rows @ rows.conj().T / rows.shape[1]
        wanted = np.eye(EVERY.size)
        for a in range(EVERY.size):
            for b in range(EVERY.size):
                if a != b and measured.channels[a].run == measured.channels[b].run:
                    wanted[a, b] = shared
        assert np.abs(correlation - wanted).max() < 0.03


def test_a_factor_of_a_whole_run_counts_as_one_value_and_what_differs_counts_for_more() -> None:
    """Of three channels that share 85 %: in common a variance of 1 + 2 · 0.85, apart of 0.15."""
    measured = judged(0.85)
    phase = np.exp(1j * np.angle(measured.values))
    together, against = np.zeros_like(phase), np.zeros_like(phase)
    together[:3] = phase[:3]
    against[0], against[1] = phase[0], -phase[1]
    assert np.sum(np.abs(apart(measured, EVERY, together)) ** 2) == pytest.approx(3 * LINES / (1 + 2 * 0.85))
    assert np.sum(np.abs(apart(measured, EVERY, against)) ** 2) == pytest.approx(2 * LINES / 0.15)


def test_an_error_of_the_model_is_nobodys_share() -> None:
    """A floor as large as the noise halves what is shared of all that a line is judged by."""
    measured = judged(0.85)
    floor = measured.with_floor(0.1 / np.sqrt(1 + np.median(np.abs(measured.values)) ** 2))
    together = np.where(np.arange(EVERY.size)[:, None] < 3, np.exp(1j * np.angle(measured.values)), 0)
    share = 0.85 * measured.noise[:3] / floor.sigma[:3] ** 2
    assert np.all(share < 0.85)
    assert np.sum(np.abs(apart(floor, EVERY, together)) ** 2) > 1.2 * np.sum(
        np.abs(apart(measured, EVERY, together)) ** 2
    )


def test_where_nothing_is_shared_nothing_is_touched() -> None:
    change = np.ones((EVERY.size, LINES), complex)
    assert apart(replace(judged(0.5), of_force=None), EVERY, change) is change
    assert apart(judged(1e-4), EVERY, change) is change


def test_many_changes_at_once_are_each_of_them_alone() -> None:
    measured, g = judged(0.6), np.random.default_rng(5)
    kept = np.array([True, False, True, True, True, True])
    changes = g.standard_normal((5, LINES, 4)) + 1j * g.standard_normal((5, LINES, 4))
    together = apart(measured, kept, changes)
    for k in range(4):
        assert np.allclose(together[:, :, k], apart(measured, kept, changes[:, :, k]), atol=1e-12)
    # Alone in its run a channel shares nothing.
    assert np.array_equal(together[2], changes[2])


@pytest.fixture(name="quiet", scope="module")
def campaign_without_noise() -> Campaign:
    """Hati, two runs of four sensors; a short sweep, in which the force drops out at resonances."""
    scenario = load_scenario("hati-unsymmetric")
    silent = {"noise": None}
    changes = {
        "accelerometers": scenario.accelerometers.model_copy(update=silent),
        "transducer": scenario.transducer.model_copy(update=silent),
        "acquisition": scenario.acquisition.model_copy(
            update={
                "sample_rate_hz": 250.0, "runs": ((1, 6, 13, 18), (3, 8, 11, 20)), "noise_v_per_rthz": 0.0, "bits": 32,
            }
        ),
        "excitation": scenario.excitation.model_copy(
            update={"start_hz": 3.0, "stop_hz": 35.0, "duration_s": 14.0, "ring_down_s": 3.0}
        ),
    }  # fmt: skip
    return simulated_campaign(scenario.model_copy(update=changes), engine="linear")


def test_the_share_of_the_force_is_found_in_the_records(quiet: Campaign) -> None:
    """Against what theory gives for the noise that was added; and noise of accelerometers alone is not the force's."""
    noise, g = Noise(0.03, False), np.random.default_rng(6)
    found, wanted = [], []
    for _ in range(4):
        measured = measured_frfs(noise.on(quiet, g), lines=200)
        exact, variance = noise.variance(quiet, measured)
        assert measured.of_force is not None
        assert np.allclose(measured.of_force, np.abs(measured.of_force) * np.exp(1j * np.angle(measured.values)))
        found.append(np.abs(measured.of_force) ** 2)
        wanted.append(_of_force(noise, quiet, measured, exact) / variance)
    assert np.mean(found) == pytest.approx(np.mean(wanted), rel=0.2)
    most = np.mean(wanted, axis=0) > 0.7
    assert 10 < most.sum() < most.size / 2
    assert np.mean(found, axis=0)[most].mean() == pytest.approx(np.mean(wanted, axis=0)[most].mean(), rel=0.15)


def _of_force(noise: Noise, campaign: Campaign, measured: Measured, exact: np.ndarray) -> np.ndarray:
    """The part of the variance (C, L) of A/F that the gauge's noise makes."""
    relative = []
    for run in campaign.runs:
        k = next(k for k, c in enumerate(run.channels) if c.role is ChannelRole.REFERENCE)
        sd = noise.density(run.samples[k], run.sample_rate_hz, campaign.band_hz, ChannelRole.REFERENCE)
        force = np.fft.rfft(run.samples[k] - run.samples[k].mean())[measured.lines]
        relative.append(run.samples.shape[1] * sd**2 / np.abs(force) ** 2)
    return np.abs(exact) ** 2 * np.array([relative[c.run] for c in measured.channels])


def test_slopes_of_a_fit_are_those_of_its_misfit(quiet: Campaign) -> None:
    """Of what each unknown does to the misfit, whose channels are not each for itself: drive, gains and all."""
    measured = measured_frfs(Noise(0.03, False).on(quiet, np.random.default_rng(7)), lines=60)
    scenario = load_scenario("hati-unsymmetric")
    problem = problem_of(measured, scenario)
    here = anchor(problem, np.zeros(problem.size))
    none, stated = np.zeros(0), here.predict(here.u0, np.zeros(0))
    tangent = jacobian(here, here.u0, none, stated)
    direction = np.random.default_rng(8).standard_normal(problem.size)
    step = 1e-4
    ends = [data_misfit(problem, here.predict(side * step * direction, none)) for side in (1, -1)]
    wanted = (ends[0] - ends[1]) / (2 * step)
    assert np.linalg.norm(tangent @ direction - wanted) < 1e-3 * np.linalg.norm(wanted)
    alone = data_misfit(replace(problem, measured=replace(measured, of_force=None)), stated)
    assert np.linalg.norm(alone - data_misfit(problem, stated)) > 0.05 * np.linalg.norm(alone)
    # By a coarse error, which is nothing that channels share, each of them is for itself.
    change = stated[problem.split.train]
    coarse = coarse_sigma(problem, 0.15)
    assert np.array_equal(standardised(problem, change, coarse), change / coarse)


def test_what_a_place_explains_is_what_least_squares_take_of_the_misfit(quiet: Campaign) -> None:
    """A free factor on one sensor, line by line, beside the unknowns: by one dense solution of the fit's own misfit."""
    measured = measured_frfs(Noise(0.03, False).on(quiet, np.random.default_rng(9)), lines=60)
    problem = problem_of(measured, load_scenario("hati-unsymmetric"))
    stated = fit(problem, (), np.zeros(problem.size), np.zeros(0), ())
    channel = int(np.flatnonzero(problem.split.train)[2])
    columns = []
    for line in range(measured.frequency_hz.size):
        for factor in (1.0, 1.0j):
            moved = measured.values.copy()
            moved[channel, line] += factor * stated.predicted[channel, line]
            columns.append(data_misfit(problem, moved))
    unknowns = np.vstack([stated.tangent, np.eye(problem.size)])
    free = np.vstack([np.array(columns).T, np.zeros((problem.size, len(columns)))])
    target = np.concatenate([data_misfit(problem, stated.predicted), stated.u])

    def left(slopes: np.ndarray) -> float:
        return 0.5 * float(np.sum((target - slopes @ np.linalg.lstsq(slopes, target, rcond=None)[0]) ** 2))

    before, after = left(unknowns), left(np.hstack([unknowns, free]))
    (place,) = (p for p in localise(stated).places if p.label == measured.channels[channel].label)
    assert place.explained == pytest.approx((before - after - measured.frequency_hz.size) / before, abs=1e-6)
