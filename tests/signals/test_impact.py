"""Hammer hits and how they are read: triggered segments, force and exponential windows, the damping that these add."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import cont2discrete, lfilter

from vgvt.data import Dof, InputError, ModalModel, PoleCandidate, Quantity
from vgvt.signals import ImpactWindows, estimate_frf, impact_train, impact_windows, without_window_damping

Array = NDArray[np.float64]
RATE, CONTACT, BLOCK = 1000.0, 0.008, 8.0
TIME = np.arange(int(3 * BLOCK * RATE)) / RATE
WINDOWS = ImpactWindows(segment_s=7.0, pre_trigger_s=0.02, force_s=0.05)


def hits(seed: int = 1, **settings: float) -> Array:
    generator = np.random.default_rng(seed)
    return impact_train(TIME, generator, 3, BLOCK, 0.2, CONTACT, 0.2, 0.05, **settings)


def held(mass, frequency_hz: Array, shift: float = 0.0) -> NDArray[np.complex128]:
    """The sampled mass's accelerance along s = shift + iω."""
    b, a, _ = cont2discrete(mass._coefficients, 1 / RATE, method="foh")
    z = np.exp((shift + 2j * np.pi * frequency_hz) / RATE)
    return np.asarray(np.polyval(np.ravel(b), z) / np.polyval(a, z))


def test_hits_are_short_scattered_and_come_back_with_their_seed() -> None:
    force = hits()
    np.testing.assert_array_equal(force, hits())
    fine = np.arange(TIME.size * 4) / (4 * RATE)
    np.testing.assert_allclose(
        impact_train(fine, np.random.default_rng(1), 3, BLOCK, 0.2, CONTACT, 0.2, 0.05)[::4], force
    )
    peaks = force.reshape(3, -1).max(axis=1)
    assert np.ptp(peaks) > 0.01
    # The impulse of a squared sine is half of peak times time; sampled, the peak is up to 0.24 % short.
    for block in fine.reshape(3, -1):
        push = impact_train(block, np.random.default_rng(1), 3, BLOCK, 0.2, CONTACT, 0.2, 0.05)
        assert np.count_nonzero(push) / (4 * RATE) == pytest.approx(CONTACT, rel=0.05)
        assert push.sum() / (4 * RATE) == pytest.approx(0.5 * push.max() * CONTACT, rel=4e-3)


def test_hits_that_die_out_give_the_frequency_response(single_mass, make_campaign) -> None:
    """ζω = 4 a second here: after the segment exp(-27) is left."""
    mass = replace(single_mass, damping_ratio=0.064)
    force = hits()
    campaign = make_campaign([{"F1-Z": force, "2+Z": mass.acceleration(force, RATE)}], RATE)
    frf = estimate_frf(campaign, "impact", impacts=WINDOWS, band_hz=(3.0, 60.0))
    assert np.abs(frf.values[0, 0] / held(mass, frf.frequency_hz) - 1).max() < 1e-6
    assert frf.coherence is not None
    assert frf.coherence.min() > 1 - 1e-9
    assert frf.remarks == ()


@pytest.mark.parametrize("offset", [0.0, 0.01])
def test_the_exponential_window_moves_the_poles_and_nothing_else(single_mass, make_campaign, offset: float) -> None:
    """The structure at rest before the hit: exactly the response along s = 1/τ + iω, offsets of both or not.

    The hit begins before it triggers; the response rings out within the record, so that its mean is its offset.
    """
    mass, force = (
        single_mass,
        np.concatenate([np.zeros(100), hits()[: int(BLOCK * RATE)], np.zeros(int(2 * BLOCK * RATE))]),
    )
    windows = replace(WINDOWS, decay_s=0.25)
    response = mass.acceleration(force, RATE)
    channels = {"F1+Z": force + offset * force.max(), "2+Z": response + offset * response.max()}
    campaign = make_campaign([channels], RATE)
    frf = estimate_frf(campaign, "impact", impacts=windows, band_hz=(3.0, 60.0))
    wanted = held(mass, frf.frequency_hz, windows.added_decay_rad_per_s)
    # Through a segment of 28 time constants exp(-28 - 9) is left.
    assert np.abs(frf.values[0, 0] / wanted - 1).max() < 1e-6
    assert "adds 4 rad/s" in " ".join(frf.remarks)


def test_the_added_damping_can_be_taken_back() -> None:
    true = ModalModel(np.array([5.0, 10.0]), np.array([0.01, 0.02]), np.ones((2, 1), complex), (Dof.from_label("1+Z"),))
    added = 0.8
    poles = true.poles - added
    seen = replace(true, natural_frequency_hz=np.abs(poles) / (2 * np.pi), damping_ratio=-poles.real / np.abs(poles))
    again = without_window_damping(seen, added)
    np.testing.assert_allclose(again.natural_frequency_hz, true.natural_frequency_hz, rtol=1e-12)
    np.testing.assert_allclose(again.damping_ratio, true.damping_ratio, rtol=1e-9)
    assert (without_window_damping(true, 100.0).damping_ratio == 0).all()


def test_close_modes_that_change_their_order_keep_their_own() -> None:
    """The more damped one falls behind as the window's damping goes; everything of it goes along."""
    seen = ModalModel(
        np.array([8.0, 8.0005]), np.array([0.02, 0.03]), np.array([[1.0, 0.5], [-0.2, 1.0]], complex),
        (Dof.from_label("1+Z"), Dof.from_label("2+Z")), modal_mass_kg=np.array([1.0, 9.0]), flags=(("a",), ("b",)),
        candidates=(PoleCandidate(8.0, 0.02, 4, True, "kept"),),
    )  # fmt: skip
    again = without_window_damping(seen, 0.9)
    true = seen.poles + 0.9
    np.testing.assert_allclose(again.poles, true[::-1], rtol=1e-12)
    np.testing.assert_array_equal(again.shapes, seen.shapes[::-1])
    assert again.flags == (("b",), ("a",)) and again.modal_mass_kg is not None and again.modal_mass_kg[0] > 5
    assert again.candidates[0].frequency_hz == pytest.approx(abs(true[0]) / (2 * np.pi), rel=1e-12)
    assert again.candidates[0].damping_ratio == pytest.approx(-true[0].real / abs(true[0]), rel=1e-12)


@pytest.mark.parametrize("measured", [Quantity.ACCELERATION, Quantity.VELOCITY, Quantity.DISPLACEMENT])
def test_residues_read_through_the_window_are_taken_back(measured: Quantity) -> None:
    """What a window leaves, s + 1/τ in place of s, is known in closed form; its residue is read off beside the pole.

    Methods multiply a velocity or a displacement by s as it is, which the window does not know of.
    """
    dofs, added, mass = (Dof.from_label("1+Z"), Dof.from_label("2+Z")), 2.0, 1.5
    poles = 2 * np.pi * 6.3 * np.array([-0.02 + 1j * np.sqrt(1 - 0.02**2)])
    shape = np.array([1.0, -0.6])
    exact = shape[:, None] * shape[:1] / (2j * poles.imag * mass)

    def read(s: complex) -> NDArray[np.complex128]:
        at = s + added
        receptance = exact / (at - poles) + exact.conj() / (at - poles.conj())
        own = {Quantity.ACCELERATION: 2, Quantity.VELOCITY: 1, Quantity.DISPLACEMENT: 0}[measured]
        return np.asarray(at**own * s ** (2 - own) * receptance)

    pole, step = poles[0] - added, 1e-6
    found = (step * read(pole + step) - step * read(pole - step)) / 2 / pole**2
    seen_mass = float((1 / (2j * pole.imag * found[0, 0])).real)
    seen = ModalModel(
        np.array([abs(pole) / (2 * np.pi)]), np.array([-pole.real / abs(pole)]), shape[None].astype(complex), dofs,
        references=dofs[:1], residues=found[None], modal_mass_kg=np.array([seen_mass]),
    )  # fmt: skip
    again = without_window_damping(seen, added, measured)
    assert again.residues is not None and again.modal_mass_kg is not None
    np.testing.assert_allclose(again.residues[0], exact, rtol=1e-6)
    np.testing.assert_allclose(again.modal_mass_kg, mass, rtol=1e-6)


def test_deviations_stay_those_of_the_pole() -> None:
    """Poles scattered along and across the one that was seen, with the window taken off each; by moments."""
    frequency, ratio, std_hz, ratio_std, added = 6.0, 0.3, 0.02, 0.001, 8.0
    generator = np.random.default_rng(3)
    f = frequency + std_hz * generator.standard_normal(20_000)
    z = ratio + ratio_std * generator.standard_normal(20_000)
    true = 2 * np.pi * f * (-z + 1j * np.sqrt(1 - z**2)) + added
    dofs = (Dof.from_label("1+Z"),)
    seen = ModalModel(
        np.array([frequency]), np.array([ratio]), np.ones((1, 1), complex), dofs, np.array([std_hz]),
        np.array([ratio_std]),
    )  # fmt: skip
    again = without_window_damping(seen, added)
    assert again.natural_frequency_std_hz is not None and again.damping_ratio_std is not None
    # The scatter of 20 000 is known to 0.5 %; left as they were, both would be 4 % and more off.
    assert again.natural_frequency_std_hz[0] == pytest.approx((np.abs(true) / (2 * np.pi)).std(), rel=0.02)
    assert again.damping_ratio_std[0] == pytest.approx((-true.real / np.abs(true)).std(), rel=0.02)
    unknown = without_window_damping(replace(seen, damping_ratio_std=np.array([np.nan])), added)
    assert unknown.natural_frequency_std_hz is not None and unknown.natural_frequency_std_hz[0] == std_hz


def test_a_velocity_beside_an_accelerometer_is_differentiated_through_the_window(single_mass, make_campaign) -> None:
    """Along s = 1/τ + iω: by iω alone it would be off by 1/(τω), 20 % at 3 Hz."""
    force = np.concatenate([np.zeros(100), hits()[: int(BLOCK * RATE)], np.zeros(int(2 * BLOCK * RATE))])
    b, a, _ = cont2discrete(([0.5, 0.0], single_mass._coefficients[1]), 1 / RATE, method="foh")
    velocity = lfilter(np.ravel(b), a, force)
    campaign = make_campaign([{"F1+Z": force, "1+Z": single_mass.acceleration(force, RATE), "2+Z": velocity}], RATE)
    record = campaign.runs[0]
    channels = (*record.channels[:2], replace(record.channels[2], quantity=Quantity.VELOCITY, unit="m/s"))
    campaign = replace(campaign, runs=(replace(record, channels=channels),))
    frf = estimate_frf(campaign, "impact", impacts=replace(WINDOWS, decay_s=0.25), band_hz=(3.0, 20.0))
    assert frf.added_decay_rad_per_s == 4.0
    # What is left is the difference between a sampled derivative and a continuous one.
    np.testing.assert_allclose(frf.values[1], frf.values[0], rtol=0.01)


def test_only_motions_have_a_window_to_take_back() -> None:
    none = ModalModel(np.array([5.0]), np.array([0.01]), np.ones((1, 1), complex), (Dof.from_label("1+Z"),))
    with pytest.raises(InputError, match="excitation_force is no motion"):
        without_window_damping(none, 1.0, Quantity.EXCITATION_FORCE)


def test_the_force_window_keeps_noise_between_hits_out(single_mass, make_campaign) -> None:
    """Only a hundredth of the gauge's noise is let through: the scatter of the estimate falls accordingly."""
    mass, force = replace(single_mass, damping_ratio=0.064), hits()
    answer = mass.acceleration(force, RATE)
    errors = {}
    for width in (0.05, 6.5):
        windows, spread = replace(WINDOWS, force_s=width), []
        for seed in range(6):
            noisy = force + 0.002 * np.random.default_rng(seed).standard_normal(force.size)
            campaign = make_campaign([{"F1+Z": noisy, "2+Z": answer}], RATE)
            frf = estimate_frf(campaign, "impact", impacts=windows, band_hz=(3.0, 60.0))
            spread.append(np.abs(frf.values[0, 0] / held(mass, frf.frequency_hz) - 1) ** 2)
        errors[width] = np.sqrt(np.mean(spread))
    # The noise power let through goes with the window's length: sqrt(6.5 / 0.05) = 11.
    assert 6 < errors[6.5] / errors[0.05] < 20


def test_double_hits_are_left_out_and_said_so(single_mass, make_campaign) -> None:
    mass = replace(single_mass, damping_ratio=0.064)
    force = hits(seed=3, double_probability=0.5, double_interval_s=0.1)
    doubled = [np.count_nonzero(np.diff((block > 0).astype(int)) == 1) == 2 for block in force.reshape(3, -1)]
    assert 0 < sum(doubled) < 3
    campaign = make_campaign([{"F1+Z": force, "2+Z": mass.acceleration(force, RATE)}], RATE)
    frf = estimate_frf(campaign, "impact", impacts=WINDOWS, band_hz=(3.0, 60.0))
    assert f"{sum(doubled)} of 3 hits left out" in " ".join(frf.remarks)
    wanted = held(mass, frf.frequency_hz)
    assert np.abs(frf.values[0, 0] / wanted - 1).max() < 1e-6
    # Kept, the second hit is a response without its force, which the window has silenced.
    kept = estimate_frf(campaign, "impact", impacts=replace(WINDOWS, reject_double_hits=False), band_hz=(3.0, 60.0))
    assert np.abs(kept.values[0, 0] / wanted - 1).max() > 0.1


def test_the_notes_choose_the_estimator_and_nonsense_is_refused(single_mass, make_campaign) -> None:
    force = hits()
    campaign = make_campaign([{"F1+Z": force, "2+Z": single_mass.acceleration(force, RATE)}], RATE)
    noted = replace(campaign, notes={"impacts": WINDOWS.note()})
    assert impact_windows(noted) == WINDOWS
    np.testing.assert_array_equal(
        estimate_frf(noted, "auto").values, estimate_frf(campaign, "impact", impacts=WINDOWS).values
    )
    with pytest.raises(InputError, match="notes have no 'impacts'"):
        estimate_frf(campaign, "impact")
    with pytest.raises(InputError, match="no hit with"):
        estimate_frf(campaign, "impact", impacts=replace(WINDOWS, segment_s=100.0))
    with pytest.raises(InputError, match="note 'impacts'"):
        estimate_frf(replace(campaign, notes={"impacts": "{}"}), "auto")
