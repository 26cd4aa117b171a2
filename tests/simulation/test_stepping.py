"""The time step: modes that records show differ from the continuous ones by less than anyone could measure."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
import scipy.linalg
from small_rig import revised

from vgvt.data import InputError
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation import simulate
from vgvt.simulation.assembly import bare_rig, driven_rig, plan
from vgvt.simulation.linear import linearise
from vgvt.simulation.modes import eigenpairs
from vgvt.simulation.state_space import state_space
from vgvt.simulation.stepping import amplification, stepped_poles, substeps


@pytest.mark.parametrize("name", ["hati-unsymmetric", "hati-symmetric", "skoll-gvt1", "quick"])
def test_stepped_modes_below_40_hz(name: str) -> None:
    """0.01 % in frequency and 1 % in damping ratio, for the driven rig, coil and shaker included."""
    scenario = load_scenario(name)
    layout = plan(scenario)
    poles = np.linalg.eigvals(state_space(layout, driven_rig(layout, 0), layout.points).state_matrix)
    step = 1 / substeps(poles, scenario.acquisition.sample_rate_hz, scenario.simulation.step_s)
    step /= scenario.acquisition.sample_rate_hz
    low = poles[(poles.imag > 0) & (np.abs(poles) < 2 * np.pi * 40)]
    assert low.size > 8
    stepped = stepped_poles(low, step)
    assert np.abs(np.abs(stepped) / np.abs(low) - 1).max() < 1e-4
    ratio, wanted = -stepped.real / np.abs(stepped), -low.real / np.abs(low)
    assert np.abs(ratio / wanted - 1).max() < 0.01
    assert np.abs(np.exp(stepped_poles(poles, step) * step)).max() <= 1.0


def test_no_damping_ratio_makes_the_step_unstable() -> None:
    """Whatever the damping of the fastest mode, the chosen step lets nothing grow."""
    for ratio in np.linspace(0.0, 1.0, 41):
        pole = 20000.0 * np.array([-ratio + 1j * np.sqrt(1 - ratio**2)])
        count = substeps(pole, 1000.0, 1e-3)
        assert np.abs(amplification(pole, 1e-3 / count)).max() <= 1 + 1e-9
        assert count <= 8


def test_a_model_too_fast_to_step_is_refused() -> None:
    with pytest.raises(InputError, match=r"needs more than 64 time steps.*\n.*fewer cells"):
        substeps(np.array([-1e6 + 1e7j]), 1000.0, 2.5e-4)


def test_divergence_is_seen(small: Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A drive that throws the aircraft about ends in an error, not in a record, and leaves no log file behind."""
    monkeypatch.chdir(tmp_path)
    thrown = revised(small, excitation={"amplitude_v": 1e6}, generator={"range_v": None})
    with pytest.raises(FloatingPointError, match="diverged before"):
        simulate(thrown, engine="mujoco")
    assert list(tmp_path.iterdir()) == []


def test_fine_chains_stay_affordable(small: Scenario) -> None:
    """Twice the cells need about four times the steps, since the highest mode is never overdamped."""
    counts = []
    for cells in (10, 20):
        wing = small.airframe.beam[0].model_copy(update={"cells": cells})
        layout = plan(small.model_copy(update={"airframe": small.airframe.model_copy(update={"beam": (wing,)})}))
        poles = np.linalg.eigvals(state_space(layout, driven_rig(layout, 0), layout.points).state_matrix)
        counts.append(substeps(poles, 1000.0, 1e-3))
    assert counts[1] <= 5 * counts[0]


def ring_down(scenario: Scenario, mode: int, step_s: float, duration_s: float) -> tuple[complex, complex]:
    """The pole of a bare elastic mode, continuous and as fitted to MuJoCo's free decay."""
    layout = plan(scenario)
    rig = bare_rig(layout)
    linear = linearise(rig.model, rig.qpos)
    poles, vectors = eigenpairs(linear)
    rig.model.opt.timestep = step_s
    data = mujoco.MjData(rig.model)
    shape = (vectors[:, mode] / vectors[np.argmax(np.abs(vectors[:, mode])), mode]).real
    data.qpos[:] = 1e-4 * shape
    read = linear.mass @ shape / (shape @ linear.mass @ shape)
    amplitude = np.empty(round(duration_s / step_s))
    for k in range(amplitude.size):
        amplitude[k] = read @ data.qpos
        mujoco.mj_step(rig.model, data)
    # A decaying sine obeys x[k+1] = 2 Re(z) x[k] - |z|² x[k-1]: two unknowns, least squares.
    stride = max(1, round(0.1 * 2 * np.pi / abs(poles[mode]) / step_s))
    x = amplitude[::stride]
    twice_real, minus_square = np.linalg.lstsq(np.column_stack([x[1:-1], x[:-2]]), x[2:], rcond=None)[0]
    z = twice_real / 2 + 1j * np.sqrt(-minus_square - twice_real**2 / 4)
    return complex(poles[mode]), complex(np.log(z) / (stride * step_s))


@pytest.mark.parametrize("mode", [0, 1, 2])
def test_energy_decays_as_specified(small: Scenario, mode: int) -> None:
    """Free decay in MuJoCo has the frequency of the mode and the damping ratio that the scenario asks for."""
    pole, fitted = ring_down(small, mode, 2.5e-4, 1.0)
    assert abs(fitted) == pytest.approx(abs(pole), rel=1e-4)
    asked = small.airframe.damping.modal[mode]
    assert -pole.real / abs(pole) == pytest.approx(asked, rel=1e-6)
    assert -fitted.real / abs(fitted) == pytest.approx(asked, rel=0.01)


def test_fitted_decay_tells_another_damping(small: Scenario) -> None:
    """The fit above can fail: twice the damping in the model is twice the damping in the decay."""
    damping = small.airframe.damping.model_copy(update={"modal": (0.02,)})
    doubled = small.model_copy(update={"airframe": small.airframe.model_copy(update={"damping": damping})})
    _, fitted = ring_down(doubled, 0, 2.5e-4, 1.0)
    assert -fitted.real / abs(fitted) == pytest.approx(0.02, rel=0.01)


def test_energy_is_conserved_without_damping(small: Scenario) -> None:
    """A free airframe without damping, bent and let go, keeps its energy to 1e-6 over a second."""
    layout = plan(small)
    model = bare_rig(layout).model
    model.dof_damping[:] = 0.0
    model.tendon_damping[:] = 0.0
    model.opt.timestep = 2.5e-4
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data = mujoco.MjData(model)
    linear = linearise(model, data.qpos.copy())
    shapes = scipy.linalg.eigh(linear.stiffness, linear.mass)[1]
    data.qpos[:] = shapes[:, 6:9] @ [0.05, 0.03, 0.01]
    data.qvel[:6] = 0.1
    mujoco.mj_forward(model, data)
    start = data.energy.sum()
    for _ in range(4000):
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    assert start > 0.1
    # Large rotations pass a little energy to the links' highest frequencies, where the integrator loses it.
    assert data.energy.sum() == pytest.approx(start, rel=1e-5)
