"""What the virtual test costs beside MuJoCo alone; off by default, run with `pytest tests/benchmarks --benchmark-only`.

The figures to quote are ratios within one run of this file, never seconds.
"""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import mujoco.rollout
import numpy as np
import pytest
import scipy.signal
from pytest_benchmark.fixture import BenchmarkFixture

from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import compiled_dampers, linear, simulate, simulated_campaign
from vgvt.simulation.assembly import Rig, driven_rig, plans
from vgvt.simulation.linear import joint_force, stiffness_matrix
from vgvt.simulation.mujoco_engine import step_runs
from vgvt.simulation.state_space import exciter_names, state_space
from vgvt.simulation.stepping import substeps


@pytest.fixture(scope="module")
def short_hati() -> Scenario:
    """All ten runs of the Hati campaign, two seconds each."""
    scenario = load_scenario("hati-unsymmetric")
    excitation = scenario.excitation.model_copy(update={"duration_s": 2.0})
    return scenario.model_copy(update={"excitation": excitation})


@pytest.mark.benchmark(group="hati, ten runs of two seconds")
def test_whole_simulation(benchmark: BenchmarkFixture, short_hati: Scenario) -> None:
    """Assembly, truth, time stepping and acquisition."""
    result = benchmark.pedantic(simulate, args=(short_hati,), kwargs={"engine": "mujoco"}, rounds=2)
    assert len(result.campaign.runs) == 10


@pytest.mark.benchmark(group="hati, records by the linear engine")
@pytest.mark.parametrize("made", [simulate, simulated_campaign])
def test_records_with_their_truth_and_alone(
    benchmark: BenchmarkFixture, short_hati: Scenario, made: Callable[..., object]
) -> None:
    """Who makes many campaigns and judges them by something else has no use for each one's modes."""
    assert benchmark.pedantic(made, args=(short_hati,), kwargs={"engine": "linear"}, rounds=2)


@pytest.fixture(scope="module")
def fine_rig() -> Rig:
    """The first run of Hati with 60 cells a wing."""
    hati = load_scenario("hati-unsymmetric")
    wing = hati.airframe.beam[0].model_copy(update={"cells": 60})
    airframe = hati.airframe.model_copy(update={"beam": (wing,)})
    return driven_rig(plans(hati.model_copy(update={"airframe": airframe}))[0], 0)


@pytest.mark.benchmark(group="hati, stiffness with 60 cells a wing")
@pytest.mark.parametrize("how", ["in closed form", "by differences"])
def test_stiffness(benchmark: BenchmarkFixture, monkeypatch: pytest.MonkeyPatch, fine_rig: Rig, how: str) -> None:
    """Differences without the dampers of modes, which do nothing at rest."""
    if how == "by differences":
        monkeypatch.setattr(linear, "tangent_stiffness", lambda model, data: None)
    data = mujoco.MjData(fine_rig.model)
    benchmark.pedantic(stiffness_matrix, args=(fine_rig.model, data, fine_rig.qpos), rounds=5, warmup_rounds=1)


@pytest.mark.benchmark(group="hati, stiffness with 60 cells a wing")
def test_stiffness_with_every_damper(benchmark: BenchmarkFixture, fine_rig: Rig) -> None:
    """As many forces as that takes, of the whole model."""
    data = mujoco.MjData(fine_rig.model)
    data.qpos[:] = fine_rig.qpos

    def forces() -> None:
        for _ in range(2 * fine_rig.model.nv):
            joint_force(fine_rig.model, data)

    benchmark.pedantic(forces, rounds=3)


@pytest.mark.benchmark(group="dampers of modes")
@pytest.mark.parametrize("worth_s", [pytest.param(0.0, id="compiled"), pytest.param(np.inf, id="tendons")])
@pytest.mark.parametrize("name", ["hati-unsymmetric", "bff", "skoll-gvt1"])
def test_stepped_with_the_dampers_of_modes(
    benchmark: BenchmarkFixture, monkeypatch: pytest.MonkeyPatch, name: str, worth_s: float
) -> None:
    """Records of half a second, the first run, compiled before."""
    monkeypatch.setattr(compiled_dampers, "_WORTH_S", worth_s)
    scenario = load_scenario(name)
    layouts = plans(scenario)[:1]
    rigs = [driven_rig(layout, run) for run, layout in enumerate(layouts)]
    poles = np.linalg.eigvals(state_space(layouts[0], rigs[0], layouts[0].points).state_matrix)
    rate = scenario.acquisition.sample_rate_hz
    count = substeps(poles, rate, scenario.simulation.step_s)
    rigs[0].model.opt.timestep = 1 / (rate * count)
    steps = round(0.5 * rate) * count + 1
    command = 0.1 * np.random.default_rng(0).standard_normal((len(exciter_names(layouts[0])), steps))
    benchmark.pedantic(step_runs, args=(layouts, rigs, [command], count, rate), rounds=2, warmup_rounds=1)


@pytest.mark.benchmark(group="hati, ten runs of two seconds")
def test_bare_rollout(benchmark: BenchmarkFixture, short_hati: Scenario) -> None:
    """`mujoco.rollout` of the same models for the same steps on as many threads, nothing else."""
    layouts = plans(short_hati)
    rigs = [driven_rig(layout, run) for run, layout in enumerate(layouts)]
    poles = np.linalg.eigvals(state_space(layouts[0], rigs[0], layouts[0].points).state_matrix)
    rate = short_hati.acquisition.sample_rate_hz
    count = substeps(poles, rate, short_hati.simulation.step_s)
    for rig in rigs:
        rig.model.opt.timestep = 1 / (rate * count)
    steps = round(short_hati.excitation.record_s * rate * count) + 1
    states = []
    for rig in rigs:
        data = mujoco.MjData(rig.model)
        data.qpos[:] = rig.qpos
        state = np.empty(mujoco.mj_stateSize(rig.model, mujoco.mjtState.mjSTATE_FULLPHYSICS.value))
        mujoco.mj_getState(rig.model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS.value)
        states.append(state)
    workers = [mujoco.MjData(rigs[0].model) for _ in range(2)]
    control = np.random.default_rng(0).standard_normal((1, steps, 1))
    _, sensors = benchmark.pedantic(
        mujoco.rollout.rollout, args=([r.model for r in rigs], workers, np.array(states), control), rounds=2
    )
    assert np.isfinite(sensors).all()


@pytest.mark.benchmark(group="hati, ten runs of two seconds")
def test_linear_engine(benchmark: BenchmarkFixture, short_hati: Scenario) -> None:
    """The same campaign by the linear engine."""
    result = benchmark.pedantic(simulate, args=(short_hati,), kwargs={"engine": "linear"}, rounds=2)
    assert len(result.campaign.runs) == 10


@pytest.mark.benchmark(group="hati, ten runs of a minute")
def test_linear_engine_on_the_whole_campaign(benchmark: BenchmarkFixture) -> None:
    """The campaign as it was flown, by the linear engine: assembly, truth, responses, acquisition."""
    result = benchmark.pedantic(
        simulate, args=(load_scenario("hati-unsymmetric"),), kwargs={"engine": "linear"}, rounds=3, warmup_rounds=1
    )
    assert len(result.campaign.runs) == 10


@pytest.mark.benchmark(group="hati, ten runs of a minute")
def test_filters_alone(benchmark: BenchmarkFixture) -> None:
    """What a recursion a mode would cost: `scipy.signal.lfilter` on every upper pole of every run, nothing else."""
    scenario = load_scenario("hati-unsymmetric")
    layout = plans(scenario)[0]
    poles = np.linalg.eigvals(state_space(layout, driven_rig(layout, 0), layout.points).state_matrix)
    growth = np.exp(poles[poles.imag >= 0] / scenario.acquisition.sample_rate_hz)
    forcing = np.ones(round(scenario.excitation.record_s * scenario.acquisition.sample_rate_hz), dtype=complex)

    def filters() -> None:
        for _ in range(10):
            for a in growth:
                scipy.signal.lfilter([1.0], [1.0, -a], forcing)

    benchmark.pedantic(filters, rounds=3)
