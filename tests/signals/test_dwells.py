"""The stepped-sine estimator: exact once settled, biased by the law of settling before, and sure of its scatter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from vgvt.data import Campaign, InputError, Record
from vgvt.signals import DwellSchedule, dwell_schedule, estimate_frf, stepped_sine

Array = NDArray[np.float64]
RATE = 1000.0


def command(schedule: DwellSchedule) -> Array:
    length = schedule.points * schedule.dwell_s
    time = np.arange(round((schedule.lead_in_s + length) * RATE) + 1) / RATE
    return stepped_sine(time - schedule.lead_in_s, schedule.start_hz, schedule.stop_hz, length, schedule.points)


@pytest.fixture
def measured(single_mass, make_campaign) -> Campaign:
    """Nine dwells across the resonance, long enough to settle to 1e-9 in all."""
    schedule = DwellSchedule(8.0, 12.0, 9, 21.0, 17.0, 0.25)
    force = command(schedule)
    campaign = make_campaign([{"F1+Z": force, "2+Z": single_mass.acceleration(force, RATE)}], RATE)
    return replace(campaign, notes={"dwells": schedule.note()})


def test_a_settled_dwell_reads_the_frequency_response(single_mass, measured: Campaign) -> None:
    frf = estimate_frf(measured, "stepped_sine")
    np.testing.assert_allclose(frf.frequency_hz, np.linspace(8.0, 12.0, 9))
    wanted = single_mass.held_accelerance(frf.frequency_hz, RATE)
    assert np.abs(frf.values[0, 0] / wanted - 1).max() < 1e-7
    assert frf.coherence is None


def test_the_notes_choose_the_estimator(measured: Campaign) -> None:
    assert dwell_schedule(measured) == DwellSchedule(8.0, 12.0, 9, 21.0, 17.0, 0.25)
    np.testing.assert_array_equal(estimate_frf(measured, "auto").values, estimate_frf(measured, "stepped_sine").values)
    plain = replace(measured, notes={})
    np.testing.assert_array_equal(estimate_frf(plain, "auto").values, estimate_frf(plain).values)


def test_a_downward_sweep_and_a_band_come_out_in_rising_order(single_mass, make_campaign) -> None:
    schedule = DwellSchedule(12.0, 8.0, 9, 21.0, 17.0)
    force = command(schedule)
    campaign = make_campaign([{"F1+Z": force, "2+Z": single_mass.acceleration(force, RATE)}], RATE)
    frf = estimate_frf(campaign, "stepped_sine", dwells=schedule, band_hz=(9.0, 11.0))
    np.testing.assert_allclose(frf.frequency_hz, np.linspace(9.0, 11.0, 5))
    assert np.abs(frf.values[0, 0] / single_mass.held_accelerance(frf.frequency_hz, RATE) - 1).max() < 1e-7


def test_the_bias_of_settling_falls_as_the_mode_decays(single_mass, make_campaign) -> None:
    """One step from rest to 9.02 Hz: |error| goes as exp(-ζω t), halved every ln 2/(ζω) = 0.55 s."""
    decay = single_mass.damping_ratio * 2 * np.pi * single_mass.natural_frequency_hz
    errors, waits = [], np.array([0.5, 1.0, 2.0, 3.0, 4.0])
    for wait in waits:
        # As many cycles to integrate over each time: the wait alone differs.
        schedule = DwellSchedule(9.0173, 29.9871, 2, wait + 1.0, wait)
        force = command(schedule)
        campaign = make_campaign([{"F1+Z": force, "2+Z": single_mass.acceleration(force, RATE)}], RATE)
        got = estimate_frf(campaign, "stepped_sine", dwells=schedule).values[0, 0, 0]
        errors.append(abs(got / single_mass.held_accelerance(np.array([9.0173]), RATE)[0] - 1))
    slope = np.polyfit(waits, np.log(errors), 1)[0]
    # The conjugate pole turns against the transient and wiggles it by 1/38 at most, the ratio of their beats.
    assert slope == pytest.approx(-decay, rel=0.02)
    assert errors[0] > 0.01


def test_stated_variance_covers_the_scatter(single_mass, make_campaign) -> None:
    """Fifty noisy repeats: the mean stated variance is the variance that is seen, at lines of one block too."""
    schedule = DwellSchedule(1.2, 12.0, 10, 14.2, 13.0)
    assert schedule.cycles[0] == 1
    force = command(schedule)
    clean = single_mass.acceleration(force, RATE)
    runs = [clean + 0.02 * np.random.default_rng(seed).standard_normal(clean.size) for seed in range(50)]
    estimates = [
        estimate_frf(make_campaign([{"F1+Z": force, "2+Z": noisy}], RATE), "stepped_sine", dwells=schedule)
        for noisy in runs
    ]
    seen = np.array([frf.values[0, 0] for frf in estimates]).var(axis=0, ddof=1)
    told = np.mean([frf.variance[0, 0] for frf in estimates], axis=0)
    # 50 repeats know the variance of a complex number to 14 %, the mean of ten lines to 5 %.
    np.testing.assert_allclose(told / seen, 1.0, atol=0.6)
    assert np.mean(told / seen) == pytest.approx(1.0, abs=0.15)


def test_repeats_and_two_forces_work_too(single_mass, make_campaign) -> None:
    """One shaker at a time, in two runs: each response has both columns."""
    schedule = DwellSchedule(8.0, 12.0, 5, 21.0, 17.0)
    force, still = command(schedule), 1e-6 * command(schedule)
    answer = single_mass.acceleration(force, RATE)
    runs = [{"F1+Z": force, "F2+Z": still, "3+Z": answer}, {"F1+Z": still, "F2+Z": force, "3+Z": 2 * answer}]
    frf = estimate_frf(make_campaign(runs, RATE), "stepped_sine", dwells=schedule)
    wanted = single_mass.held_accelerance(frf.frequency_hz, RATE)
    assert np.abs(frf.values[0, 0] / wanted - 1).max() < 1e-5
    assert np.abs(frf.values[0, 1] / (2 * wanted) - 1).max() < 1e-5


def test_what_cannot_be_read_is_refused(measured: Campaign) -> None:
    with pytest.raises(InputError, match="notes have no 'dwells'"):
        estimate_frf(replace(measured, notes={}), "stepped_sine")
    with pytest.raises(InputError, match="note 'dwells'"):
        estimate_frf(replace(measured, notes={"dwells": '{"points": 3}'}), "auto")
    with pytest.raises(InputError, match="last longer"):
        estimate_frf(measured, "stepped_sine", dwells=DwellSchedule(8.0, 12.0, 40, 21.0, 17.0))
    with pytest.raises(InputError, match="less than a cycle"):
        estimate_frf(measured, "stepped_sine", dwells=DwellSchedule(8.0, 12.0, 9, 21.0, 20.95))
    slow = replace(measured, runs=(Record(1, 20.0, measured.runs[0].channels, measured.runs[0].samples),))
    with pytest.raises(InputError, match="too few samples"):
        estimate_frf(slow, "stepped_sine")
