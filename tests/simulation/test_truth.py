"""The truth is what a perfect identification would find: residues give the response, bounds are reached."""

from __future__ import annotations

import numpy as np
import pytest
from small_rig import revised

from vgvt.data import synthesise
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import simulate, simulated_campaign, truth_of
from vgvt.simulation.assembly import driven_rig, plan, plans
from vgvt.simulation.state_space import state_space
from vgvt.simulation.truth import assemble_truth
from vgvt_scoreboard import merge_truth, reachable


def measured_accelerance(scenario: Scenario, frequency_hz: np.ndarray) -> np.ndarray:
    """A/F as the driven rig's sensors would show it without noise, (points, lines)."""
    layout = plan(scenario)
    model = state_space(layout, driven_rig(layout, 0), layout.points)
    identity = np.eye(model.input_matrix.size)
    states = [np.linalg.solve(2j * np.pi * f * identity - model.state_matrix, model.input_matrix) for f in frequency_hz]
    outputs = model.output_matrix @ np.array(states).T + model.feedthrough[:, None]
    return np.asarray(outputs[:-1] / outputs[-1])


def test_residues_synthesise_the_noise_free_response(small: Scenario) -> None:
    """From 3 to 35 Hz, within 1 % of the sigma plot everywhere: nothing that matters is left out of the truth."""
    frequency = np.linspace(3, 35, 300)
    wanted = measured_accelerance(small, frequency)
    got = synthesise(truth_of(small).as_tested[0], frequency).values[:, 0]
    error = np.linalg.norm(got - wanted, axis=0) / np.linalg.norm(wanted, axis=0)
    assert error.max() < 0.01
    assert np.median(error) < 0.002


@pytest.mark.parametrize("name", ["quick", pytest.param("garteur-sm-ag19", marks=pytest.mark.slow)])
def test_true_poles_are_those_of_acceleration_over_force(name: str) -> None:
    """They are where the force vanishes though the rig moves: the zeros of force over command."""
    layout = plans(load_scenario(name))[0]
    model = state_space(layout, driven_rig(layout, 0), layout.points)
    identity, force = np.eye(model.state_matrix.shape[0]), model.output_matrix[-1]
    modes = assemble_truth([layout], [model]).as_tested[0]

    def beside_a_zero(pole: complex) -> float:
        """Newton's step to the nearest zero: of all zeros at once rounding, at a few of 2e5 rad/s, leaves 1e-5."""
        shifted = pole * identity - model.state_matrix
        state = np.linalg.solve(shifted, model.inputs[:, 0])
        slope = -force @ np.linalg.solve(shifted, state)
        return float(abs((force @ state + model.feedthrough_rows[-1, 0]) / slope / pole))

    assert max(map(beside_a_zero, modes.band(3.0, 70.0).poles)) < 1e-7
    # Rigid modes: the stiffness is a difference quotient, and they have little of it.
    assert max(map(beside_a_zero, modes.band(0.05, 3.0).poles)) < 2e-4


@pytest.mark.parametrize("engine", ["linear", "mujoco"])
def test_records_alone_are_those_that_come_with_the_truth(small: Scenario, engine: str) -> None:
    short = revised(small, excitation={"duration_s": 0.3, "taper_s": 0.1, "ring_down_s": 0.0})
    with_truth, alone = simulate(short, engine=engine).campaign, simulated_campaign(short, engine=engine)
    assert (alone.name, alone.notes, alone.band_hz) == (with_truth.name, with_truth.notes, with_truth.band_hz)
    for one, other in zip(alone.runs, with_truth.runs, strict=True):
        assert one.channels == other.channels
        np.testing.assert_array_equal(one.samples, other.samples)
    with pytest.raises(ValueError, match="engine must be"):
        simulated_campaign(small, engine="finite elements")


def test_in_plane_sensors_are_scored_by_what_they_feel(small: Scenario) -> None:
    """A sensor along y feels gravity as it tilts; the true shape says so, and the response agrees at resonance."""
    grid = small.accelerometers.grid.model_copy(update={"direction": ("+Y",) * len(small.accelerometers.grid.node)})
    sideways = revised(small, accelerometers={"grid": grid})
    modes = truth_of(sideways).as_tested[0].band(5.0, 10.0)
    peak = measured_accelerance(sideways, modes.natural_frequency_hz[:1])[:-1, 0]
    shape = modes.shapes[0, :-1]
    assurance = np.abs(np.vdot(peak, shape)) ** 2 / (np.vdot(peak, peak).real * np.vdot(shape, shape).real)
    assert assurance > 0.98


def test_every_run_knows_the_same_modes() -> None:
    """No slow rigid motion comes and goes between runs."""
    counts = {len(run.band(0.0, 60.0)) for run in truth_of(load_scenario("skoll-gvt1")).as_tested}
    assert len(counts) == 1


def test_bounds_follow_the_square_root_laws(small: Scenario) -> None:
    """Twice the force halves the standard deviation; half the band at equal length gains the root of two."""
    noisy = revised(small, acquisition={"noise_v_per_rthz": 1e-4})

    def bound(**excitation: object) -> float:
        changed = revised(noisy, excitation={"taper_s": 0.0, "ring_down_s": 0.0, "duration_s": 60.0, **excitation})
        return float(truth_of(changed).as_tested[0].band(12.0, 20.0).natural_frequency_std_hz[0])

    wide = bound(start_hz=1.0, stop_hz=37.0)
    assert bound(start_hz=1.0, stop_hz=37.0, amplitude_v=0.1) == pytest.approx(wide / 2, rel=0.01)
    assert bound(start_hz=7.0, stop_hz=25.0) == pytest.approx(wide / np.sqrt(2), rel=0.05)


def test_a_shaker_on_the_axis_leaves_antisymmetric_modes_worse_known() -> None:
    """The information about an antisymmetric mode falls by more than a hundred when the shaker moves onto the axis."""
    off, on = (merge_truth(truth_of(load_scenario(n))).model for n in ("hati-unsymmetric", "hati-symmetric"))
    first = [next(i for i, label in enumerate(m.labels) if label == "1st antisymmetric bending") for m in (off, on)]
    assert on.natural_frequency_std_hz[first[1]] > 10 * off.natural_frequency_std_hz[first[0]]
    assert reachable(off)[first[0]]
