"""A channel that cannot be used is left out of what is fitted; its sensor stays on the aircraft, and in its place."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from reconciled_case import campaign_of, roving_scenario

from vgvt.data import Campaign
from vgvt.effects import available_effects
from vgvt.reconcile.fitting.calibration import calibrate
from vgvt.reconcile.next_test.procedures import changed, procedures
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.holdout import split
from vgvt.reconcile.question.problem import Problem, make_problem
from vgvt.reconcile.search.candidates import candidates

# A sensor of the second run that does not decide how its record ends, and more lines than there are: both take all.
RUN, CHANNEL, ALL_LINES = 1, 3, 10_000


def without(campaign: Campaign, *channels: int) -> Campaign:
    """The campaign with some responses of the second run, or all where none is said, that read nothing."""
    record = campaign.runs[RUN]
    samples = record.samples.copy()
    responses = [i for i, c in enumerate(record.channels) if c.role.value == "response"]
    samples[[responses[k] for k in channels] or responses] = 0.0
    return replace(campaign, runs=(*campaign.runs[:RUN], replace(record, samples=samples), *campaign.runs[RUN + 1 :]))


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> tuple[Problem, Problem]:
    """The same campaign whole, and with one channel dead."""
    scenario, cache = roving_scenario(), tmp_path_factory.mktemp("cache")
    campaign = campaign_of(scenario, 1)
    whole, dead = (
        make_problem(c, scenario, lines=ALL_LINES, cache=cache) for c in (campaign, without(campaign, CHANNEL))
    )
    return whole, dead


def test_the_sensor_stays_on_the_aircraft_and_the_others_in_their_places(pair: tuple[Problem, Problem]) -> None:
    """What the others of that run are foretold to read is what it is with every channel alive."""
    sound, dead = pair
    assert dead.measured.runs == sound.measured.runs
    assert dead.measured.channels == sound.measured.channels
    assert any("left out, dead" in remark for remark in dead.measured.remarks)
    assert dead.names == sound.names
    u, e = np.zeros(dead.size), np.zeros(0)
    foretold = [anchor(case, u, (), e, slopes=False).mechanical(u, e) for case in (dead, sound)]
    np.testing.assert_allclose(foretold[0], foretold[1], rtol=1e-9)


def test_nothing_is_asked_of_it(pair: tuple[Problem, Problem]) -> None:
    """Neither fitted nor held out; the others of its run have the data that they have beside a living one."""
    sound, dead = pair
    (lost,) = np.flatnonzero(~dead.measured.used)
    channel = dead.measured.channels[lost]
    assert (channel.run, channel.instrument) == (RUN, CHANNEL)
    parts = dead.split
    assert not parts.train[lost] and not parts.held[lost]
    assert (parts.train | parts.held)[dead.measured.used].all()
    kept = dead.measured.used
    np.testing.assert_array_equal(dead.measured.values[kept], sound.measured.values[kept])
    elsewhere = np.array([c.run != RUN for c in dead.measured.channels])
    np.testing.assert_array_equal(dead.measured.sigma[elsewhere], sound.measured.sigma[elsewhere])
    assert np.isinf(dead.measured.with_floor(0.02).sigma[lost]).all()


def test_a_run_of_which_nothing_can_be_used_is_still_a_run(tmp_path: Path) -> None:
    """What changes from run to run counts it: without it a step before the fourth run was one before the third."""
    scenario, re_hung = roving_scenario(), {"re-hang": available_effects()["re-hang"]}
    five = tuple(tuple(range(k, 21, 5)) for k in (1, 2, 3, 4, 5))
    scenario = scenario.model_copy(update={"acquisition": scenario.acquisition.model_copy(update={"runs": five})})
    campaign = campaign_of(scenario, 1)
    sound, lost = (make_problem(c, scenario, lines=ALL_LINES, cache=tmp_path) for c in (campaign, without(campaign)))
    assert lost.measured.runs == sound.measured.runs
    assert {h.settings["from_run"] for h in candidates(lost, re_hung)} == {2, 3, 4, 5}
    rest = np.array([c.run != RUN for c in sound.measured.channels])
    np.testing.assert_array_equal(lost.measured.used, rest)
    np.testing.assert_array_equal(lost.measured.values[rest], sound.measured.values[rest])
    assert RUN + 1 not in {h.run_number for h in lost.measured.harmonics}
    for turn in range(8):
        parts = split(scenario, lost.measured, turn)
        assert parts.held_runs.any() and parts.held_channels.any()
        assert not (parts.train | parts.held)[~rest].any()
    found = calibrate(make_problem(without(campaign), scenario, lines=100, cache=tmp_path))
    assert found.chi2_per_dof < 1.0


@pytest.mark.slow
def test_a_calibration_does_not_miss_it(tmp_path: Path) -> None:
    """Without its mass in the model the sensors' own had gone to eleven deviations, and χ² from 0.63 to 0.96."""
    scenario = roving_scenario()
    campaign = campaign_of(scenario, 1)
    found = [
        calibrate(make_problem(c, scenario, lines=100, cache=tmp_path)) for c in (campaign, without(campaign, CHANNEL))
    ]
    mass = found[0].problem.names.index("sensor mass")
    assert abs(found[1].u[mass] - found[0].u[mass]) < 1.0
    both = found[0].problem.split.train & found[1].problem.split.train
    sound, dead = (
        np.mean(np.abs((f.foretold - f.problem.measured.values) / f.problem.measured.sigma)[both] ** 2) for f in found
    )
    assert dead == pytest.approx(sound, rel=0.05)


def test_every_effect_and_every_further_test_can_do_without_it(pair: tuple[Problem, Problem]) -> None:
    _, dead = pair
    assert {h.settings.get("node") for h in candidates(dead)} >= set(dead.measured.runs[RUN])
    for procedure in procedures(dead):
        after = changed(dead, procedure).measured
        assert len(after.channels) == len(after.values) >= len(dead.measured.channels)


def test_a_harder_push_leaves_less_noise_in_the_responses(pair: tuple[Problem, Problem]) -> None:
    """The variance of A/F goes with the square of the force; what the model cannot do stays as it is."""
    _, case = pair
    averaged = next(p for p in procedures(case) if p.sweeps > 1)
    quarter = replace(averaged, sweeps=1, force=0.25)
    before, after = case.measured, changed(case, quarter).measured
    np.testing.assert_allclose(after.noise, 16 * before.noise)
    np.testing.assert_allclose(after.sigma**2 - after.noise, before.sigma**2 - before.noise, rtol=1e-6, atol=1e-20)
