"""One bad channel or band costs that channel or band, with a reason, and never the rest of the claim."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from vgvt.data import Campaign, ChannelRole, ModalModel, Record, modal_assurance
from vgvt.identification import Needs, available_identifiers, make_identifier, run_identifier
from vgvt.identification.example import Example

PLATE = Example(noise_m_s2=0.01, force_noise_n=0.001, seed=8)
BROKEN = "a4"
Fault = Callable[[NDArray[np.float64], Record], NDArray[np.float64]]


def dead(x: NDArray[np.float64], record: Record) -> NDArray[np.float64]:
    del record
    return np.zeros_like(x)


def not_a_number(x: NDArray[np.float64], record: Record) -> NDArray[np.float64]:
    del record
    return np.where(np.arange(x.size) % 1000 == 500, np.nan, x)


def saturated(x: NDArray[np.float64], record: Record) -> NDArray[np.float64]:
    del record
    limit = 0.3 * np.abs(x).max()
    return np.clip(x, -limit, limit)


FAULTS: dict[str, Fault] = {"dead": dead, "not finite": not_a_number, "saturated": saturated}


def bundled(with_force: bool) -> list[str]:
    """The identifiers of this project that need the force, or those that do without."""
    found = []
    for name, cls in available_identifiers().items():
        if cls.__module__.startswith("vgvt_identifiers.") and not hasattr(cls, "requires"):
            needs = make_identifier(name).needs
            if (Needs.OUTPUT_ONLY in needs) != with_force:
                found.append(name)
    return found


def with_fault(campaign: Campaign, fault: Fault, names: Callable[[str], bool]) -> Campaign:
    def of(record: Record) -> Record:
        rows = [
            fault(x, record) if c.role is ChannelRole.RESPONSE and names(c.name) else x
            for c, x in zip(record.channels, record.samples, strict=True)
        ]
        return replace(record, samples=np.array(rows))

    return replace(campaign, runs=tuple(of(r) for r in campaign.runs))


def assert_right(model: ModalModel, frequency: float, damping: float, mac: float, above_hz: float = 0.0) -> None:
    """Every true mode above a frequency is claimed at the sound sensors."""
    truth = PLATE.modes().at(tuple(d for d in model.dofs if d.node != 4))
    claim = model.at(truth.dofs)
    for i, true_hz in enumerate(truth.natural_frequency_hz):
        if true_hz < above_hz:
            continue
        near = int(np.argmin(np.abs(claim.natural_frequency_hz - true_hz)))
        assert claim.natural_frequency_hz[near] == pytest.approx(true_hz, rel=frequency)
        assert claim.damping_ratio[near] == pytest.approx(truth.damping_ratio[i], rel=damping)
        assert modal_assurance(claim.shapes[near], truth.shapes[i])[0, 0] > mac


# The conformance suite tries dead channels and NaN on every method, so these are for the long run.
_ALL = [f if f == "saturated" else pytest.param(f, marks=pytest.mark.slow) for f in FAULTS]


@pytest.mark.parametrize("fault", _ALL)
@pytest.mark.parametrize("name", bundled(with_force=True))
def test_one_bad_channel_costs_that_channel(name: str, fault: str) -> None:
    campaign = with_fault(PLATE.campaign(), FAULTS[fault], lambda channel: channel == BROKEN)
    model = run_identifier(make_identifier(name), campaign)
    assert any(BROKEN in text and fault in text for text in model.advice), model.advice
    assert not any(d.node == 4 for d in model.dofs)
    assert_right(model, 2e-3, 0.1, 0.99)


@pytest.mark.parametrize("fault", _ALL)
@pytest.mark.parametrize("name", bundled(with_force=False))
def test_one_bad_channel_costs_a_method_without_force_that_channel(name: str, fault: str) -> None:
    campaign = with_fault(PLATE.ambient_campaign(), FAULTS[fault], lambda channel: channel == BROKEN)
    model = run_identifier(make_identifier(name), campaign)
    assert any(BROKEN in text and fault in text for text in model.advice), model.advice
    assert not any(d.node == 4 for d in model.dofs)
    assert_right(model, 1e-2, 0.5, 0.97)


# One rational function over the whole band: what is buried below costs it the mode next to it.
BESIDE_HZ = {"vector-fitting": 8.0}


def drifting(x: NDArray[np.float64], record: Record) -> NDArray[np.float64]:
    """Noise below 5 Hz that buries everything there, as of a table that somebody leans on."""
    generator = np.random.default_rng(int(1000 * abs(x[1000])))
    spectrum = np.fft.rfft(generator.standard_normal(x.size))
    spectrum[np.fft.rfftfreq(x.size, 1 / record.sample_rate_hz) > 5.0] = 0
    noise = np.fft.irfft(spectrum, x.size)
    return x + 10 * noise / noise.std()


@pytest.mark.parametrize("name", bundled(with_force=True))
def test_coherence_lost_below_5_hz_costs_that_band(name: str) -> None:
    """The band reaches from 3 Hz: what is buried is named, the modes above are right, and none is claimed below."""
    campaign = with_fault(PLATE.campaign(), drifting, lambda channel: True)
    model = run_identifier(make_identifier(name), campaign)
    flags = model.flags or ((),) * len(model)
    low = [
        f
        for f, own in zip(model.natural_frequency_hz, flags, strict=True)
        if f < 5.0 and not any("doubt" in flag for flag in own)
    ]
    assert not low, f"claims {low} Hz where there is no coherence"
    assert any("coherence" in text for text in model.advice), model.advice
    assert_right(model, 2e-3, 0.15, 0.99, above_hz=BESIDE_HZ.get(name, 5.0))
