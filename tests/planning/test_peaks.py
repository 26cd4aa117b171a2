"""Limits of volts are peaks, also of commands whose amplitude is a root mean square."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.planning.budget import Budget
from vgvt.planning.driven_peaks import Outputs, frequency_hz
from vgvt.planning.limits import check_what_stays
from vgvt.planning.planner import Order, plan_test
from vgvt.planning.prediction import predict
from vgvt.planning.sweeps import affordable_sweeps
from vgvt.planning.system import systems_of
from vgvt.planning.wish import Wish
from vgvt.scenario import Scenario, load_scenario
from vgvt.scenario.generator import Generator
from vgvt.scenario.rig import RANDOM_KINDS, Excitation
from vgvt.signals.excitation import fade
from vgvt.simulation import simulated_campaign
from vgvt.simulation.command import drive_commands, peak_command_v, sample_times_s
from vgvt.simulation.linear_engine import respond

TARGETS = (("1st symmetric bending", 8.1), ("2nd symmetric bending", 31.8))


@pytest.fixture(scope="module", name="noisy")
def excited_by_noise(light: Scenario) -> Scenario:
    noise = Excitation(kind="random", start_hz=3.0, stop_hz=35.0, duration_s=16.0, amplitude_v=0.3, ring_down_s=2.0)
    return light.model_copy(update={"excitation": noise})


def order(free: str, **changes: object) -> Order:
    return Order(Budget(20, 10), frozenset(free.split(",")), seeds=0, **changes)


def test_a_sine_s_peak_is_its_amplitude_and_noise_goes_beyond_it(light, noisy) -> None:
    assert peak_command_v(light) == light.excitation.amplitude_v
    sampled = np.abs(drive_commands(noisy, 0, sample_times_s(noisy))).max()
    assert peak_command_v(noisy) == pytest.approx(sampled, rel=0.01)
    assert 3.0 < peak_command_v(noisy) / noisy.excitation.amplitude_v < 5.0


def test_no_plan_s_command_peaks_above_the_limit(noisy) -> None:
    for plan in plan_test(noisy, order("level", largest_peak_v=0.9)).plans:
        assert plan.scenario.excitation.kind == "random"
        assert peak_command_v(plan.scenario) == pytest.approx(0.9, rel=1e-5)


def test_without_a_limit_the_level_stays_what_it_is(noisy) -> None:
    plan = plan_test(noisy, order("level")).plans[0]
    assert plan.scenario.excitation == noisy.excitation


def test_what_stays_is_measured_by_its_peak(noisy) -> None:
    with pytest.raises(InputError, match=r"--max-volts: is 0\.9, but the command stays as it is and has peaks of 1"):
        plan_test(noisy, order("sweep-time", largest_peak_v=0.9))


def test_a_sweep_in_place_of_noise_is_as_strong(noisy) -> None:
    wish = Wish(frozenset({"band"}), Budget(20, 10), 10, peak_command_v(noisy), targets=TARGETS)
    (sweeps,) = affordable_sweeps(noisy, wish).values()
    own, *others = (sweep.excitation for sweep in sweeps)
    assert own == noisy.excitation
    assert others
    assert {e.amplitude_v for e in others} == {0.3 * np.sqrt(2)}


@pytest.mark.parametrize("kind", ["random", "burst-random"])
def test_what_to_expect_of_noise_is_what_comes(noisy, kind) -> None:
    keys = {"kind": kind} | ({"blocks": 4, "burst_fraction": 0.6} if kind == "burst-random" else {})
    noise = Excitation.model_validate(noisy.excitation.model_dump(exclude_none=True) | keys)
    scenario = noisy.model_copy(update={"excitation": noise})
    expected = predict(scenario)
    samples = np.abs(simulated_campaign(scenario, engine="linear").runs[0].samples).max(axis=1)
    assert expected.peak_force_n == pytest.approx(samples[1], rel=0.4)
    assert expected.peak_acceleration_m_per_s2 == pytest.approx(samples[2:].max(), rel=0.4)


@pytest.mark.parametrize(
    ("kind", "changes"),
    [
        ("linear-chirp", {"duration_s": 4.0}),
        ("linear-chirp", {"duration_s": 4.0, "start_hz": 35.0, "stop_hz": 3.0}),
        ("logarithmic-chirp", {"duration_s": 6.0}),
        ("stepped-sine", {"duration_s": 12.0, "points": 12, "settle_s": 0.1}),
    ],
)
def test_a_sweep_makes_what_it_is_followed_to_make(light, kind, changes) -> None:
    """Its envelope is that of two sweeps a quarter of a period apart, each of the exact engine."""
    keys = light.excitation.model_dump(exclude_none=True) | {"kind": kind, "taper_s": 0.5} | changes
    e = Excitation.model_validate(keys)
    (system,) = systems_of(light.model_copy(update={"excitation": e}))
    driven = system.driven
    rows = [*system.sensors, len(driven.output_matrix) - 1]
    outputs = Outputs.of(driven, driven.output_matrix[rows], driven.feedthrough_rows[rows, 0])
    time_s = np.arange(round(4000 * e.duration_s)) / 4000
    phase = 2 * np.pi * np.cumsum(frequency_hz(e, time_s)) / 4000
    size = fade(time_s, e.duration_s, e.taper_s)
    two = [respond(driven.outputs(rows), wave(phase) * size, 4000.0) for wave in (np.sin, np.cos)]
    np.testing.assert_allclose(outputs.swept(e), np.hypot(*two).max(axis=1), rtol=0.01)


@pytest.mark.parametrize("name", ["garteur-sm-ag19", "skoll-gvt2"])
def test_no_fast_sweep_of_a_bundled_scenario_exceeds_its_card(name) -> None:
    """Of a dwell by 9 %: past a resonance the rig rings on and adds to a force that had dropped out."""
    scenario = load_scenario(name)
    first = scenario.acquisition.model_copy(update={"runs": scenario.acquisition.runs[:1], "repeats": 1})
    scenario = scenario.model_copy(update={"acquisition": first})
    expected = predict(scenario)
    samples = np.abs(simulated_campaign(scenario, engine="linear").runs[0].samples).max(axis=1)
    assert samples[1] <= 1.005 * expected.peak_force_n
    assert samples[2:].max() <= 1.005 * expected.peak_acceleration_m_per_s2


def test_what_a_plan_s_level_would_overload_is_told(light) -> None:
    """At 9 V a force of some 100 N is beyond the transducer's 44.5 N; as described nothing is."""
    result = plan_test(light, order("level", largest_peak_v=9.0))
    assert result.as_described.overloads == ()
    for plan in result.plans:
        (words,) = plan.overloads
        assert words.startswith(
            f"the force of up to {plan.prediction.peak_force_n:.3g} N is beyond the force transducer's"
        )
        assert plan.as_dict()["overloads"] == [words]


def test_peaks_of_noise_beyond_the_generator_are_told(noisy) -> None:
    loud = noisy.model_copy(update={"generator": noisy.generator.model_copy(update={"range_v": 0.5})})
    assert peak_command_v(loud) == peak_command_v(noisy) > 0.5
    told = plan_test(loud, order("sensors")).as_described.overloads
    assert len(told) == 1
    assert "is beyond the generator's ±0.5 V" in told[0]


def test_more_volts_than_the_generator_gives_are_refused(light) -> None:
    with pytest.raises(InputError, match=r"--max-volts: is 10\.5, but the scenario's generator gives 10 V"):
        plan_test(light, order("level", largest_peak_v=10.5))


def test_what_is_not_recorded_takes_its_minutes_and_stays_in_other_sweeps(light) -> None:
    late = light.model_copy(update={"excitation": light.excitation.model_copy(update={"unrecorded_s": 4.0})})
    budget = Budget(20, 10)
    assert budget.minutes_of(late) == budget.minutes_of(light)
    assert budget.shortest_sweep_s(late) == budget.shortest_sweep_s(light) + 4.0
    wish = Wish(frozenset({"band"}), budget, 10, 1.0, targets=TARGETS)
    (sweeps,) = affordable_sweeps(late, wish).values()
    assert len(sweeps) > 1
    assert {sweep.excitation.before_record_s for sweep in sweeps} == {4.0}
    # From 3 to 35 Hz in 16 s: at 11 Hz when the record begins, and the first bending at 8 Hz is gone.
    assert (
        min(mode.frequency_hz for mode in predict(late).modes)
        > 11.0
        > min(m.frequency_hz for m in predict(light).modes)
    )


def test_no_sweep_asks_for_more_than_the_generator_gives(noisy: Scenario) -> None:
    """A sine as loud as legal noise may be louder than the generator: what is planned must be a scenario, too."""
    most = 1.2 * noisy.excitation.amplitude_v
    limited = noisy.model_copy(update={"generator": Generator(range_v=most)})
    wish = Wish(frozenset({"band"}), Budget(20, 10), 10, peak_command_v(noisy), targets=TARGETS)
    (sweeps,) = affordable_sweeps(limited, wish).values()
    sines = [s.excitation for s in sweeps if s.excitation.kind not in RANDOM_KINDS]
    assert sines and max(e.amplitude_v for e in sines) <= most
    # Nor does a limit of volts have to be above what never gets through.
    check_what_stays(limited, Wish(frozenset(), Budget(20, 10), 10, most, targets=TARGETS))
