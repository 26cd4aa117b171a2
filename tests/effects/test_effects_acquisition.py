"""Each effect of the acquisition does to known signals, and to a simulated campaign, what its formula says."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from small_rig import revised

from vgvt.data import InputError, Record
from vgvt.effects import ChannelFilter, ChannelTransform, make_effect
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.effect import EffectTable
from vgvt.signals.resampling import REACH
from vgvt.simulation import simulated_campaign

RATE_HZ = 1000.0
TIME_S = np.arange(8000) / RATE_HZ


@pytest.fixture(scope="module")
def short() -> Scenario:
    """One short run of Hati with four links a wing, solved by the linear engine, without noise or filters."""
    whole = load_scenario("hati-unsymmetric")
    wing = whole.airframe.beam[0].model_copy(update={"cells": 4})
    clean: dict[str, object] = {"noise": None, "high_pass_hz": 0.0}
    sweep = {"start_hz": 3.0, "stop_hz": 30.0, "duration_s": 6.0, "taper_s": 0.5, "lead_in_s": 1.0, "ring_down_s": 9.0}
    changes: dict[str, dict[str, object]] = {
        "airframe": {"beam": (wing,)},
        "accelerometers": clean,
        "transducer": clean,
        "acquisition": {
            "runs": ((1, 10),),
            "sample_rate_hz": RATE_HZ,
            "bits": 24,
            "range_v": 10.0,
            "noise_v_per_rthz": 0.0,
        },
        "excitation": sweep | {"amplitude_v": 0.1},
        "simulation": {"engine": "linear"},
    }
    return whole.model_copy(
        update={name: getattr(whole, name).model_copy(update=update) for name, update in changes.items()}
    )


@pytest.fixture(scope="module")
def plain(short: Scenario) -> Record:
    """The record without any effect."""
    return simulated_campaign(short).runs[0]


def recorded(scenario: Scenario, name: str = "", **parameters: object) -> Record:
    """The record with one effect, or without any."""
    tables = (EffectTable(name=name, **parameters),) if name else ()
    return simulated_campaign(scenario.model_copy(update={"effect": tables})).runs[0]


def transformed(
    scenario: Scenario, samples: NDArray[np.float64], name: str, **parameters: object
) -> NDArray[np.float64]:
    """What the effect's one transform of a channel makes of samples (N,)."""
    (change,) = make_effect(name, "test", **parameters).act(scenario, 0).channels
    assert isinstance(change, ChannelTransform)
    return change.change(samples, RATE_HZ, np.random.default_rng(1))


def volts(record: Record) -> NDArray[np.float64]:
    """The samples as the converter had them, (channels, N)."""
    return record.samples * np.array([[c.sensitivity_v_per_unit] for c in record.channels])


def test_hum_is_three_lines_of_the_stated_height(short: Scenario, plain: Record) -> None:
    """Before the sweep starts nothing but the hum is there: a Fourier series over whole periods gives its heights."""
    hum = recorded(short, "mains-hum", amplitude_v=2e-3, frequency_hz=60.0, second=0.2, third=0.4)
    quiet = volts(hum)[:, : int(RATE_HZ) // 2] - volts(plain)[:, : int(RATE_HZ) // 2]
    height = 2 * np.abs(np.fft.rfft(quiet, axis=1)) / quiet.shape[1]
    line_hz = np.fft.rfftfreq(quiet.shape[1], 1 / RATE_HZ)
    step = 2 * 10.0 / 2**24
    for frequency, level in ((60.0, 2e-3), (120.0, 4e-4), (180.0, 8e-4)):
        np.testing.assert_allclose(height[:, line_hz == frequency], level, atol=2 * step)
    assert height[:, ~np.isin(line_hz, (60.0, 120.0, 180.0))].max() < 3 * step
    phases = np.angle(np.fft.rfft(quiet, axis=1)[:, line_hz == 60.0].ravel())
    assert np.ptp(phases) > 0.1, "every channel has a phase of its own"


def test_hum_above_half_the_rate_stays_out(short: Scenario) -> None:
    slow = transformed(short, np.zeros(4000), "mains-hum", amplitude_v=1.0, frequency_hz=200.0, second=1.0, third=1.0)
    spectrum = np.abs(np.fft.rfft(slow))
    assert set(np.fft.rfftfreq(4000, 1 / RATE_HZ)[spectrum > 1.0]) == {200.0, 400.0}


def test_clipping_is_at_the_narrower_range_and_flagged(short: Scenario, plain: Record) -> None:
    largest = np.abs(volts(plain)).max(axis=1)
    divisor = 10.0 / (0.5 * largest[1])
    clipped = recorded(short, "clipping-range", range_divisor=float(divisor))
    limit = 10.0 / divisor
    assert np.abs(volts(clipped)[1]).max() == pytest.approx(limit, rel=1e-6)
    expected = {c.name for c, peak in zip(plain.channels, largest, strict=True) if peak > limit}
    assert set(clipped.overloaded) == expected
    assert "force" in expected
    inside = np.abs(volts(plain)[1]) < 0.99 * limit
    np.testing.assert_allclose(volts(clipped)[1][inside], volts(plain)[1][inside], atol=2 * 20.0 / 2**24)


def test_quantisation_noise_is_a_step_over_root_twelve(short: Scenario, plain: Record) -> None:
    """Widrow's model, on samples much larger than a step; every sample lies on a step."""
    coarse = recorded(short, "quantisation", lost_bits=10.0)
    step = 2 * 10.0 / 2**14
    values = volts(coarse)
    np.testing.assert_allclose(values / step, np.round(values / step), atol=1e-6)
    busy = slice(int(1.5 * RATE_HZ), int(6.5 * RATE_HZ))
    drive = [c.name for c in plain.channels].index("drive")
    error = (values - volts(plain))[drive, busy]
    assert error.std() == pytest.approx(step / np.sqrt(12), rel=0.05)
    assert recorded(short, "quantisation", lost_bits=0.4).samples == pytest.approx(plain.samples, abs=0)


def test_repeated_samples_are_the_ones_before(short: Scenario) -> None:
    samples = np.arange(TIME_S.size, dtype=float)
    held = transformed(short, samples, "dropped-samples", losses=20.0, samples_lost=3.0)
    jump = np.flatnonzero(held != samples)
    assert 20 < jump.size <= 60
    assert set(held[jump]) <= set(samples)
    # A run of lost samples shows the value just before it.
    first = jump[np.insert(np.diff(jump) > 1, 0, True)]
    np.testing.assert_array_equal(held[first], samples[first - 1])


def test_closed_up_samples_bring_the_rest_early(short: Scenario) -> None:
    samples = np.arange(TIME_S.size, dtype=float)
    early = transformed(short, samples, "dropped-samples", losses=7.0, kind="closed-up")
    lead = early[:-10] - samples[:-10]
    assert (np.diff(lead) >= 0).all(), "it only ever grows"
    assert lead[0] == 0
    assert lead[-1] == 7


def noisy(scenario: Scenario, **acquisition: object) -> Scenario:
    """The scenario with a converter whose noise is some hundred steps: without losses hardly a sample is repeated."""
    changes = {"noise_v_per_rthz": 1e-5, **acquisition}
    return scenario.model_copy(update={"acquisition": scenario.acquisition.model_copy(update=changes)})


def losing(scenario: Scenario, *tables: dict[str, str]) -> list[Record]:
    """The records with devices that lose samples."""
    effects = tuple(EffectTable(name="dropped-samples", losses=20.0, samples_lost=3.0, **table) for table in tables)
    return list(simulated_campaign(scenario.model_copy(update={"effect": effects})).runs)


def changed(got: Record, plain: Record) -> list[set[int]]:
    """Which samples of each channel are not what they would be."""
    return [set(map(int, np.flatnonzero(row))) for row in got.samples != plain.samples]


def test_a_lost_sample_is_the_one_before_it_to_the_last_bit(short: Scenario) -> None:
    """The converter's noise and rounding are in what is repeated: that is how a drop-out is found."""
    scenario = noisy(short)
    (plain,), (got,) = losing(scenario), losing(scenario, {})
    steps = np.diff(got.samples, axis=1)
    lost = sorted(changed(got, plain)[2])
    assert 20 < len(lost) <= 60
    assert (steps[2, np.array(lost) - 1] == 0).all()
    assert np.mean(np.diff(plain.samples[2]) == 0) < 0.01
    kept = np.setdiff1d(np.arange(got.samples.shape[1]), lost)
    np.testing.assert_array_equal(got.samples[2, kept], plain.samples[2, kept])


def test_what_is_closed_up_are_the_samples_as_they_were_converted(short: Scenario) -> None:
    scenario = noisy(short)
    (plain,), (got,) = losing(scenario), losing(scenario, {"kind": "closed-up"})
    last = int(np.flatnonzero(got.samples[2] != plain.samples[2, -1])[-1]) + 1
    assert 20 < plain.samples.shape[1] - 1 - last <= 60, "the last sample fills up the end"
    remaining = iter(plain.samples[2])
    assert all(sample in remaining for sample in got.samples[2, : last + 1]), "the others are there in their order"


def test_all_channels_of_a_device_lose_the_same_samples_and_other_runs_others(short: Scenario) -> None:
    scenario = noisy(short, runs=2 * short.acquisition.runs)
    plain, got = losing(scenario), losing(scenario, {})
    first, second = (changed(g, p) for g, p in zip(got, plain, strict=True))
    assert first[2] == first[3]
    assert first[:2] == [set(), set()]
    assert len(first[2] & second[2]) < 10


@pytest.mark.parametrize(("other", "row"), [("force", 1), ("10+Z", 3), ("response", 3)])
def test_two_devices_lose_samples_of_their_own(short: Scenario, other: str, row: int) -> None:
    """And what the first one loses does not depend on the other."""
    scenario, one = noisy(short), {"channels": "1+Z"}
    (plain,), (alone,), (both,) = losing(scenario), losing(scenario, one), losing(scenario, one, {"channels": other})
    ours, of_both = changed(alone, plain)[2], changed(both, plain)
    assert 20 < len(ours) <= 60
    assert 20 < len(of_both[row]) <= 60
    assert len(ours & of_both[row]) < 10
    assert of_both[2] == (ours | of_both[3] if other == "response" else ours)


@pytest.mark.parametrize("skew", [3e-4, -3e-4])
@pytest.mark.parametrize("share", [0.03, 0.2, 0.4, 0.45])
def test_clock_skew_reads_the_signal_at_its_own_instants(short: Scenario, skew: float, share: float) -> None:
    """Of a sine of any frequency, as a share of the rate, that a converter lets through; not at the record's ends."""

    def signal(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.sin(2 * np.pi * share * RATE_HZ * time_s + 1.0))

    got = transformed(short, signal(TIME_S), "clock-skew", skew=skew)
    inner = slice(REACH + 1, -REACH - 4)
    np.testing.assert_allclose(got[inner], signal(TIME_S * (1 + skew))[inner], rtol=0, atol=1e-4)


@pytest.mark.parametrize("skew", [3e-4, -3e-4, 0.05])
def test_clock_skew_leaves_a_straight_line_straight_to_its_ends(short: Scenario, skew: float) -> None:
    """Nothing wraps around: it goes on beyond its ends as it came, but after the last sample nothing is known."""
    got = transformed(short, 3.0 + TIME_S, "clock-skew", skew=skew)
    np.testing.assert_allclose(got, 3.0 + np.minimum(TIME_S * (1 + skew), TIME_S[-1]), rtol=0, atol=1e-4)


@pytest.mark.parametrize("skew", [2e-3, -2e-3])
def test_a_skewed_clock_counts_from_the_record_s_beginning(short: Scenario, skew: float) -> None:
    """Sample n of a record that begins late was taken at n (1 + ε)/fs after its beginning, not after rest."""
    late = revised(short, excitation={"lead_in_s": 0.0, "unrecorded_s": 2.0})
    whole, skewed = recorded(revised(late, excitation={"unrecorded_s": None})), recorded(late, "clock-skew", skew=skew)
    instant = 2.0 + np.arange(skewed.samples.shape[1]) / RATE_HZ * (1 + skew)
    known = instant < 14.0
    rest_s = np.arange(whole.samples.shape[1]) / RATE_HZ
    wanted = CubicSpline(rest_s, whole.samples[2:], axis=1)(instant[known])
    np.testing.assert_allclose(skewed.samples[2:, known], wanted, rtol=0, atol=1e-4 * np.abs(wanted).max())
    np.testing.assert_array_equal(skewed.samples[1], whole.samples[1, -skewed.samples.shape[1] :])


def test_clock_skew_shows_as_a_phase_that_grows_through_the_sweep(short: Scenario, plain: Record) -> None:
    """At the time t of a sweep the response leads by 2 π f ε t: read off two windows at their own instants."""
    skew = 2e-4
    skewed = recorded(short, "clock-skew", skew=skew)
    response = [c.name for c in plain.channels].index("force") + 1
    for centre_s in (2.5, 6.0):
        window = slice(int((centre_s - 0.5) * RATE_HZ), int((centre_s + 0.5) * RATE_HZ))
        shape = np.hanning(window.stop - window.start)
        spectra = [np.fft.rfft(shape * r.samples[response, window]) for r in (plain, skewed)]
        line = int(np.argmax(np.abs(spectra[0])))
        frequency = np.fft.rfftfreq(shape.size, 1 / RATE_HZ)[line]
        phase = np.angle(spectra[1][line] / spectra[0][line])
        assert phase == pytest.approx(2 * np.pi * frequency * skew * centre_s, rel=0.1)
    np.testing.assert_array_equal(skewed.samples[1], plain.samples[1])


@pytest.mark.parametrize("order", [2, 4, 8])
def test_anti_alias_filter_is_the_butterworth_with_that_delay(short: Scenario, order: int) -> None:
    """|H|² = 1/(1 + (f/f_c)^2n); delay at low frequency as stated; against scipy's analogue design."""
    from scipy.signal import butter, freqs

    effect = make_effect("anti-alias-delay", "test", delay_s=2e-3, order=order)
    (change,) = effect.act(short, 0).channels
    assert isinstance(change, ChannelFilter)
    corner = effect.corner_hz  # type: ignore[attr-defined]
    frequency = np.array([1e-3, 10.0, 0.5 * corner, corner, 3 * corner])
    got = change.response(frequency)
    np.testing.assert_allclose(np.abs(got) ** 2, 1 / (1 + (frequency / corner) ** (2 * order)), rtol=1e-9)
    assert -np.angle(got[0]) / (2 * np.pi * frequency[0]) == pytest.approx(2e-3, rel=1e-6)
    expected = freqs(*butter(order, 2 * np.pi * corner, analog=True), 2 * np.pi * frequency)[1]
    np.testing.assert_allclose(got, expected, rtol=1e-6, atol=1e-9)


def test_anti_alias_delay_turns_responses_against_the_force(short: Scenario, plain: Record) -> None:
    """A/F is multiplied by the filter; the force itself is untouched."""
    delayed = recorded(short, "anti-alias-delay", delay_s=1e-3)
    frequency = np.fft.rfftfreq(plain.samples.shape[1], 1 / RATE_HZ)
    band = (frequency > 5) & (frequency < 28)
    before, after = (np.fft.rfft(r.samples, axis=1)[:, band] for r in (plain, delayed))
    np.testing.assert_array_equal(delayed.samples[1], plain.samples[1])
    ratio = (after[2] / after[1]) / (before[2] / before[1])
    strong = np.abs(before[2]) > 0.1 * np.abs(before[2]).max()
    np.testing.assert_allclose(np.angle(ratio[strong]), -2 * np.pi * frequency[band][strong] * 1e-3, atol=5e-3)


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        ("clipping-range", {"range_divisor": 0.5}),
        ("quantisation", {"lost_bits": -1.0}),
        ("dropped-samples", {"losses": -1.0}),
        ("dropped-samples", {"kind": "shuffled"}),
        ("clock-skew", {"skew": 100.0}),
        ("anti-alias-delay", {"order": 3}),
    ],
)
def test_impossible_settings_are_refused(name: str, parameters: dict[str, object]) -> None:
    with pytest.raises(InputError, match=name if "kind" not in parameters and "order" not in parameters else "fit"):
        make_effect(name, "test", **parameters)


ON_CHANNELS = {
    "aliased-interference": {"amplitude_v": 1e-2},
    "anti-alias-delay": {"delay_s": 1e-3},
    "channel-delay": {"delay_s": 1e-3},
    "channel-gain": {"gain_error": 0.1},
    "clock-skew": {"skew": 1e-4},
    "dropped-samples": {"losses": 3.0},
    "gain-drift": {"drift": 0.1},
    "high-pass-mismatch": {"corner_hz": 1.0},
    "mains-hum": {"amplitude_v": 1e-3},
    "sign-flip": {},
}
"""Effects with a choice of channels, and enough of each to be felt."""


@pytest.fixture(scope="module")
def twice(short: Scenario) -> Scenario:
    """The short run done a second time, when what drifts has drifted."""
    acquisition = short.acquisition.model_copy(update={"runs": 2 * short.acquisition.runs})
    return short.model_copy(update={"acquisition": acquisition})


@pytest.mark.parametrize("name", sorted(ON_CHANNELS))
@pytest.mark.parametrize(("choice", "meant"), [("sensor-2", ("10+Z",)), ("even", ("10+Z",)), ("force", ("force",))])
def test_every_choice_of_channels_means_the_same_to_every_effect(
    twice: Scenario, name: str, choice: str, meant: tuple[str, ...]
) -> None:
    changes = make_effect(name, "test", **{**ON_CHANNELS[name], "channels": choice}).act(twice, 1).channels
    assert tuple(c.channels for c in changes) == meant


@pytest.mark.parametrize("name", sorted(ON_CHANNELS))
@pytest.mark.parametrize(("choice", "words"), [("sensor2", r"'force'.*sensor-2"), ("sensor-3", "no run has 3 sensors")])
def test_a_choice_that_means_nothing_is_refused(twice: Scenario, name: str, choice: str, words: str) -> None:
    """A channel that is misspelt or not there would leave the records as they were, and nobody would know."""
    effect = make_effect(name, "test", **{**ON_CHANNELS[name], "channels": choice})
    with pytest.raises(InputError, match=words):
        effect.act(twice, 1)
