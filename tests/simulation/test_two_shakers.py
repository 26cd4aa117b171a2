"""Two shakers at once: independent commands, two references, and the matrix of responses they measure."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError
from small_rig import revised

from vgvt.data import ChannelRole
from vgvt.scenario import Scenario
from vgvt.signals import estimate_frf
from vgvt.simulation import simulated_campaign, truth_of
from vgvt.simulation.assembly import driven_rig, plans
from vgvt.simulation.command import drive_commands, sample_times_s
from vgvt.simulation.state_space import state_space

RANDOM: dict[str, object] = {"kind": "burst-random", "blocks": 2, "burst_fraction": 0.5, "taper_s": 0.05}


def paired(small: Scenario, repeats: int = 1, **excitation: object) -> Scenario:
    """The small rig with a second shaker on the axis, and quicker modes so that short records suffice."""
    second = small.shaker.model_copy(update={"node": 101, "position_m": (0.7112, 0.0, 0.0)})
    rig = revised(small, acquisition={"repeats": repeats}, excitation={"ring_down_s": 0.0, **excitation})
    return rig.model_copy(update={"further_shaker": (second,)})


def model_frf(scenario: Scenario, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Accelerations over forces, (points, forces, lines): both responses to both volts, solved for the forces."""
    layout = plans(scenario)[0]
    model = state_space(layout, driven_rig(layout, 0), layout.run_points(0))
    identity = np.eye(model.state_matrix.shape[0])
    both = []
    for f in frequency_hz:
        states = np.linalg.solve(2j * np.pi * f * identity - model.state_matrix, model.inputs)
        outputs = model.output_matrix @ states + model.feedthrough_rows
        both.append(outputs[:-2] @ np.linalg.inv(outputs[-2:]))
    return np.moveaxis(np.array(both), 0, -1)


def test_both_engines_shake_at_both_points(small: Scenario) -> None:
    scenario = paired(small, duration_s=4.0, start_hz=3.0, **RANDOM)
    stepped, solved = (simulated_campaign(scenario, engine=engine).runs[0] for engine in ("mujoco", "linear"))
    assert [c.name for c in solved.channels][:4] == ["drive", "drive 101", "force", "force 101"]
    np.testing.assert_array_equal(stepped.samples[:2], solved.samples[:2])
    assert abs(np.corrcoef(solved.samples[:2])[0, 1]) < 0.3
    for got, wanted in zip(stepped.samples[2:], solved.samples[2:], strict=True):
        assert np.linalg.norm(got - wanted) < 0.01 * np.linalg.norm(wanted)


@pytest.mark.parametrize("signals", ["orthogonal", "sequential"])
def test_two_repeats_of_a_sweep_measure_the_matrix(small: Scenario, signals: str) -> None:
    """Solved line by line from two records that ring out: the linear model's own accelerance matrix."""
    scenario = paired(small, 2, shakers=signals, duration_s=10.0, ring_down_s=50.0, lead_in_s=0.5)
    campaign = simulated_campaign(scenario, engine="linear")
    first, second = (drive_commands(scenario, run, sample_times_s(scenario)) for run in (0, 1))
    # Orthogonal over the two repeats, whatever the signal.
    assert abs((first[0] * first[1] + second[0] * second[1]).sum()) < 1e-9 * (first**2 + second**2).sum()
    frf = estimate_frf(campaign, "ratio", band_hz=(4.0, 34.0))
    few = np.arange(0, frf.frequency_hz.size, 40)
    wanted = model_frf(scenario, frf.frequency_hz[few])
    scale = np.sqrt((np.abs(wanted) ** 2).mean(axis=2, keepdims=True))
    assert frf.values.shape[1] == 2
    assert np.abs((frf.values[:, :, few] - wanted) / scale).max() < 5e-3


def test_h1_of_independent_bursts_measures_the_matrix(small: Scenario) -> None:
    """Each block rings out in its silence but for the slow pendulums: what is left is leakage below one per cent."""
    burst = {**RANDOM, "blocks": 8, "burst_fraction": 0.25, "shakers": "uncorrelated"}
    scenario = paired(small, duration_s=240.0, start_hz=3.0, stop_hz=36.0, **burst)
    campaign = simulated_campaign(scenario, engine="linear")
    frf = estimate_frf(campaign, "h1", segment_s=30.0, window="boxcar", overlap=0.0, band_hz=(4.0, 34.0))
    few = np.arange(0, frf.frequency_hz.size, 20)
    wanted = model_frf(scenario, frf.frequency_hz[few])
    scale = np.sqrt((np.abs(wanted) ** 2).mean(axis=2, keepdims=True))
    assert np.median(np.abs((frf.values[:, :, few] - wanted) / scale)) < 0.01
    assert frf.coherence is not None
    assert np.median(frf.coherence) > 0.999


def test_truth_and_campaign_know_both_references(small: Scenario) -> None:
    scenario = paired(small, duration_s=4.0, **RANDOM)
    truth = truth_of(scenario)
    assert [str(d) for d in truth.as_tested[0].references] == ["100+Z", "101+Z"]
    campaign = simulated_campaign(scenario, engine="linear")
    assert [str(d) for d in campaign.reference_dofs] == ["100+Z", "101+Z"]
    assert len(campaign.runs[0].select(ChannelRole.DRIVE)[0]) == 2


def test_several_shaker_tables_are_the_same_scenario(small: Scenario) -> None:
    scenario = paired(small, **RANDOM)
    tables = scenario.model_dump()
    tables["shaker"] = [tables["shaker"], *tables.pop("further_shaker")]
    assert Scenario.model_validate(tables) == scenario


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"excitation": {"kind": "linear-chirp"}}, "copies of one linear-chirp"),
        ({"excitation": {"kind": "linear-chirp", "shakers": "sequential"}}, "not a multiple of the 2 shakers"),
        ({"further_shaker": ()}, "there is one"),
        ({"node": 100}, "is taken"),
    ],
)
def test_shakers_that_cannot_be_told_apart_are_refused(small: Scenario, changes: dict[str, object], words: str) -> None:
    tables = paired(small, **RANDOM, shakers="uncorrelated").model_dump()
    if "excitation" in changes:
        tables["excitation"] |= {"blocks": None, "burst_fraction": None, "shakers": None, **changes["excitation"]}
    elif "node" in changes:
        tables["further_shaker"][0]["node"] = changes["node"]
    else:
        tables |= changes
    with pytest.raises(ValidationError, match=words):
        Scenario.model_validate(tables)
