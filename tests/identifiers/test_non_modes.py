"""Tones and orders of the drive are flagged, modes are not, however lightly damped."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import hilbert

from vgvt.data import Campaign, ChannelRole, ModalModel, Record
from vgvt.effects.force_distortion import ForceDistortion
from vgvt.effects.mains_hum import MainsHum
from vgvt.identification import run_identifier
from vgvt.identification.example import Example
from vgvt.scenario import load_scenario
from vgvt_identifiers.cfdd_output_only import CfddOutputOnly
from vgvt_identifiers.non_modes import flag_non_modes
from vgvt_identifiers.quadrature import Quadrature
from vgvt_identifiers.ssi_cov import SsiCov

PLATE = Example(
    frequency_hz=(5.2, 11.7, 17.3, 26.1),
    damping_ratio=(0.01,) * 4,
    sample_rate_hz=160.0,
    duration_s=40.0,
    sweep_s=40.0,
    band_hz=(3.0, 55.0),
    noise_m_s2=0.02,
)
LIGHT = replace(PLATE, damping_ratio=(0.0005,) * 4)
Change = Callable[[NDArray[np.float64], Record, int], NDArray[np.float64]]


def with_responses(campaign: Campaign, change: Change) -> Campaign:
    """The campaign with every response changed; the change gets samples, record and row."""

    def of(record: Record) -> Record:
        rows = [
            change(x, record, i) if c.role is ChannelRole.RESPONSE else x
            for i, (c, x) in enumerate(zip(record.channels, record.samples, strict=True))
        ]
        return replace(record, samples=np.array(rows))

    return replace(campaign, runs=tuple(of(r) for r in campaign.runs))


def claim_with(example: Example, extra_hz: float, damping: float) -> ModalModel:
    """The true modes and one more at ``extra_hz``."""
    truth = example.modes()
    frequency = np.append(truth.natural_frequency_hz, extra_hz)
    order = np.argsort(frequency)
    shapes = np.vstack([truth.shapes, np.ones((1, len(truth.dofs)))])
    ratio = np.append(truth.damping_ratio, damping)
    return ModalModel(frequency[order], ratio[order], shapes[order], truth.dofs)


def doubted_hz(model: ModalModel, word: str) -> list[float]:
    """Frequencies of the modes with a flag that begins with a word."""
    flags = model.flags or ((),) * len(model)
    return [
        round(float(f), 3)
        for f, own in zip(model.natural_frequency_hz, flags, strict=True)
        if any(x.startswith(word) for x in own)
    ]


def humming(campaign: Campaign, line_hz: float, level: float) -> Campaign:
    """The hum of the effect on every response, as volts of a sensor of 1 V per m/s^2."""
    action = MainsHum(amplitude_v=level, frequency_hz=line_hz, second=0.0, third=0.0).act(load_scenario("quick"), 1)
    hum = action.channels[0].change
    generator = np.random.default_rng(5)
    return with_responses(campaign, lambda x, record, _: hum(x, record.sample_rate_hz, generator))


@pytest.mark.parametrize("line_hz", [49.9, 50.0])
def test_mains_hum_is_flagged_and_the_modes_are_not(line_hz: float) -> None:
    campaign = humming(PLATE.campaign(), line_hz, 0.05)
    model = flag_non_modes(campaign, claim_with(PLATE, line_hz, 1e-4))
    assert doubted_hz(model, "doubtful") == [line_hz]
    assert any("the power line" in text for text in model.advice)


def test_a_tone_in_the_middle_of_the_sweep_is_flagged() -> None:
    campaign = with_responses(
        PLATE.campaign(), lambda x, record, row: x + 0.05 * np.sin(2 * np.pi * 22.0 * record.time_s + row)
    )
    model = flag_non_modes(campaign, claim_with(PLATE, 22.0, 1e-4))
    assert doubted_hz(model, "doubtful_fixed_line") == [22.0]


def test_modes_damped_by_a_twentieth_of_a_percent_are_found_and_not_flagged() -> None:
    """At the full resolution of the record: their half-power widths are a fifth of a line and more."""
    model = run_identifier(Quadrature(), LIGHT.campaign())
    np.testing.assert_allclose(model.natural_frequency_hz, LIGHT.frequency_hz, rtol=1e-4)
    assert not doubted_hz(flag_non_modes(LIGHT.campaign(), model), "doubtful")


def test_a_pair_of_lightly_damped_modes_ten_lines_apart_stays_a_pair() -> None:
    pair = replace(LIGHT, frequency_hz=(16.0, 16.25), damping_ratio=(0.0005, 0.0005), noise_m_s2=0.005)
    model = run_identifier(Quadrature(), pair.campaign())
    np.testing.assert_allclose(model.natural_frequency_hz, pair.frequency_hz, rtol=2e-4)
    assert not doubted_hz(flag_non_modes(pair.campaign(), model), "doubtful")


def rattling(level: float) -> Change:
    """A structure that answers every response with ``level`` times its third multiple, as a rattle does."""

    def change(x: NDArray[np.float64], record: Record, row: int) -> NDArray[np.float64]:
        analytic = hilbert(x)
        return np.asarray(x + level * np.abs(analytic) * np.cos(3 * np.angle(analytic)))

    return change


def test_the_third_order_of_a_resonance_is_flagged() -> None:
    """A curved line makes 3 f of a response at f while the drive is at f, so 15.6 Hz looks like a mode."""
    campaign = with_responses(PLATE.campaign(), rattling(1.0))
    model = flag_non_modes(campaign, claim_with(PLATE, 15.6, 0.01))
    assert doubted_hz(model, "doubtful") == [15.6]
    assert "doubtful_order=3" in model.flags[2]


def test_force_distortion_flags_no_mode() -> None:
    """Harmonics that the shaker itself makes excite a mode for good, and the force says so."""
    example = replace(PLATE, frequency_hz=(5.2, 10.4, 15.6), damping_ratio=(0.01,) * 3)
    scenario = load_scenario("quick")
    action = ForceDistortion(second_harmonic=0.3, third_harmonic=0.1).act(scenario, 1)
    assert action.command is not None
    amplitude_v, bend = scenario.excitation.amplitude_v, action.command

    class Bent(Example):
        __slots__ = ()

        def _force(self) -> NDArray[np.float64]:
            plain = super()._force()
            return np.asarray(self.force_n / amplitude_v * bend(plain * amplitude_v / self.force_n, np.empty(0)))

    campaign = Bent(**{name: getattr(example, name) for name in example.__dataclass_fields__}).campaign()
    assert not doubted_hz(flag_non_modes(campaign, example.modes()), "doubtful")


def test_without_a_sweep_a_tone_is_told_from_a_light_mode() -> None:
    campaign = with_responses(
        LIGHT.ambient_campaign(), lambda x, record, row: x + 0.5 * np.sin(2 * np.pi * 22.0 * record.time_s + row)
    )
    assert doubted_hz(flag_non_modes(campaign, claim_with(LIGHT, 22.0, 1e-6)), "doubtful") == [22.0]
    assert not doubted_hz(flag_non_modes(campaign, LIGHT.modes()), "doubtful")


@pytest.mark.parametrize("method", [SsiCov(), CfddOutputOnly()], ids=lambda m: m.name)
def test_no_method_without_a_force_claims_a_tone_unflagged(method: SsiCov | CfddOutputOnly) -> None:
    campaign = with_responses(
        PLATE.ambient_campaign(80.0), lambda x, record, row: x + 3.0 * np.sin(2 * np.pi * 22.0 * record.time_s + row)
    )
    model = run_identifier(method, campaign)
    near = np.abs(model.natural_frequency_hz - 22.0) < 0.2
    doubted = [any(x.startswith("doubtful_fixed_line") for x in flags) for flags in model.flags]
    assert len(model) >= 3
    assert np.all(np.array(doubted)[near])
    assert not np.any(np.array(doubted)[~near])
