"""Laws of frequency response estimation, against analytic responses and stated biases."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from vgvt.data import Dof, Quantity
from vgvt.signals import estimate_frf, linear_chirp
from vgvt.signals.cross import CrossSpectra

RATE_HZ = 200.0
NEAR = (5.0, 20.0)


def sweep(samples: int = 12_000, duration_s: float = 50.0) -> NDArray[np.float64]:
    """A sweep from rest that leaves ten seconds of ring-down."""
    return linear_chirp(np.arange(samples) / RATE_HZ, 1.0, 40.0, duration_s)


def test_ratio_of_a_sweep_that_rings_down_is_the_analytic_response(single_mass, make_campaign) -> None:
    force = sweep()
    campaign = make_campaign([{"F1+Z": force, "1+Z": single_mass.acceleration(force, RATE_HZ)}])
    frf = estimate_frf(campaign).band(*NEAR)
    exact = single_mass.held_accelerance(frf.frequency_hz, RATE_HZ)
    # 44 s after the sweep has passed 10 Hz at 2 % damping what still rings is exp(-55): only round-off is left.
    np.testing.assert_allclose(frf.values[0, 0], exact, rtol=1e-6)
    # A force that is straight between samples weighs the continuous response with sinc^2; what is missing
    # comes back aliased from far above the resonance, where the response is 1/m.
    continuous = single_mass.accelerance(frf.frequency_hz)
    missing = 1 - np.sinc(frf.frequency_hz / RATE_HZ) ** 2
    expected = continuous + missing * (1 / single_mass.mass_kg - continuous)
    np.testing.assert_allclose(frf.values[0, 0], expected, rtol=1e-4)


def test_cutting_the_ring_down_costs_no_more_than_the_energy_cut_off(single_mass, make_campaign) -> None:
    force = sweep(12_000, 60.0)
    response = single_mass.acceleration(force, RATE_HZ)
    # Leakage is the spectrum of the tail that the record no longer holds.
    longer = np.concatenate([force, np.zeros(24_000)])
    tail = single_mass.acceleration(longer, RATE_HZ)[12_000:]
    frf = estimate_frf(make_campaign([{"F1+Z": force, "1+Z": response}])).band(*NEAR)
    lines = np.round(frf.frequency_hz * 60.0).astype(int)
    bound = np.abs(tail).sum() / np.abs(np.fft.rfft(force - force.mean())[lines])
    error = np.abs(frf.values[0, 0] - single_mass.held_accelerance(frf.frequency_hz, RATE_HZ))
    assert np.all(error <= bound * 1.001 + 1e-4)


def test_h1_is_unbiased_by_noise_on_the_response(single_mass, make_campaign) -> None:
    generator = np.random.default_rng(1)
    runs = []
    for _ in range(200):
        force = sweep(6000, 25.0)
        response = single_mass.acceleration(force, RATE_HZ)
        runs.append({"F1+Z": force, "1+Z": response + generator.standard_normal(6000) * 0.3})
    frf = estimate_frf(make_campaign(runs), "h1").band(*NEAR)
    assert frf.variance is not None
    exact = single_mass.held_accelerance(frf.frequency_hz, RATE_HZ)
    scaled = np.abs(frf.values[0, 0] - exact) ** 2 / frf.variance[0, 0]
    # |error|^2 / variance is exponential with mean 1: unbiased, and the stated variance is right.
    assert scaled.mean() == pytest.approx(1.0, abs=4 / np.sqrt(scaled.size))


@pytest.mark.parametrize("ratio", [0.1, 0.5])
def test_noise_on_the_force_lowers_h1_and_spares_h2(single_mass, make_campaign, ratio: float) -> None:
    generator = np.random.default_rng(2)
    force = generator.standard_normal(400_000)
    response = single_mass.acceleration(force, RATE_HZ)
    noisy = force + np.sqrt(ratio) * generator.standard_normal(force.size)
    campaign = make_campaign([{"F1+Z": noisy, "1+Z": response}])
    exact = {}
    for estimator in ("h1", "h2", "hv"):
        frf = estimate_frf(campaign, estimator, segment_s=20.0).band(8.0, 40.0)
        exact[estimator] = np.abs(frf.values[0, 0] / single_mass.held_accelerance(frf.frequency_hz, RATE_HZ)).mean()
    assert exact["h1"] == pytest.approx(1 / (1 + ratio), rel=0.015)
    assert exact["h2"] == pytest.approx(1.0, rel=0.015)
    assert exact["hv"] == pytest.approx(np.sqrt(1 / (1 + ratio)), rel=0.015)


def test_coherence_says_how_much_of_the_response_the_force_explains(make_campaign) -> None:
    generator = np.random.default_rng(3)
    force = generator.standard_normal(400_000)
    response = 3.0 * force + 3.0 * np.sqrt(0.25) * generator.standard_normal(force.size)
    frf = estimate_frf(make_campaign([{"F1+Z": force, "1+Z": response}]), "h1", segment_s=5.0)
    assert frf.coherence is not None
    assert frf.coherence.mean() == pytest.approx(1 / 1.25, abs=0.01)
    assert frf.coherence.max() <= 1.0
    assert frf.variance is not None
    inside = slice(5, -5)
    scatter = (np.abs(frf.values[0, 0, inside] - 3.0) ** 2).mean()
    assert frf.variance[0, 0, inside].mean() == pytest.approx(scatter, rel=0.15)


def test_estimates_scale_with_response_and_inversely_with_force(single_mass, make_campaign) -> None:
    force = sweep()
    response = single_mass.acceleration(force, RATE_HZ)
    for estimator in ("ratio", "local_polynomial"):
        plain = estimate_frf(make_campaign([{"F1+Z": force, "1+Z": response}]), estimator, band_hz=NEAR)
        scaled = estimate_frf(make_campaign([{"F1+Z": 4.0 * force, "1+Z": 2.0 * response}]), estimator, band_hz=NEAR)
        np.testing.assert_allclose(scaled.values, plain.values / 2, rtol=1e-9)


@pytest.mark.parametrize("estimator", ["h1", "h2", "hv"])
def test_exchanging_force_and_response_exchanges_h1_and_h2(single_mass, make_campaign, estimator: str) -> None:
    generator = np.random.default_rng(4)
    force = generator.standard_normal(40_000)
    response = single_mass.acceleration(force, RATE_HZ) + 0.2 * generator.standard_normal(force.size)
    force += 0.2 * generator.standard_normal(force.size)
    there = estimate_frf(make_campaign([{"F1+Z": force, "1+Z": response}]), estimator, segment_s=5.0)
    partner = {"h1": "h2", "h2": "h1", "hv": "hv"}[estimator]
    back = estimate_frf(make_campaign([{"F1+Z": response, "1+Z": force}]), partner, segment_s=5.0)
    np.testing.assert_allclose(there.values * back.values, 1.0, rtol=1e-9)


@pytest.mark.parametrize(("response", "force"), [("12-Z", "F1+Z"), ("12+Z", "F1-Z"), ("12-Z", "F1-Z")])
def test_a_direction_the_other_way_changes_the_sign(single_mass, make_campaign, response: str, force: str) -> None:
    drive = sweep()
    moved = single_mass.acceleration(drive, RATE_HZ)
    plain = estimate_frf(make_campaign([{"F1+Z": drive, "12+Z": moved}]), band_hz=NEAR)
    # Sensors the other way round record the opposite of the same motion.
    sign = {"+": 1.0, "-": -1.0}
    signs = (sign[response[-2]], sign[force[-2]])
    turned = estimate_frf(make_campaign([{force: signs[1] * drive, response: signs[0] * moved}]), band_hz=NEAR)
    assert turned.responses == (Dof.from_label(response),)
    np.testing.assert_allclose(turned.values, signs[0] * signs[1] * plain.values)


def test_a_repeat_with_the_sensor_turned_is_the_same_response(single_mass, make_campaign) -> None:
    drive = sweep()
    moved = single_mass.acceleration(drive, RATE_HZ)
    frf = estimate_frf(make_campaign([{"F1+Z": drive, "12+Z": moved}, {"F1-Z": -drive, "12-Z": -moved}]), band_hz=NEAR)
    assert frf.responses == (Dof.from_label("12+Z"),)
    assert frf.references == (Dof.from_label("1+Z"),)
    np.testing.assert_allclose(frf.values[0, 0], single_mass.held_accelerance(frf.frequency_hz, RATE_HZ), rtol=1e-6)


def test_roving_runs_come_back_as_one_set_in_order_of_measurement(single_mass, make_campaign) -> None:
    runs = []
    for k in range(3):
        drive = sweep() * (1 + k)
        moved = single_mass.acceleration(drive, RATE_HZ)
        runs.append({"F9+Z": drive, f"{2 * k + 1}+Z": moved * (k + 1), f"{2 * k + 2}+Z": -moved})
    frf = estimate_frf(make_campaign(runs), band_hz=NEAR)
    assert [str(d) for d in frf.responses] == ["1+Z", "2+Z", "3+Z", "4+Z", "5+Z", "6+Z"]
    assert frf.runs == (1, 1, 2, 2, 3, 3)
    exact = single_mass.held_accelerance(frf.frequency_hz, RATE_HZ)
    for row, factor in zip(frf.values[:, 0], (1, -1, 2, -1, 3, -1), strict=True):
        np.testing.assert_allclose(row, factor * exact, rtol=1e-6)


def test_two_shakers_at_once_are_told_apart(single_mass, make_campaign) -> None:
    generator = np.random.default_rng(6)
    forces = generator.standard_normal((2, 200_000))
    forces[1] += 0.5 * forces[0]
    moved = [single_mass.acceleration(f, RATE_HZ) for f in forces]
    campaign = make_campaign(
        [{"F8+Z": forces[0], "F9+Z": forces[1], "1+Z": moved[0] - 2 * moved[1], "2+Z": 3 * moved[0]}]
    )
    frf = estimate_frf(campaign, "h1", segment_s=20.0).band(8.0, 40.0)
    exact = single_mass.held_accelerance(frf.frequency_hz, RATE_HZ)
    mean = (frf.values / exact).mean(axis=2)
    np.testing.assert_allclose(mean, [[1, -2], [3, 0]], atol=0.03)
    assert frf.coherence is not None
    assert frf.coherence.mean() > 0.98


def test_two_shakers_one_after_the_other_make_two_columns(single_mass, make_campaign) -> None:
    drive = sweep()
    moved = single_mass.acceleration(drive, RATE_HZ)
    frf = estimate_frf(make_campaign([{"F8+Z": drive, "1+Z": moved}, {"F9+Z": drive, "1+Z": 5 * moved}]), band_hz=NEAR)
    assert [str(d) for d in frf.references] == ["8+Z", "9+Z"]
    np.testing.assert_allclose(frf.values[0, 1], 5 * frf.values[0, 0], rtol=1e-9)


def test_a_displacement_among_accelerations_is_differentiated(single_mass, make_campaign) -> None:
    drive = sweep()
    moved = single_mass.acceleration(drive, RATE_HZ)
    omega = 2 * np.pi * np.fft.rfftfreq(drive.size, 1 / RATE_HZ)
    spectrum = np.fft.rfft(moved - moved.mean())
    displacement = np.fft.irfft(np.divide(spectrum, -(omega**2), out=0 * spectrum, where=omega > 0), drive.size)
    campaign = make_campaign([{"F1+Z": drive, "1+Z": moved, "2+Z": displacement}])
    record = campaign.runs[0]
    channels = (*record.channels[:2], replace(record.channels[2], quantity=Quantity.DISPLACEMENT, unit="m"))
    frf = estimate_frf(replace(campaign, runs=(replace(record, channels=channels),)), band_hz=NEAR)
    assert frf.quantity is Quantity.ACCELERATION
    assert "differentiated" in frf.remarks[0]
    np.testing.assert_allclose(frf.values[1], frf.values[0], rtol=1e-6)


def test_mean_values_do_not_matter(single_mass, make_campaign) -> None:
    drive = sweep()
    moved = single_mass.acceleration(drive, RATE_HZ)
    plain = estimate_frf(make_campaign([{"F1+Z": drive, "1+Z": moved}]))
    shifted = estimate_frf(make_campaign([{"F1+Z": drive + 3.0, "1+Z": moved - 7.0}]))
    assert plain.frequency_hz[0] > 0
    np.testing.assert_allclose(shifted.values, plain.values, rtol=1e-6, atol=1e-9)


def test_two_forces_that_leave_a_line_empty_know_nothing_of_it() -> None:
    """NaN as for one force, not a response of zero; the line beside it is solved as ever."""
    empty, full = np.zeros((2, 2)), np.diag([2.0, 4.0])
    spectra = CrossSpectra(
        1, 4.0, np.stack([empty, full], axis=2).astype(complex), np.ones((2, 2), complex), np.ones(2)
    )
    assert np.isnan(spectra.h1()[:, 0]).all()
    np.testing.assert_allclose(spectra.h1()[:, 1], [0.5, 0.25])
