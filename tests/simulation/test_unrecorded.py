"""A record that begins when the shaker has run for a while: the same test, of which the beginning is missing."""

from __future__ import annotations

import numpy as np
import pytest
from effect_rig import having
from small_rig import revised

from vgvt.data import InputError
from vgvt.reconcile.question.suitable import check_excitation, check_suitable
from vgvt.scenario import Scenario
from vgvt.scenario.instruments import NoiseSpectrum
from vgvt.signals import estimate_frf
from vgvt.simulation import simulate, simulated_campaign
from vgvt.simulation.assembly import plans
from vgvt.simulation.command_spectra import command_spectra
from vgvt.simulation.fisher import Lines

LATE_S = 1.0


@pytest.fixture(scope="module", name="whole")
def with_real_instruments(small: Scenario) -> Scenario:
    """AC-coupled, with noise; a sweep from 1 to 37 Hz in 4 s has come to 10 Hz after 1 s."""
    real = {"noise": NoiseSpectrum(frequency_hz=(1.0,), density=(1e-4,)), "high_pass_hz": 0.2}
    return revised(small, accelerometers=real, transducer=real, excitation={"duration_s": 4.0, "ring_down_s": 1.0})


@pytest.fixture(scope="module", name="late")
def begun_late(whole: Scenario) -> Scenario:
    return revised(whole, excitation={"unrecorded_s": LATE_S})


@pytest.mark.parametrize("engine", ["linear", "mujoco"])
def test_it_is_what_a_record_from_the_start_holds_from_then_on(whole: Scenario, late: Scenario, engine: str) -> None:
    """Sample by sample, noise and AC coupling too: the instruments are on before the record begins."""
    before, after = (simulated_campaign(s, engine=engine).runs[0] for s in (whole, late))
    begin = round(LATE_S * before.sample_rate_hz)
    assert after.samples.shape[1] == before.samples.shape[1] - begin
    np.testing.assert_array_equal(after.samples, before.samples[:, begin:])


def test_the_aircraft_rings_at_the_first_sample(small: Scenario) -> None:
    quiet, late = (revised(small, excitation={"duration_s": 4.0, "unrecorded_s": s}) for s in (None, LATE_S))
    first, begun = (simulated_campaign(s, engine="linear").runs[0].samples[1:] for s in (quiet, late))
    whole_rms = np.sqrt((begun**2).mean(axis=1))
    assert (np.abs(first[:, :5]).max(axis=1) < 0.005 * whole_rms).all()
    assert (np.sqrt((begun[:, :50] ** 2).mean(axis=1)) > 0.05 * whole_rms).all()


def test_an_airframe_warms_up_from_the_beginning_of_the_record(small: Scenario) -> None:
    """It softens under its weight, and moves for that, as if the shaker had only now been switched on."""
    sweep = {"duration_s": 3.0, "ring_down_s": 1.0, "amplitude_v": 1e-9}
    warm = having(revised(small, excitation=sweep), "warm-up", softening=0.1, time_constant_s=0.3)
    late = revised(warm, excitation={"unrecorded_s": LATE_S})
    whole, begun = (simulated_campaign(s, engine="mujoco").runs[0].samples[1:] for s in (warm, late))
    assert np.abs(whole).max() > 0.05
    np.testing.assert_allclose(begun, whole[:, : begun.shape[1]], rtol=0, atol=1e-6)


def test_the_campaign_says_what_it_holds_and_the_bound_is_of_that(whole: Scenario, late: Scenario) -> None:
    result, before = simulate(late, engine="linear"), simulate(whole, engine="linear")
    assert result.campaign.band_hz == pytest.approx((10.0, 37.0))
    assert result.campaign.notes["excitation"].endswith("in 4 s, the first 1 s not recorded")
    early, after = before.truth.as_tested[0], result.truth.as_tested[0]
    np.testing.assert_array_equal(early.natural_frequency_hz, after.natural_frequency_hz)
    swept = after.natural_frequency_hz > 10.0
    passed = (early.natural_frequency_hz > 1.0) & ~swept
    known = [truth.natural_frequency_std_hz for truth in (early, after)]
    assert known[0] is not None and known[1] is not None
    assert passed.any() and np.isfinite(known[0][passed]).all()
    assert np.isnan(known[1][passed]).all()
    assert np.isfinite(known[1][swept & np.isfinite(known[0])]).all()


def test_what_was_sent_before_the_record_tells_nothing(whole: Scenario, late: Scenario) -> None:
    """Energy density of the command at 4 Hz, passed before, and at 20 Hz, passed afterwards."""
    lines = Lines(np.array([4.0, 20.0]), np.array([1.0, 1.0]))
    before, after = (np.abs(command_spectra(plans(s)[0], 0, lines)[:, 0, 0]) for s in (whole, late))
    assert after[0] < 0.05 * before[0]
    assert after[1] == pytest.approx(before[1], rel=0.02)


def test_reconcile_says_that_it_predicts_records_from_rest(late: Scenario, whole: Scenario) -> None:
    """Of the scenario, and of a campaign whose scenario does not say it."""
    check_excitation(whole)
    with pytest.raises(InputError, match=r"excitation\.unrecorded_s: is 1: what rings when a record begins"):
        check_excitation(late)
    check_suitable(simulated_campaign(whole, engine="linear"), whole)
    with pytest.raises(InputError, match="was recorded from 1 s after the shaker's start: what rings"):
        check_suitable(simulated_campaign(late, engine="linear"), whole)


def test_a_periodic_record_in_steady_state_holds_whole_periods(small: Scenario) -> None:
    """Of 6 s, without noise, once the slow pendulums have come to rest: the linear model's own accelerances."""
    periodic = {"kind": "multisine", "blocks": 10, "lines": "full", "duration_s": 60.0, "ring_down_s": 0.0}
    scenario = revised(small, excitation={**periodic, "start_hz": 3.0, "taper_s": 0.0, "unrecorded_s": 36.0})
    result = simulate(scenario, engine="linear")
    record, rate = result.campaign.runs[0], scenario.acquisition.sample_rate_hz
    assert record.samples.shape[1] == round(24.0 * rate)
    frf, tested = estimate_frf(result.campaign, "auto", band_hz=(4.0, 35.0)), result.truth.as_tested[0]
    assert any("of the last 4 of 4 whole periods of 6 s" in remark for remark in frf.remarks)
    omega = 2j * np.pi * frf.frequency_hz
    rows = [tested.dofs.index(dof) for dof in frf.responses]
    columns = [tested.references.index(dof) for dof in frf.references]
    exact = np.zeros(frf.values.shape, complex)
    for pole, residues in zip(tested.poles, tested.residues, strict=True):
        part = residues[np.ix_(rows, columns)][..., None]
        exact += omega**2 * (part / (omega - pole) + part.conj() / (omega - pole.conj()))
    assert np.linalg.norm(frf.values - exact) < 1e-3 * np.linalg.norm(exact)


def test_a_record_that_begins_late_says_so_where_responses_are_estimated(late: Scenario, whole: Scenario) -> None:
    late_said, whole_said = (
        estimate_frf(simulated_campaign(s, engine="linear"), "auto").remarks for s in (late, whole)
    )
    assert "begin while it rings" in late_said[0]
    assert not any("begin while it rings" in remark for remark in whole_said)
