"""Limits of volts are peaks, also of commands whose amplitude is a root mean square."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.planning.budget import Budget
from vgvt.planning.planner import Order, plan_test
from vgvt.planning.prediction import predict
from vgvt.planning.sweeps import affordable_sweeps
from vgvt.planning.wish import Wish
from vgvt.scenario import Scenario
from vgvt.scenario.rig import Excitation
from vgvt.simulation import simulated_campaign
from vgvt.simulation.command import drive_commands, peak_command_v, sample_times_s

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
