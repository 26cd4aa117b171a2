"""Curve-fitting frequency domain decomposition on systems whose modes are known in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vgvt.data import Campaign, ChannelRole, Direction, Dof, Outcome, modal_assurance
from vgvt.identification import run_identifier
from vgvt.identification.example import Example
from vgvt_identifiers.bell_modes import BellOptions, bell_modes
from vgvt_identifiers.cfdd import Cfdd
from vgvt_identifiers.cfdd_output_only import CfddOutputOnly
from vgvt_identifiers.output_spectra import ReferenceMatrix, force_referenced, reference_matrix
from vgvt_identifiers.spectra import campaign_spectra
from vgvt_identifiers.steady_responses import steadiness

FOUR = Example(
    frequency_hz=(5.2, 11.7, 17.3, 26.1),
    damping_ratio=(0.01,) * 4,
    sample_rate_hz=128.0,
    duration_s=40.0,
    sweep_s=40.0,
    noise_m_s2=0.05,
    force_noise_n=0.005,
)


@pytest.mark.parametrize("poles", ["common", "per-run"])
@pytest.mark.parametrize("damping", [0.002, 0.01, 0.03])
def test_four_modes_in_noise(damping: float, poles: str) -> None:
    example = replace(FOUR, damping_ratio=(damping,) * 4)
    model = run_identifier(Cfdd(poles=poles), example.campaign())  # type: ignore[arg-type]
    truth = example.modes()
    np.testing.assert_allclose(model.natural_frequency_hz, truth.natural_frequency_hz, rtol=2e-3)
    np.testing.assert_allclose(model.damping_ratio, truth.damping_ratio, rtol=0.06)
    assert np.diag(modal_assurance(model.shapes, truth.shapes)).min() > 0.995


def test_very_light_damping_is_found_at_the_full_resolution_and_its_damping_is_stated_as_poorly_known() -> None:
    """The sweep ends with the record: the modes are cut off ringing, and no leakage peak is claimed."""
    example = replace(FOUR, damping_ratio=(0.0005,) * 4)
    model = run_identifier(Cfdd(), example.campaign())
    np.testing.assert_allclose(model.natural_frequency_hz, example.frequency_hz, rtol=2e-4)
    assert all("narrow" in flags for flags in model.flags)
    assert not any("doubt" in flag for flags in model.flags for flag in flags)
    assert model.damping_ratio_std is not None
    assert np.all(np.abs(model.damping_ratio - 0.0005) < 2 * model.damping_ratio_std)


@pytest.mark.parametrize("damping", [0.0002, 0.0005, 0.001, 0.002])
@pytest.mark.parametrize("noise", [0.02, 0.5])
def test_a_bell_far_narrower_than_a_line_states_no_damping_it_does_not_know(damping: float, noise: float) -> None:
    """At its lower bound the damping has no slope: that had counted as knowing it to sixteen digits."""
    for seed in range(3):
        example = Example(damping_ratio=(damping,) * 3, noise_m_s2=noise, seed=seed)
        model = run_identifier(Cfdd(), example.campaign())
        assert model.damping_ratio_std is not None
        doubtful = np.array([any("doubtful" in flag for flag in flags) for flags in model.flags])
        covered = np.abs(model.damping_ratio - damping) < 5 * model.damping_ratio_std
        assert (covered | doubtful).all()
        unresolved = 2 * model.damping_ratio * model.natural_frequency_hz * example.duration_s < 0.01
        assert doubtful[unresolved].all()
        least = 0.25 / (example.duration_s * model.natural_frequency_hz)
        assert (model.damping_ratio_std >= 0.999 * least)[unresolved].all()


def test_residues_are_those_of_the_receptance() -> None:
    example = replace(FOUR, noise_m_s2=0.0, force_noise_n=0.0)
    model = run_identifier(Cfdd(), example.campaign())
    assert model.residues is not None
    exact = example._gains()
    np.testing.assert_allclose(model.residues[:, :, 0], exact, rtol=0, atol=0.02 * np.abs(exact).max())


def two_points(example: Example) -> Campaign:
    """All sensors at once, shaken at the drive node in one run and at the first sensor in another."""
    force = example._force()
    first = example.campaign().runs[0].channels[0]
    channels = example.ambient_campaign(1.0).runs[0].channels
    runs = []
    for number, driven in ((1, -1), (2, 0)):
        response = example._accelerations(force, example._gains(driven))
        noise = example.noise_m_s2 * np.random.default_rng(number).standard_normal(response.shape)
        reference = first if driven < 0 else replace(first, dof=example.dofs[0])
        record = example.campaign().runs[0]
        runs.append(
            replace(record, run=number, channels=(reference, *channels), samples=np.vstack([force, response + noise]))
        )
    return replace(example.campaign(), runs=tuple(runs))


def test_one_force_gives_rank_one_and_two_give_rank_two() -> None:
    campaign = two_points(FOUR)
    one = reference_matrix(campaign_spectra(replace(campaign, runs=campaign.runs[:1]), FOUR.band_hz))
    two = reference_matrix(campaign_spectra(campaign, FOUR.band_hz))
    assert force_referenced(one).values.shape[0] == 1
    found = force_referenced(two)
    assert found.values.shape[0] == 2
    assert two.values.shape[:2] == (8, 2)
    # Independent check: the singular values of H H^H by its eigenvalues.
    line = 500
    matrix = two.values[:, :, line]
    eigenvalues = np.linalg.eigvalsh(matrix @ matrix.conj().T)[::-1][:2]
    np.testing.assert_allclose(found.values[:, line], eigenvalues, rtol=1e-9)


def test_two_points_of_excitation_separate_a_pair_that_one_cannot() -> None:
    """A pair closer than its own half-power width has one peak per singular value."""
    pair = replace(FOUR, frequency_hz=(15.0, 15.1), damping_ratio=(0.01, 0.01), noise_m_s2=0.005, force_noise_n=0.0)
    campaign = two_points(pair)
    alone = run_identifier(Cfdd(), replace(campaign, runs=campaign.runs[:1]), (8.0, 25.0))
    both = run_identifier(Cfdd(), campaign, (8.0, 25.0))
    assert len(alone) < 2
    assert len(both) == 2
    np.testing.assert_allclose(both.natural_frequency_hz, pair.frequency_hz, rtol=3e-3)


@pytest.mark.slow
@pytest.mark.parametrize("poles", ["common", "per-run"])
def test_stated_standard_deviations_cover_the_errors(poles: str) -> None:
    """Over 25 seeds and 4 modes; the fit's reach counts as doubt, so that they are rather too large than too small."""
    ratios = []
    for seed in range(25):
        example = replace(FOUR, seed=seed)
        model = run_identifier(Cfdd(poles=poles), example.campaign())  # type: ignore[arg-type]
        assert len(model) == 4
        assert model.natural_frequency_std_hz is not None
        assert model.damping_ratio_std is not None
        error = model.natural_frequency_hz - np.array(example.frequency_hz)
        ratios.append([error / model.natural_frequency_std_hz, (model.damping_ratio - 0.01) / model.damping_ratio_std])
    inside = (np.abs(np.array(ratios)) < 1.96).mean()
    assert inside > 0.92, inside


def test_output_only_finds_the_modes_under_steady_forces() -> None:
    model = run_identifier(CfddOutputOnly(), FOUR.ambient_campaign())
    np.testing.assert_allclose(model.natural_frequency_hz, FOUR.frequency_hz, rtol=1e-2)
    np.testing.assert_allclose(model.damping_ratio, FOUR.damping_ratio, rtol=0.6)
    assert np.diag(modal_assurance(model.shapes, FOUR.modes().shapes)).min() > 0.98


@pytest.mark.slow
def test_output_only_standard_deviations_match_the_scatter() -> None:
    ratios = []
    for seed in range(16):
        example = Example(noise_m_s2=0.05, seed=seed)
        model = run_identifier(CfddOutputOnly(), example.ambient_campaign())
        # Of 40 seeds one has a fourth claim, a ripple of the noise whose shape turns; it says that it is doubtful.
        sure = [k for k, flags in enumerate(model.flags) if not any(f.startswith("doubtful") for f in flags)]
        model = model.select(sure)
        assert len(model) == 3
        assert model.natural_frequency_std_hz is not None
        assert model.damping_ratio_std is not None
        error = model.natural_frequency_hz - np.array(example.frequency_hz)
        damping = model.damping_ratio - np.array(example.damping_ratio)
        ratios.append([error / model.natural_frequency_std_hz, damping / model.damping_ratio_std])
    spread = np.sqrt((np.array(ratios) ** 2).mean(axis=(0, 2)))
    assert np.all((spread > 0.6) & (spread < 1.5)), spread


def test_output_only_declines_a_sweep_and_roving_sensors_with_advice() -> None:
    sweep = replace(two_points(FOUR), runs=two_points(FOUR).runs[:1])
    model = run_identifier(CfddOutputOnly(), sweep)
    assert model.outcome is Outcome.DECLINED
    assert any("broad-band and steady" in text for text in model.advice)
    roving = run_identifier(CfddOutputOnly(), FOUR.campaign())
    assert roving.outcome is Outcome.DECLINED
    assert any("measure all sensors at once" in text for text in roving.advice)


def test_steadiness_tells_noise_from_a_sweep() -> None:
    sweep = two_points(FOUR).runs[0]
    noise = FOUR.ambient_campaign(40.0).runs[0]
    assert steadiness(sweep.select(ChannelRole.RESPONSE)[1], 128.0, FOUR.band_hz) < 0.1
    assert steadiness(noise.samples, 128.0, FOUR.band_hz) > 0.8


def test_without_dividing_by_the_force_spectra_peak_at_combined_resonances() -> None:
    """A coloured force, as a shaker's own resonance makes it, moves the peaks of the responses, not those of cfdd."""
    from scipy.signal import lfilter

    example = replace(FOUR, noise_m_s2=0.0, force_noise_n=0.0)
    generator = np.random.default_rng(2)
    pole = np.exp((-0.02 + 1j) * 2 * np.pi * 14.0 / example.sample_rate_hz)
    force = lfilter([1.0], [1.0, -2 * pole.real, abs(pole) ** 2], generator.standard_normal(160 * 128))
    record = two_points(example).runs[0]
    samples = np.vstack([force, example._accelerations(force)])
    campaign = replace(example.campaign(), runs=(replace(record, samples=samples),))
    blind = run_identifier(CfddOutputOnly(), campaign)
    assert np.abs(blind.natural_frequency_hz - 14.0).min() < 0.3
    assert any("combined resonances" in text for text in blind.advice)
    seeing = run_identifier(Cfdd(), campaign)
    assert np.abs(seeing.natural_frequency_hz - 14.0).min() > 1.0


@pytest.mark.parametrize(("cls", "setting"), [(Cfdd, "least_mac"), (CfddOutputOnly, "drop_db")])
def test_settings_out_of_range_are_bad_input(cls: type, setting: str) -> None:
    with pytest.raises(ValueError, match=setting):
        cls(**{setting: -1.0})


@pytest.mark.parametrize(("second_hz", "turns"), [(15.5, True), (22.0, False)])
def test_one_bell_over_two_modes_is_doubted(second_hz: float, turns: bool) -> None:
    """Two modes of orthogonal shapes under one force; half-power widths of 0.6 Hz hide 0.5 Hz, not 7 Hz."""
    frequency = np.arange(10.0, 27.0, 0.01)
    poles = [2 * np.pi * f * (-0.02 + 1j * np.sqrt(1 - 0.02**2)) for f in (15.0, second_hz)]
    s = 2j * np.pi * frequency
    shapes = np.kron([[1.0, 1.0], [1.0, -1.0]], np.ones(4))
    values = sum(v[:, None] * s**2 / ((s - p) * (s - np.conj(p))) for v, p in zip(shapes, poles, strict=True))
    dofs = tuple(Dof(n + 1, Direction.PLUS_Z) for n in range(8))
    variance = np.full(values[:, None].shape, 1e-4)
    found = force_referenced(ReferenceMatrix(frequency, dofs, dofs[:1], values[:, None], variance, ()))
    modes, _ = bell_modes(found, [(int(np.argmax(found.values[0])), 0)], BellOptions())
    assert len(modes) == 1
    assert ("doubtful_shape_turns" in modes[0].flags) == turns
