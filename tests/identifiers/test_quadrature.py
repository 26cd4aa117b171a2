"""The quadrature method on campaigns whose answer is known, and on records that are not as they should be."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Campaign, Channel, ChannelRole, Direction, Dof, InputError, Outcome, Quantity, modal_assurance
from vgvt.identification import make_identifier, run_identifier
from vgvt.identification.example import Example
from vgvt_identifiers.quadrature import Quadrature

FOUR = Example(
    frequency_hz=(5.2, 11.7, 17.3, 26.1),
    stations=4,
    sample_rate_hz=128.0,
    duration_s=40.0,
    sweep_s=40.0,
    noise_m_s2=0.05,
    force_noise_n=0.005,
)


def of_damping(damping: float, seed: int = 0) -> Example:
    return replace(FOUR, damping_ratio=(damping,) * 4, seed=seed)


@pytest.mark.parametrize("damping", [0.0005, 0.002, 0.01, 0.03])
def test_four_modes_in_noise_and_leakage(damping: float) -> None:
    """The sweep ends with the record, so that the lightly damped modes are cut off ringing."""
    example = of_damping(damping)
    model = run_identifier(Quadrature(), example.campaign())
    truth = example.modes()
    np.testing.assert_allclose(model.natural_frequency_hz, truth.natural_frequency_hz, rtol=3e-4)
    np.testing.assert_allclose(model.damping_ratio, truth.damping_ratio, rtol=0.03)
    assert np.diag(modal_assurance(model.shapes, truth.shapes)).min() > 0.995


def test_without_noise_it_is_exact_far_below_a_tenth_of_a_percent() -> None:
    example = replace(of_damping(0.01), noise_m_s2=0.0, force_noise_n=0.0)
    model = run_identifier(Quadrature(), example.campaign())
    np.testing.assert_allclose(model.natural_frequency_hz, example.frequency_hz, rtol=1e-5)
    np.testing.assert_allclose(model.damping_ratio, example.damping_ratio, rtol=1e-3)


def test_stated_standard_deviations_cover_the_errors() -> None:
    """Over 12 seeds and 4 modes, the errors are as large as stated within a factor of two."""
    ratios = []
    for seed in range(12):
        example = of_damping(0.01, seed)
        model = Quadrature().identify(example.campaign(), example.band_hz)
        assert model.natural_frequency_std_hz is not None
        assert model.damping_ratio_std is not None
        assert len(model) == 4
        error = model.natural_frequency_hz - np.array(example.frequency_hz)
        ratios.append([error / model.natural_frequency_std_hz, (model.damping_ratio - 0.01) / model.damping_ratio_std])
    spread = np.sqrt((np.array(ratios) ** 2).mean(axis=(0, 2)))
    assert np.all((spread > 0.4) & (spread < 1.6)), spread


def test_the_correction_improves_the_shapes_of_modes_that_overlap() -> None:
    close = replace(FOUR, frequency_hz=(15.0, 15.9), damping_ratio=(0.01, 0.01), noise_m_s2=0.0, force_noise_n=0.0)
    truth, mac = close.modes().shapes, {}
    for correction in ("none", "stahle-forlifer"):
        model = run_identifier(make_identifier("quadrature", correction=correction), close.campaign())
        assert len(model) == 2
        mac[correction] = np.diag(modal_assurance(model.shapes, truth))
    assert mac["none"].min() < 0.995
    assert mac["stahle-forlifer"].min() > 0.9999


def test_shapes_are_normalised_real_and_signed_by_the_largest_component() -> None:
    model = run_identifier(Quadrature(), of_damping(0.01).campaign())
    assert np.all(model.shapes.imag == 0)
    largest = model.shapes[np.arange(4), np.argmax(np.abs(model.shapes), axis=1)]
    np.testing.assert_allclose(largest, 1.0, rtol=1e-12)


def test_every_mode_carries_its_raw_sigma_peak() -> None:
    example = of_damping(0.01)
    model = run_identifier(Quadrature(), example.campaign())
    for frequency, flags in zip(model.natural_frequency_hz, model.flags, strict=True):
        raw = next(float(f.partition("=")[2]) for f in flags if f.startswith("sigma_peak_hz="))
        assert abs(raw - frequency) < 0.02 * frequency


@pytest.mark.parametrize(("damping", "narrow"), [(0.0005, True), (0.01, False)])
def test_modes_narrower_than_three_lines_are_flagged(damping: float, narrow: bool) -> None:
    model = run_identifier(Quadrature(), of_damping(damping).campaign())
    assert [("narrow" in flags) for flags in model.flags] == [narrow] * 4


def moving_modes(scatter: float) -> tuple[Example, Campaign]:
    """Roving runs of which each has its own natural frequencies, as when the sensors load the structure."""
    generator = np.random.default_rng(21)
    quiet = replace(FOUR, noise_m_s2=0.01, force_noise_n=0.0, damping_ratio=(0.007,) * 4)
    runs = []
    for index in range(quiet.stations):
        moved = tuple(f * (1 + scatter * generator.standard_normal()) for f in quiet.frequency_hz)
        runs.append(replace(quiet, frequency_hz=moved).campaign().runs[index])
    return quiet, replace(quiet.campaign(), runs=tuple(runs))


def test_runs_that_disagree_a_little_are_told_and_the_shapes_follow_each_run() -> None:
    quiet, campaign = moving_modes(0.004)
    truth, mac = quiet.modes(), {}
    for where in ("common", "per-run"):
        model = run_identifier(make_identifier("quadrature", shape_frequency=where), campaign)
        nearest = [int(np.argmin(np.abs(model.natural_frequency_hz - f))) for f in quiet.frequency_hz]
        mac[where] = np.diag(modal_assurance(model.shapes[nearest], truth.shapes))
        assert all(any(f.startswith("run_scatter_hz=") for f in model.flags[i]) for i in nearest)
        assert any("runs_disagree" in model.flags[i] for i in nearest)
        assert model.natural_frequency_std_hz is not None
        assert np.all(model.natural_frequency_std_hz[nearest] > 1e-3)
    assert mac["per-run"].min() > 0.999
    assert mac["common"].min() < mac["per-run"].min()


def test_runs_that_disagree_by_more_than_the_width_are_remarked_as_one_mode_that_moved() -> None:
    _, campaign = moving_modes(0.01)
    model = run_identifier(Quadrature(), campaign)
    assert any("one mode that moved between runs" in text for text in model.advice)


def with_channels(campaign: Campaign, change: Channel, of: Quantity) -> Campaign:
    """The campaign with every response channel of a quantity replaced by one like ``change``."""
    runs = []
    for record in campaign.runs:
        channels = tuple(replace(change, name=c.name, dof=c.dof) if c.quantity is of else c for c in record.channels)
        runs.append(replace(record, channels=channels))
    return replace(campaign, runs=tuple(runs))


def test_velocities_give_the_same_modes_as_accelerations() -> None:
    example = replace(of_damping(0.01), noise_m_s2=0.0)
    campaign = example.campaign()
    runs = []
    for record in campaign.runs:
        # Exact for the periodic part; leakage is a smooth addition that the fit takes up.
        spectrum = np.fft.rfft(record.samples[1:], axis=1)
        omega = 2 * np.pi * np.fft.rfftfreq(record.samples.shape[1], 1 / record.sample_rate_hz)
        velocity = np.fft.irfft(spectrum / np.where(omega > 0, 1j * omega, np.inf), record.samples.shape[1])
        runs.append(replace(record, samples=np.vstack([record.samples[:1], velocity])))
    moving = replace(campaign, runs=tuple(runs))
    sensor = Channel("v", Quantity.VELOCITY, ChannelRole.RESPONSE, Dof(1, Direction.PLUS_Z))
    model = run_identifier(Quadrature(), with_channels(moving, sensor, Quantity.ACCELERATION))
    np.testing.assert_allclose(model.natural_frequency_hz, example.frequency_hz, rtol=1e-4)
    assert np.diag(modal_assurance(model.shapes, example.modes().shapes)).min() > 0.999


def test_one_run_with_all_sensors_works_as_well_as_roving_ones() -> None:
    example = of_damping(0.01)
    roving = example.campaign()
    first = roving.runs[0]
    channels = first.channels[:1] + tuple(c for r in roving.runs for c in r.channels[1:])
    samples = np.vstack([first.samples[:1], *(r.samples[1:] for r in roving.runs)])
    together = replace(roving, runs=(replace(first, channels=channels, samples=samples),))
    model = run_identifier(Quadrature(), together)
    np.testing.assert_allclose(model.natural_frequency_hz, example.frequency_hz, rtol=3e-4)
    assert not any("scatter" in flag for flags in model.flags for flag in flags)


def test_a_shorter_run_is_padded() -> None:
    example = of_damping(0.02)
    campaign = example.campaign()
    short = replace(campaign.runs[1], samples=campaign.runs[1].samples[:, : 128 * 38])
    model = run_identifier(Quadrature(), replace(campaign, runs=(campaign.runs[0], short, *campaign.runs[2:])))
    np.testing.assert_allclose(model.natural_frequency_hz, example.frequency_hz, rtol=1e-3)


def test_a_run_without_a_sound_force_is_left_out_and_named() -> None:
    campaign = of_damping(0.01).campaign()
    dead = campaign.runs[1].samples.copy()
    dead[0] = 0.0
    model = run_identifier(
        Quadrature(), replace(campaign, runs=(campaign.runs[0], replace(campaign.runs[1], samples=dead)))
    )
    assert {d.node for d in model.dofs} == {1, 2}
    assert any("run 2 left out" in text for text in model.advice)


def test_no_sound_force_at_all_declines() -> None:
    campaign = of_damping(0.01).campaign()
    dead = campaign.runs[0].samples.copy()
    dead[0] = np.nan
    model = run_identifier(Quadrature(), replace(campaign, runs=(replace(campaign.runs[0], samples=dead),)))
    assert model.outcome is Outcome.DECLINED
    assert any("force" in text for text in model.advice)


def test_drive_points_that_share_no_sensor_leave_the_shape_incomplete() -> None:
    """The shaker moves to the first sensor for half of the runs: amplitudes of the two halves do not compare."""
    example = replace(of_damping(0.01), noise_m_s2=0.0, force_noise_n=0.0)
    campaign, moved = example.campaign(), example._accelerations(example._force(), example._gains(0))
    runs = list(campaign.runs)
    for station in (2, 3):
        record = runs[station]
        reference = replace(record.channels[0], dof=example.dofs[0])
        samples = np.vstack([record.samples[:1], moved[2 * station : 2 * station + 2]])
        runs[station] = replace(record, channels=(reference, *record.channels[1:]), samples=samples)
    model = run_identifier(Quadrature(), replace(campaign, runs=tuple(runs)))
    assert len(model) == 4
    assert all("shape_incomplete" in flags for flags in model.flags)
    assert ((model.shapes == 0).sum(axis=1) == 4).all()
    whole = run_identifier(Quadrature(), campaign)
    assert not any("shape_incomplete" in flags for flags in whole.flags)


@pytest.mark.parametrize(
    "setting", [{"prominence_db": -1.0}, {"false_alarm": 0.0}, {"background_terms": 0}, {"correction": "maybe"}]
)
def test_settings_out_of_range_are_bad_input(setting: dict[str, object]) -> None:
    with pytest.raises(InputError, match=next(iter(setting))):
        make_identifier("quadrature", **setting)


def test_twenty_channels_at_200_hz_take_under_a_second_of_one_core() -> None:
    example = replace(FOUR, stations=10, sample_rate_hz=200.0, duration_s=60.0, sweep_s=60.0, damping_ratio=(0.01,) * 4)
    campaign = example.campaign()
    run_identifier(Quadrature(), campaign, (4.0, 7.0))  # loads scipy
    start = time.process_time()
    run_identifier(Quadrature(), campaign)
    assert time.process_time() - start < 1.0
