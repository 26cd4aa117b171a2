"""The command of a run: every kind in both engines, noise of its own in every run."""

from __future__ import annotations

import numpy as np
import pytest
from small_rig import band_spectra, revised

from vgvt.scenario import Scenario
from vgvt.simulation import simulated_campaign
from vgvt.simulation.command import drive_command, sample_times_s

KINDS: dict[str, dict[str, object]] = {
    "logarithmic-chirp": {},
    "stepped-sine": {"points": 12, "settle_s": 0.1},
    "random": {},
    "burst-random": {"blocks": 2, "burst_fraction": 0.6},
    "multisine": {"blocks": 2, "lines": "odd", "crest_iterations": 5},
}


def excited(scenario: Scenario, kind: str) -> Scenario:
    """A short record, in which the response need not die out."""
    short = {"kind": kind, "start_hz": 3.0, "duration_s": 6.0, "ring_down_s": 2.0, "lead_in_s": 0.5} | KINDS[kind]
    return revised(scenario, excitation=short)


@pytest.mark.parametrize(
    "kind",
    [k if k in ("logarithmic-chirp", "burst-random") else pytest.param(k, marks=pytest.mark.slow) for k in KINDS],
)
def test_both_engines_take_every_kind(small: Scenario, kind: str) -> None:
    """Sample by sample: force and accelerations of the stepped model are those of the exact solution."""
    scenario = excited(small, kind)
    stepped, solved = (simulated_campaign(scenario, engine=engine).runs[0].samples for engine in ("mujoco", "linear"))
    np.testing.assert_array_equal(stepped[0], solved[0])
    for channel in (1, 2, 3):
        scale = np.sqrt((solved[channel] ** 2).mean())
        assert scale > 0
        assert np.sqrt(((stepped[channel] - solved[channel]) ** 2).mean()) < 0.01 * scale


@pytest.mark.parametrize("kind", ["random", "burst-random", "multisine"])
def test_runs_and_seeds_differ_and_come_back(small: Scenario, kind: str) -> None:
    scenario = excited(small, kind)
    times = sample_times_s(scenario)
    first, second = (drive_command(scenario, run, times) for run in (0, 1))
    other = drive_command(scenario.model_copy(update={"seed": 99}), 0, times)
    np.testing.assert_array_equal(first, drive_command(scenario, 0, times))
    for unlike in (second, other):
        assert abs(np.corrcoef(first, unlike)[0, 1]) < 0.4


def test_a_repeated_run_is_another_record_of_the_same_sensors(small: Scenario) -> None:
    scenario = revised(excited(small, "random"), acquisition={"repeats": 2})
    first, second = simulated_campaign(scenario, engine="linear").runs
    assert [c.name for c in first.channels] == [c.name for c in second.channels]
    assert (first.run, second.run) == (1, 2)
    assert np.abs(band_spectra(first)[0] - band_spectra(second)[0]).max() > 0
