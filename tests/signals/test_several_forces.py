"""What is told of several forces that act at once: sweeps, noise, bursts after a silence, runs of other lengths."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError
from vgvt.signals import estimate_frf

RATE = 200.0
BAND = (6.0, 16.0)
GAINS = np.array([[1.0, 0.4], [-0.3, 1.2]])


def record(single_mass, forces: NDArray[np.float64], noise: float = 0.0, seed: int = 9) -> dict[str, NDArray]:
    """Two sensors that follow two forces through one mode each way, in known proportions."""
    moved = np.array([single_mass.acceleration(f, RATE) for f in GAINS @ forces])
    moved += noise * moved.std() * np.random.default_rng(seed).standard_normal(moved.shape)
    return {"F8+Z": forces[0], "F9+Z": forces[1], "1+Z": moved[0], "2+Z": moved[1]}


def exact(single_mass, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
    """(responses, references, lines)."""
    return GAINS[:, :, None] * single_mass.held_accelerance(frequency, RATE)


def error(single_mass, campaign: Campaign, estimator: str = "auto") -> float:
    """Root mean square over that of the responses."""
    frf = estimate_frf(campaign, estimator, band_hz=BAND)
    wanted = exact(single_mass, frf.frequency_hz)
    return float(np.sqrt((np.abs(frf.values - wanted) ** 2).mean() / (np.abs(wanted) ** 2).mean()))


def sweep(duration_s: float, sweep_s: float) -> NDArray[np.float64]:
    """2 to 30 Hz, then silence."""
    time = np.arange(round(duration_s * RATE)) / RATE
    return np.sin(2 * np.pi * (2.0 * time + 14.0 / sweep_s * time**2)) * (time < sweep_s)


def noise(samples: int, seed: int = 1) -> NDArray[np.float64]:
    return np.random.default_rng(seed).standard_normal((2, samples))


@pytest.mark.parametrize("signs", [((1, 1), (1, -1)), ((1, 0.05), (0.05, 1))])
def test_sweeps_of_repeats_are_solved_on_their_whole_records(make_campaign, single_mass, signs) -> None:
    """Orthogonal, and one after the other: every line has had all its force in every run, and none in most segments."""
    runs = [record(single_mass, np.outer(s, sweep(36.0, 30.0)), 1e-3) for s in signs]
    campaign = make_campaign(runs, band_hz=BAND)
    frf = estimate_frf(campaign, "auto")
    assert frf.frequency_hz.size == estimate_frf(campaign, "ratio").frequency_hz.size
    assert error(single_mass, campaign) < 0.01


def test_the_variance_of_sweeps_follows_their_force(make_campaign, single_mass) -> None:
    """Twenty times less force above 11 Hz, four hundred times the variance there; repeats are as many as forces."""
    force = sweep(36.0, 30.0)
    time = np.arange(force.size) / RATE
    force = force * np.where(2.0 + 28.0 / 30.0 * time > 11.0, 0.05, 1.0)
    campaign = make_campaign(
        [record(single_mass, np.outer(s, force), 1e-3, seed) for seed, s in enumerate(((1, 1), (1, -1)))], band_hz=BAND
    )
    frf = estimate_frf(campaign, "auto", band_hz=(3.0, 20.0))
    assert frf.variance is not None
    square = np.abs(frf.values - exact(single_mass, frf.frequency_hz)) ** 2 / frf.variance
    for low, high in ((4.0, 9.0), (13.0, 19.0)):
        inside = (frf.frequency_hz > low) & (frf.frequency_hz < high)
        assert 0.6 < square[:, :, inside].mean() < 1.6


def test_sweeps_that_have_no_time_to_ring_out_are_fitted_with_their_leakage(make_campaign, single_mass) -> None:
    force = sweep(40.0, 60.0)  # cut off above the band, at 20.7 Hz, while it rings
    campaign = make_campaign([record(single_mass, np.outer(s, force), 1e-3) for s in ((1, 1), (1, -1))], band_hz=BAND)
    assert error(single_mass, campaign) < 0.01
    assert fitted_locally(campaign)


def test_repeats_of_noise_that_does_not_end_are_fitted_with_their_leakage(make_campaign, single_mass) -> None:
    """As many records as forces, and each of them leaks: divided whole they are wrong by half of themselves."""
    campaign = make_campaign([record(single_mass, noise(4800, seed), 1e-3) for seed in (1, 2)], band_hz=BAND)
    assert error(single_mass, campaign, "ratio") > 0.3
    assert error(single_mass, campaign) < 0.01
    assert fitted_locally(campaign)


def test_repeats_of_one_and_the_same_forces_are_told_apart_by_their_neighbours(make_campaign, single_mass) -> None:
    """They end at rest, but on a line both records say the same: only other lines tell the forces apart."""
    forces = np.hstack([noise(4000), np.zeros((2, 1200))])
    campaign = make_campaign([record(single_mass, forces, 1e-3, seed) for seed in (1, 2)], band_hz=BAND)
    assert fitted_locally(campaign)
    assert error(single_mass, campaign) < 0.01


def fitted_locally(campaign: Campaign) -> bool:
    return any("local fits over" in remark for remark in estimate_frf(campaign, "auto", band_hz=BAND).remarks)


def test_noise_of_one_record_is_not_blurred(make_campaign, single_mass) -> None:
    """Half-power width 0.4 Hz in 24 s: 0.33 Hz apart are the lines of segments of an eighth, which widen it."""
    campaign = make_campaign([record(single_mass, noise(4800), 1e-3)], band_hz=BAND)
    frf = estimate_frf(campaign, "auto", band_hz=BAND)
    assert error(single_mass, campaign) < 0.01
    assert frf.variance is not None
    square = np.abs(frf.values - exact(single_mass, frf.frequency_hz)) ** 2 / frf.variance
    assert 0.5 < square.mean() < 2.0
    assert fitted_locally(campaign)


def test_runs_of_other_lengths_help_one_another(make_campaign, single_mass) -> None:
    lengths = (4800, 3900)
    runs = [record(single_mass, noise(n, seed=n), 1e-3) for n in lengths]
    assert error(single_mass, make_campaign(runs, band_hz=BAND)) < 0.01
    signs = ((1, 1), (1, -1))
    runs = [record(single_mass, np.outer(s, sweep(d, 24.0)), 1e-3) for s, d in zip(signs, (30.0, 36.5), strict=True)]
    assert error(single_mass, make_campaign(runs, band_hz=BAND)) < 0.01


@pytest.mark.parametrize("lead_in_s", [0.0, 2.0, 4.0])
def test_bursts_begin_after_the_lead_in(make_campaign, single_mass, lead_in_s) -> None:
    """Bursts of 8 s that die away in theirs; cut half a block too early each would begin with another's ringing."""
    block = round(8.0 * RATE)
    forces = (noise(6 * block).reshape(2, 6, block) * (np.arange(block) < 0.5 * block)).reshape(2, -1)
    forces = np.hstack([np.zeros((2, round(lead_in_s * RATE))), forces, np.zeros((2, 1))])
    campaign = make_campaign([record(single_mass, forces)], band_hz=BAND)
    noted = replace(campaign, notes={"blocks": json.dumps({"block_s": 8.0, "lead_in_s": lead_in_s})})
    assert error(single_mass, noted) < 0.01


@pytest.mark.parametrize(
    "note", ["[]", "{}", "bursts", '{"block_s": 0}', '{"block_s": 8.0, "lead_in_s": -1}', '{"block_s": "long"}']
)
def test_a_note_of_bursts_that_cannot_be_read_is_refused(make_campaign, single_mass, note) -> None:
    campaign = replace(make_campaign([record(single_mass, noise(4800))]), notes={"blocks": note})
    with pytest.raises(InputError, match="cannot be read"):
        estimate_frf(campaign, "auto")


def test_a_lead_in_that_leaves_no_burst_is_refused(make_campaign, single_mass) -> None:
    notes = {"blocks": '{"block_s": 8.0, "lead_in_s": 20.0}'}
    with pytest.raises(InputError, match="after a lead-in of 20 s"):
        estimate_frf(replace(make_campaign([record(single_mass, noise(4800))]), notes=notes), "auto")


def test_forces_that_fill_few_lines_are_averaged_and_what_that_does_is_told(make_campaign, single_mass) -> None:
    """Eight periods of a multisine: seven lines of eight hold no force, too few for fits of their neighbours."""
    period = noise(600)
    campaign = make_campaign([record(single_mass, np.tile(period, 8), 1e-3)], band_hz=BAND)
    frf = estimate_frf(campaign, "auto", band_hz=BAND)
    assert any("damping is too high" in remark for remark in frf.remarks)
    with pytest.raises(InputError, match="fill"):
        estimate_frf(campaign, "local_rational", band_hz=BAND)


def test_copies_are_refused_whatever_the_estimator(make_campaign, single_mass) -> None:
    force = noise(4800)[0]
    campaign = make_campaign([record(single_mass, np.array([force, 2 * force]))], band_hz=BAND)
    for estimator in ("auto", "local_rational"):
        with pytest.raises(InputError, match="copies of one another"):
            estimate_frf(campaign, estimator)
