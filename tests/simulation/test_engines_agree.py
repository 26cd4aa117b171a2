"""The two engines answer alike: MuJoCo's time steps and the exact solution of the linearised model."""

from __future__ import annotations

import numpy as np
import pytest
from small_rig import band_spectra, revised

from vgvt.scenario import Scenario
from vgvt.simulation import simulated_campaign


def test_small_amplitude_frfs_agree_within_half_a_percent(small: Scenario) -> None:
    """3 to 35 Hz, magnitude and phase together, away from antiresonances."""
    stepped = band_spectra(simulated_campaign(small, engine="mujoco").runs[0])
    solved = band_spectra(simulated_campaign(small, engine="linear").runs[0])
    for response in (2, 3):
        wanted, got = solved[response] / solved[1], stepped[response] / stepped[1]
        clear = np.abs(wanted) > 0.05 * np.median(np.abs(wanted))
        assert clear.mean() > 0.9
        assert np.abs(got / wanted - 1)[clear].max() < 0.005


@pytest.mark.slow
@pytest.mark.parametrize("inductance_h", [6e-4, 1.2e-2])
def test_force_per_command_agrees(small: Scenario, inductance_h: float) -> None:
    """The shaker's own dynamics are in both engines: force over command, drop-outs and a long lag included."""
    small = revised(small, shaker={"coil_inductance_h": inductance_h})
    stepped = band_spectra(simulated_campaign(small, engine="mujoco").runs[0])
    solved = band_spectra(simulated_campaign(small, engine="linear").runs[0])
    assert np.abs(stepped[1] / stepped[0] * solved[0] / solved[1] - 1).max() < 0.01


def test_same_seed_same_campaign_other_seed_other_noise(small: Scenario) -> None:
    """Deterministic to the bit, and the seed only moves the noise."""
    noisy = small.model_copy(update={"acquisition": small.acquisition.model_copy(update={"noise_v_per_rthz": 1e-5})})
    first, again = (simulated_campaign(noisy, engine="linear").runs[0].samples for _ in range(2))
    other = simulated_campaign(noisy.model_copy(update={"seed": 7}), engine="linear").runs[0].samples
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
    assert np.abs(first - other).max() < 0.05


@pytest.mark.slow
def test_full_amplitude_is_nearly_linear(small: Scenario) -> None:
    """At the real test's amplitude geometry bends little: 2 % on the FRF, not nothing."""
    loud = small.model_copy(update={"excitation": small.excitation.model_copy(update={"amplitude_v": 1.0})})
    stepped = band_spectra(simulated_campaign(loud, engine="mujoco").runs[0])
    solved = band_spectra(simulated_campaign(loud, engine="linear").runs[0])
    wanted, got = solved[2] / solved[1], stepped[2] / stepped[1]
    clear = np.abs(wanted) > 0.05 * np.median(np.abs(wanted))
    assert 1e-7 < np.median(np.abs(got / wanted - 1)[clear]) < 0.02
