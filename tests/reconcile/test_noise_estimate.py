"""The variance that a campaign's lines are given is that of the noise which was added to its records."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from added_noise import Noise

from vgvt.data import Campaign, Direction, Dof
from vgvt.reconcile.question.data import MeasuredChannel, measured_frfs
from vgvt.reconcile.question.variance import repeat_noise
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import simulated_campaign

BANDS = 10
RUNS = ((1, 6, 13, 18), (3, 8, 11, 20), (5, 10, 15, 16), (2, 9, 14, 17), (4, 7, 12, 19))


def roving(sweep_s: float) -> Scenario:
    """Hati in five runs of four roving sensors; a short sweep leaves few lines to a peak and a force that drops out."""
    scenario = load_scenario("hati-unsymmetric")
    sweep = {"start_hz": 3.0, "stop_hz": 35.0, "duration_s": sweep_s, "ring_down_s": 3.0}
    changes = {
        "acquisition": scenario.acquisition.model_copy(update={"sample_rate_hz": 250.0, "runs": RUNS}),
        "excitation": scenario.excitation.model_copy(update=sweep),
    }
    return scenario.model_copy(update=changes)


SCENARIOS = {
    "Hati, 14 s": lambda: roving(14.0),
    "Hati, 60 s": lambda: roving(60.0),
    "beam": lambda: load_scenario("teaching-beam"),
}


@cache
def without_noise(name: str) -> Campaign:
    """The campaign of a scenario with ideal instruments."""
    return simulated(SCENARIOS[name]())


def simulated(scenario: Scenario) -> Campaign:
    """A campaign with ideal instruments."""
    silent = {"noise": None}
    changes = {
        "accelerometers": scenario.accelerometers.model_copy(update=silent),
        "transducer": scenario.transducer.model_copy(update=silent),
        "acquisition": scenario.acquisition.model_copy(update={"noise_v_per_rthz": 0.0, "bits": 32}),
    }
    return simulated_campaign(scenario.model_copy(update=changes), engine="linear")


def by_band(values: np.ndarray) -> np.ndarray:
    """Means of (C, L) over all channels in ten bands of equally many lines, (10,)."""
    return np.array([part.mean() for part in np.array_split(values, BANDS, axis=1)])


def holds(name: str, noise: Noise, draws: int) -> None:
    """The estimate over the true variance: 1 within 10 % over all lines and within 25 % in each of ten bands."""
    campaign = without_noise(name)
    generator = np.random.default_rng(7)
    estimated, squared, at_peaks = [], [], []
    for _ in range(draws):
        measured = measured_frfs(noise.on(campaign, generator), lines=200)
        assert not measured.remarks
        exact, variance = noise.variance(campaign, measured)
        ratio = measured.noise / variance
        estimated.append(by_band(ratio))
        squared.append(float(np.mean(np.abs(measured.values - exact) ** 2 / variance)))
        at_peaks.append(ratio[np.abs(exact) > np.quantile(np.abs(exact), 0.9, axis=1, keepdims=True)].mean())
    # The judge itself: what the draws do to A/F has the variance that theory says.
    assert np.mean(squared) == pytest.approx(1.0, abs=0.07)
    bands = np.mean(estimated, axis=0)
    assert bands.mean() == pytest.approx(1.0, abs=0.1), bands
    assert np.abs(bands - 1).max() < 0.25, bands
    assert np.mean(at_peaks) == pytest.approx(1.0, abs=0.25)


def test_a_short_roving_sweep_is_given_its_own_noise() -> None:
    holds("Hati, 14 s", Noise(0.01, False), 6)


def test_a_run_of_half_the_length_is_given_its_own_noise_and_no_harmonics() -> None:
    """Between the lines of its own record noise is interpolated, and as smooth as an answer of the structure."""
    long, short = without_noise("Hati, 60 s"), simulated(roving(24.0))
    campaign = replace(long, runs=(*long.runs[:3], *short.runs[3:]))
    noise, generator, ratios = Noise(0.01, False), np.random.default_rng(8), []
    for _ in range(4):
        measured = measured_frfs(noise.on(campaign, generator), lines=200)
        _, variance = noise.variance(campaign, measured)
        of_run = np.array([c.run for c in measured.channels])
        ratios.append([(measured.noise / variance)[of_run == r].mean() for r in range(len(RUNS))])
        assert {h.run_number for h in measured.harmonics} == {1, 2, 3, 4, 5}
        assert max(h.between for h in measured.harmonics) < 4
    assert np.mean(ratios, axis=0) == pytest.approx(np.ones(len(RUNS)), abs=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("name", list(SCENARIOS))
@pytest.mark.parametrize("share", [0.003, 0.01, 0.03])
def test_white_noise_is_estimated_as_it_is(name: str, share: float) -> None:
    holds(name, Noise(share, False), 50)


@pytest.mark.slow
@pytest.mark.parametrize("name", list(SCENARIOS))
def test_coloured_noise_is_estimated_as_it_is(name: str) -> None:
    holds(name, Noise(0.01, True), 50)


def test_noise_at_the_end_of_a_record_is_no_ringing_but_a_cut_record_rings() -> None:
    generator = np.random.default_rng(2)
    noisy = Noise(0.1, False).on(without_noise("Hati, 14 s"), generator)
    rested = measured_frfs(noisy, lines=100)
    assert rested.remarks == ()
    assert [end.last.size for end in rested.endings] == [0] * len(RUNS)
    # The last 3 s are silent; a record that ends before them ends in the swing of the last mode.
    cut = replace(noisy, runs=tuple(replace(r, samples=r.samples[:, : -round(3.2 * 250)]) for r in noisy.runs))
    remarks = measured_frfs(cut, lines=100).remarks
    assert len(remarks) == len(RUNS)
    assert all("ringing" in r for r in remarks)


def test_repeats_say_as_much_at_the_ends_of_the_band_as_within() -> None:
    """White noise of unit variance on three runs of the same forty channels."""
    lines, count = np.arange(200), 40
    g = np.random.default_rng(2)
    rows = [
        (MeasuredChannel(run, run + 1, Dof(node, Direction.PLUS_Z), node), count * run + node)
        for run in range(3)
        for node in range(count)
    ]
    noise = (g.standard_normal((3 * count, 200)) + 1j * g.standard_normal((3 * count, 200))) / np.sqrt(2)
    found = repeat_noise(3.0 + noise, np.ones((3, 200), complex), rows, lines)
    assert found is not None
    for part in (found[:, :3], found[:, 90:110], found[:, -3:]):
        assert part.mean() == pytest.approx(1.0, rel=0.1)
