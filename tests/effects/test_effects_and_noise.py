"""What stands behind a sensor acts on the sensor's own noise, too, and not on that of the converter."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import scipy.signal
from numpy.typing import NDArray

from vgvt.effects import ChannelFilter, make_effect
from vgvt.scenario import NoiseSpectrum, Scenario, load_scenario
from vgvt.scenario.effect import EffectTable
from vgvt.simulation import simulated_campaign
from vgvt.simulation.assembly import Plan, plans
from vgvt.simulation.noise_floor import force_noise, response_noise

RATE_HZ = 1000.0
FLAT = {"frequency_hz": (1.0, 100.0), "density": (1e-4, 1e-4)}
BEHIND_THE_SENSOR: dict[str, dict[str, object]] = {
    # A corner at 83 Hz for four poles.
    "anti-alias-delay": {"delay_s": 5e-3},
    "channel-gain": {"gain_error": 0.15},
    "gain-drift": {"drift": -0.1},
    "high-pass-mismatch": {"corner_hz": 3.0},
}


@pytest.fixture(scope="module")
def silent() -> Scenario:
    """Two runs of a minute with nothing but the sensors' noise: flat, far above the converter's."""
    whole = load_scenario("hati-unsymmetric")
    wing = whole.airframe.beam[0].model_copy(update={"cells": 4})
    noise = {"noise": NoiseSpectrum(**FLAT), "high_pass_hz": 0.0}
    changes: dict[str, dict[str, object]] = {
        "airframe": {"beam": (wing,)},
        "accelerometers": noise,
        "transducer": noise,
        "acquisition": {
            "runs": ((1, 10), (1, 10)),
            "sample_rate_hz": RATE_HZ,
            "bits": 24,
            "range_v": 10.0,
            "noise_v_per_rthz": 0.0,
        },
        "excitation": {"duration_s": 20.0, "ring_down_s": 40.0, "lead_in_s": 0.0, "amplitude_v": 1e-12},
        "simulation": {"engine": "linear"},
    }
    return whole.model_copy(
        update={name: getattr(whole, name).model_copy(update=update) for name, update in changes.items()}
    )


def affected(scenario: Scenario, name: str, channels: str) -> Scenario:
    table = EffectTable(name=name, channels=channels, **BEHIND_THE_SENSOR[name])
    return scenario.model_copy(update={"effect": (table,)})


def with_converter(scenario: Scenario, noise_v_per_rthz: float) -> Scenario:
    acquisition = scenario.acquisition.model_copy(update={"noise_v_per_rthz": noise_v_per_rthz})
    return scenario.model_copy(update={"acquisition": acquisition})


def densities(scenario: Scenario) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies, Hz, and one-sided power densities (channels, lines) of the second run."""
    run = simulated_campaign(scenario).runs[1]
    return scipy.signal.welch(run.samples, RATE_HZ, nperseg=2000)  # type: ignore[no-any-return]


def passed(scenario: Scenario, name: str, frequency_hz: NDArray[np.float64]) -> NDArray[np.float64]:
    """What an effect makes of power in the second run, (lines,)."""
    (change,) = make_effect(name, "test", **BEHIND_THE_SENSOR[name]).act(scenario, 1).channels
    assert isinstance(change, ChannelFilter)
    return np.abs(change.response(frequency_hz)) ** 2


@pytest.mark.parametrize("channels", ["response", "force"])
@pytest.mark.parametrize("name", sorted(BEHIND_THE_SENSOR))
def test_a_sensors_noise_passes_what_is_behind_it(silent: Scenario, name: str, channels: str) -> None:
    """By the same draws of noise: line by line its power is multiplied as the signal's is, and no other channel's."""
    frequency, plain = densities(silent)
    _, got = densities(affected(silent, name, channels))
    rows, others = ([2, 3], [0, 1]) if channels == "response" else ([1], [0, 2, 3])
    np.testing.assert_array_equal(got[others], plain[others])
    gain = passed(silent, name, frequency)
    inside = (frequency > 1.0) & (frequency < 200.0)
    assert np.abs(gain[inside] - 1).max() > 0.15
    # Hann's window leaks where a filter is steep: over a few lines it does not matter.
    for low, high in ((1.0, 3.0), (10.0, 30.0), (60.0, 90.0), (160.0, 200.0)):
        band = (frequency >= low) & (frequency <= high)
        np.testing.assert_allclose(got[rows][:, band].sum(1), (gain * plain[rows])[:, band].sum(1), rtol=0.05)


@pytest.mark.parametrize("name", sorted(BEHIND_THE_SENSOR))
def test_the_converters_noise_comes_after_it(silent: Scenario, name: str) -> None:
    """What a louder converter adds is the same with the effect as without."""
    loud = with_converter(silent, 1e-3)
    frequency, plain = densities(loud)
    _, got = densities(affected(loud, name, "response"))
    _, quiet = densities(affected(silent, name, "response"))
    for low, high in ((0.5, 3.0), (3.0, 60.0), (60.0, 450.0)):
        band = (frequency >= low) & (frequency <= high)
        assert (plain[2:, band].sum(1) > 50 * quiet[2:, band].sum(1)).all()
        np.testing.assert_allclose(got[2:, band].sum(1), plain[2:, band].sum(1), rtol=0.03)


@pytest.mark.parametrize("name", sorted(BEHIND_THE_SENSOR))
def test_what_couples_in_at_the_converter_passes_no_conditioner(silent: Scenario, name: str) -> None:
    """Whichever table comes first: the hum is as high as its volts say."""
    hum = EffectTable(name="mains-hum", amplitude_v=1e-2, frequency_hz=50.0, second=0.0, third=0.0)
    (own,) = affected(silent, name, "response").effect
    with_hum, without = (silent.model_copy(update={"effect": tables}) for tables in ((own, hum), (own,)))
    got, turned, alone = (
        simulated_campaign(s).runs[1].samples[2]
        for s in (with_hum, silent.model_copy(update={"effect": (hum, own)}), without)
    )
    np.testing.assert_array_equal(turned, got)
    volts = (got - alone) * simulated_campaign(without).runs[1].channels[2].sensitivity_v_per_unit
    assert np.abs(volts).max() == pytest.approx(1e-2, rel=2e-3)


@pytest.mark.parametrize(("channels", "row"), [("response", 2), ("force", 1)])
@pytest.mark.parametrize("name", sorted(BEHIND_THE_SENSOR))
def test_the_noise_that_the_bound_knows_is_that_of_the_records(
    silent: Scenario, name: str, channels: str, row: int
) -> None:
    """What would have to be sensed to read it: the record's power by what the effect makes of it."""
    scenario = affected(silent, name, channels)
    frequency, got = densities(scenario)
    floor = (response_noise if channels == "response" else force_noise)(plans(scenario)[1], frequency)
    sensed = got[row] / np.maximum(passed(silent, name, frequency), 1e-3)
    for low, high in ((3.0, 30.0), (30.0, 90.0)):
        band = (frequency >= low) & (frequency <= high)
        assert np.mean(sensed[band] / floor[band]) == pytest.approx(1.0, abs=0.08)


@pytest.mark.parametrize(
    ("table", "row", "floor"), [("accelerometers", 2, response_noise), ("transducer", 1, force_noise)]
)
def test_below_the_corner_of_ac_coupling_more_would_have_to_be_sensed(
    silent: Scenario, table: str, row: int, floor: Callable[[Plan, NDArray], NDArray]
) -> None:
    """The noise of the record, which comes after it and stays, by the power that the stated filter lets pass."""
    coupled = silent.model_copy(update={table: getattr(silent, table).model_copy(update={"high_pass_hz": 8.0})})
    (frequency, plain), (_, got) = densities(silent), densities(coupled)
    inside = (frequency >= 1.0) & (frequency <= 90.0)
    np.testing.assert_allclose(got[row, inside], plain[row, inside], rtol=1e-3)
    response = scipy.signal.freqz(*scipy.signal.butter(1, 8.0, "highpass", fs=RATE_HZ), frequency, fs=RATE_HZ)[1]
    direct, through = (floor(plans(s)[1], frequency) for s in (silent, coupled))
    np.testing.assert_allclose(through[inside], direct[inside] / np.abs(response[inside]) ** 2, rtol=1e-9)
    assert np.isfinite(through).all()
