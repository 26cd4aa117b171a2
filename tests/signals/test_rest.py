"""Records that do not start or do not end at rest: what ``auto`` makes of them, and what it says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from vgvt.data import Campaign, FrequencyResponseSet, Quantity
from vgvt.signals import estimate_frf, linear_chirp
from vgvt.signals.rest import end_at_rest, pass_once, start_at_rest
from vgvt.signals.usable import usable_runs

RATE = 200.0
BAND = (6.0, 16.0)
SAMPLES, SILENCE, LATE = 8000, 3000, 1800


def chirp(start_hz: float, stop_hz: float) -> NDArray[np.float64]:
    return linear_chirp(np.arange(SAMPLES) / RATE, start_hz, stop_hz, SAMPLES / RATE)


def noise(seed: int = 1) -> NDArray[np.float64]:
    force = np.random.default_rng(seed).standard_normal(SAMPLES)
    return force * (np.arange(SAMPLES) > 0)


def part(single_mass, force: NDArray[np.float64], begin: int = 0, silence: int = SILENCE) -> dict[str, NDArray]:
    """What is recorded from sample ``begin`` on, under a little noise."""
    force = np.concatenate([force, np.zeros(silence)])
    moved = single_mass.acceleration(force, RATE)
    moved = moved + 1e-3 * moved.std() * np.random.default_rng(9).standard_normal(moved.size)
    return {"F9+Z": force[begin:], "1+Z": moved[begin:]}


def error(single_mass, frf: FrequencyResponseSet) -> float:
    exact = single_mass.held_accelerance(frf.frequency_hz, RATE)
    return float(np.sqrt((np.abs(frf.values - exact) ** 2).mean() / (np.abs(exact) ** 2).mean()))


def chosen(campaign: Campaign) -> tuple[FrequencyResponseSet, FrequencyResponseSet]:
    """By ``auto`` and by division."""
    return estimate_frf(campaign, "auto", band_hz=BAND), estimate_frf(campaign, "ratio", band_hz=BAND)


@pytest.mark.parametrize("force", [chirp(2.0, 30.0), chirp(30.0, 2.0), noise()], ids=["up", "down", "noise"])
def test_records_that_start_and_end_at_rest_are_divided(make_campaign, single_mass, force) -> None:
    frf, divided = chosen(make_campaign([part(single_mass, force)], band_hz=BAND))
    np.testing.assert_array_equal(frf.values, divided.values)
    assert frf.remarks == ()
    assert error(single_mass, frf) < 0.01


@pytest.mark.parametrize(
    ("force", "begin", "silence", "said"),
    [(noise(), 0, 0, "end"), (noise(), LATE, 0, "begin"), (noise(), LATE, SILENCE, "begin")],
)
def test_noise_that_begins_or_ends_the_record_is_fitted_with_its_leakage(
    make_campaign, single_mass, force, begin: int, silence: int, said: str
) -> None:
    frf, divided = chosen(make_campaign([part(single_mass, force, begin, silence)], band_hz=BAND))
    assert error(single_mass, divided) > 0.05
    assert error(single_mass, frf) < 0.01
    assert frf.remarks[0].startswith(f"records {said} while it rings")
    assert "local fits" in frf.remarks[1] and frf.variance is not None


@pytest.mark.parametrize("begin", [1500, 1640, 1800, 2200, 2500])
def test_a_sweep_begun_late_is_fitted_with_its_leakage(make_campaign, single_mass, begin: int) -> None:
    """It passes the resonance at 10 Hz after 11.4 s, and rings there for a while; no note says so."""
    record = part(single_mass, chirp(2.0, 30.0), begin)
    frf, divided = (estimate_frf(make_campaign([record], band_hz=BAND), e) for e in ("auto", "ratio"))
    assert "begin while it rings" in frf.remarks[0]
    passed_hz = 2.0 + 28.0 * begin / SAMPLES
    band = (passed_hz + 1.0, 25.0)
    assert error(single_mass, frf.band(*band)) < 0.01 < error(single_mass, divided.band(*band))


def test_a_note_of_a_late_beginning_is_believed(make_campaign, single_mass) -> None:
    """The force and the response may both pass zero just then."""
    campaign = make_campaign([part(single_mass, chirp(2.0, 30.0))], band_hz=BAND)
    runs, _ = usable_runs(campaign)
    assert start_at_rest(campaign, runs)
    assert not start_at_rest(replace(campaign, notes={"unrecorded_s": "4"}), runs)
    assert start_at_rest(replace(campaign, notes={"unrecorded_s": "nothing"}), runs)


def test_a_sweep_cut_off_at_its_end_is_divided_and_what_that_does_is_told(make_campaign, single_mass) -> None:
    frf, divided = chosen(make_campaign([part(single_mass, chirp(2.0, 16.0), silence=0)], band_hz=BAND))
    np.testing.assert_array_equal(frf.values, divided.values)
    assert "records end while it rings" in frf.remarks[0]


def test_one_late_run_of_several_is_enough(make_campaign, single_mass) -> None:
    runs = [part(single_mass, noise(1)), part(single_mass, noise(2), LATE)]
    frf = estimate_frf(make_campaign(runs, band_hz=BAND), "auto", band_hz=BAND)
    assert "begin while it rings" in frf.remarks[0]
    assert error(single_mass, frf) < 0.01


def test_records_too_short_for_local_fits_are_divided_with_a_remark(make_campaign, single_mass) -> None:
    record = {label: x[4000:4030] for label, x in part(single_mass, noise()).items()}
    frf = estimate_frf(make_campaign([record], band_hz=BAND), "auto")
    np.testing.assert_array_equal(frf.values, estimate_frf(make_campaign([record], band_hz=BAND), "ratio").values)
    assert "no local fit is possible" in frf.remarks[-1]


def test_noise_as_large_as_the_response_is_no_ringing(make_campaign, single_mass) -> None:
    """Of thirty records from rest and as many begun late."""
    late_found = 0
    for seed in range(30):
        record = part(single_mass, chirp(2.0, 30.0))
        hiss = record["1+Z"].std() * np.random.default_rng(seed).standard_normal(record["1+Z"].size)
        campaign = make_campaign([record | {"1+Z": record["1+Z"] + hiss}], band_hz=BAND)
        assert start_at_rest(campaign, usable_runs(campaign)[0])
        late = {label: x[LATE + 10 * seed :] for label, x in record.items()}
        campaign = make_campaign([late | {"1+Z": late["1+Z"] + hiss[LATE + 10 * seed :]}], band_hz=BAND)
        late_found += not start_at_rest(campaign, usable_runs(campaign)[0])
    assert late_found >= 27


def test_a_sensor_that_hears_little_does_not_make_a_record_ring(make_campaign, single_mass) -> None:
    """Its noise is as large at the first sample as anywhere; in another unit it is asked by itself."""
    record = part(single_mass, chirp(2.0, 30.0))
    weak = 0.05 * record["1+Z"].std() * np.cos(2 * np.pi * 0.3 * np.arange(record["1+Z"].size) / RATE)
    campaign = make_campaign([record | {"2+Z": weak}], band_hz=BAND)
    runs, _ = usable_runs(campaign)
    assert start_at_rest(campaign, runs)
    displaced = make_campaign([{"F9+Z": record["F9+Z"], "2+Z": weak}], band_hz=BAND, quantity=Quantity.DISPLACEMENT)
    assert not start_at_rest(displaced, usable_runs(displaced)[0])


@pytest.mark.parametrize(
    ("force", "once"),
    [(chirp(2.0, 30.0), True), (chirp(30.0, 2.0), True), (noise(), False), (np.tile(noise()[:800], 10), False)],
    ids=["up", "down", "noise", "periods"],
)
def test_what_passes_each_frequency_once(make_campaign, single_mass, force, once: bool) -> None:
    runs, _ = usable_runs(make_campaign([part(single_mass, force)]))
    assert pass_once(runs, (2.0, 30.0)) is once
    assert end_at_rest(runs)


@pytest.mark.parametrize("begin", [1500, 1800, 2200])
def test_sweeps_of_two_forces_begun_late_are_fitted_with_their_leakage(make_campaign, single_mass, begin: int) -> None:
    gains = np.array([[1.0, 0.4], [-0.3, 1.2]])
    runs = []
    for signs in ((1, 1), (1, -1)):
        forces = [sign * np.concatenate([chirp(2.0, 30.0), np.zeros(SILENCE)]) for sign in signs]
        moved = [single_mass.acceleration(f, RATE) for f in gains @ forces]
        runs.append(
            {"F8+Z": forces[0][begin:], "F9+Z": forces[1][begin:], "1+Z": moved[0][begin:], "2+Z": moved[1][begin:]}
        )
    frf = estimate_frf(make_campaign(runs, band_hz=BAND), "auto").band(10.5, 25.0)
    exact = gains[:, :, None] * single_mass.held_accelerance(frf.frequency_hz, RATE)
    assert np.linalg.norm(frf.values - exact) < 0.01 * np.linalg.norm(exact)
    assert any("local fits" in remark for remark in frf.remarks)
