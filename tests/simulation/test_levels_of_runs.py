"""Runs at several levels of force: what is driven, what is told of it, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.data import InputError
from vgvt.planning.planner import Order, plan_test
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import simulate, simulated_campaign
from vgvt.simulation.campaign import stepping_work
from vgvt.simulation.command import drive_commands, limited_drives, peak_command_v

LEVELS = (0.5, 2.0)


@pytest.fixture(scope="module")
def once() -> Scenario:
    """The bundled quick scenario with its run made twice, both at the level that is stated, without noise."""
    return changed(load_scenario("quick"), "acquisition", runs=((1, 2, 3),) * 2, noise_v_per_rthz=0.0, bits=32)


def changed(scenario: Scenario, table: str, **values: object) -> Scenario:
    tables = scenario.model_dump(exclude_none=True)
    tables["accelerometers"].pop("noise", None)
    tables["transducer"].pop("noise", None)
    return Scenario.model_validate(tables | {table: tables.get(table, {}) | values})


def test_what_a_linear_rig_answers_is_so_many_times_as_large(once: Scenario) -> None:
    """Commands, forces and accelerations of each run, and nothing else of the campaign."""
    plain = simulated_campaign(once, engine="linear")
    driven = simulated_campaign(changed(once, "acquisition", levels=LEVELS), engine="linear")
    for one, other, level in zip(plain.runs, driven.runs, LEVELS, strict=True):
        scale = np.abs(one.samples).max(axis=1, keepdims=True)
        assert (np.abs(other.samples - level * one.samples) < 1e-4 * level * scale).all()
    assert "at 0.5 to 2 times the amplitude" in driven.notes["excitation"]
    assert "times the amplitude" not in plain.notes["excitation"]


def changed_only(scenario: Scenario, table: str, **values: object) -> Scenario:
    """With the noise that there is."""
    return scenario.model_copy(update={table: getattr(scenario, table).model_copy(update=values)})


@pytest.mark.parametrize("kind", ["random", "linear-chirp"])
def test_levels_go_with_runs_repeats_and_all(once: Scenario, kind: str) -> None:
    scenario = changed(changed(once, "acquisition", levels=LEVELS, repeats=2), "excitation", kind=kind)
    assert [scenario.acquisition.level_in(run) for run in range(4)] == [0.5, 0.5, 2.0, 2.0]
    unit = changed(scenario, "acquisition", levels=(1.0, 1.0))
    times = np.linspace(0.0, 5.0, 400)
    for run, level in enumerate((0.5, 0.5, 2.0, 2.0)):
        assert drive_commands(scenario, run, times) == pytest.approx(level * drive_commands(unit, run, times))
    assert peak_command_v(scenario) == pytest.approx(2 * peak_command_v(unit), rel=0.2)
    assert scenario.acquisition.with_runs(((1,),)).levels is None


def test_a_hammer_hits_so_much_harder() -> None:
    scenario = load_scenario("teaching-beam-hammer")
    runs = len(scenario.acquisition.runs)
    harder = changed(scenario, "acquisition", levels=(3.0,) * runs)
    force = [np.abs(simulated_campaign(s, engine="linear").runs[0].samples[0]).max() for s in (scenario, harder)]
    assert force[1] == pytest.approx(3 * force[0], rel=0.02)


def test_a_quieter_run_tells_less() -> None:
    """The smallest deviations that noise allows are those of the force that there is: as if the amplitude were less."""
    loud = load_scenario("quick")
    quiet = loud.model_copy(update={"acquisition": loud.acquisition.with_runs(loud.acquisition.run_nodes, (0.25,))})
    turned_down = changed_only(loud, "excitation", amplitude_v=0.25 * loud.excitation.amplitude_v)
    least = [
        simulate(s, engine="linear").truth.as_tested[0].natural_frequency_std_hz for s in (loud, quiet, turned_down)
    ]
    known = np.isfinite(least[0])
    assert known.any() and (least[1][known] > 3 * least[0][known]).all()
    assert least[1][known] == pytest.approx(least[2][known])


def test_the_generator_gives_the_loudest_run_or_says_which_it_does_not(once: Scenario) -> None:
    limited = changed(once, "generator", range_v=1.5)
    with pytest.raises(ValueError, match=r"is 1, 2 times that in a run, but the generator gives 1\.5 V"):
        changed(limited, "acquisition", levels=LEVELS)
    noise = changed(changed(limited, "acquisition", levels=(0.1, 1.5)), "excitation", kind="random")
    assert limited_drives(noise, 0) == () and limited_drives(noise, 1) == (0,)


def test_a_level_is_given_for_every_run(once: Scenario) -> None:
    with pytest.raises(ValueError, match="has 1 entries but runs has 2"):
        changed(once, "acquisition", levels=(1.0,))
    with pytest.raises(ValueError, match="levels"):
        changed(once, "acquisition", levels=(1.0, 0.0))


def test_a_plan_is_for_one_level(once: Scenario) -> None:
    with pytest.raises(InputError, match=r"acquisition\.levels"):
        plan_test(changed(once, "acquisition", levels=LEVELS), Order(frozenset({"level"}), None))  # type: ignore[arg-type]


def test_what_stepping_takes_grows_with_the_record(once: Scenario) -> None:
    work = stepping_work(once)
    assert stepping_work(changed(once, "excitation", duration_s=32.0)) > 1.5 * work > 0
