"""A force gauge the wrong way round: all of the aircraft still heaves the same way, and the drive point tells."""

from __future__ import annotations

import numpy as np
import pytest
from effect_rig import AFT, FORE, OFFSET, TIP, WING, effect_rig, having
from numpy.typing import NDArray
from small_rig import band_spectra, revised

from vgvt.scenario import Scenario
from vgvt.simulation import simulated_campaign, truth_of


@pytest.fixture(scope="module")
def rig() -> Scenario:
    """The rig to try effects on, its first sensor beside the drive point."""
    return revised(effect_rig(), acquisition={"runs": ((OFFSET, WING, TIP, FORE, AFT),)})


def accelerance(scenario: Scenario, low_hz: float, high_hz: float) -> NDArray[np.complex128]:
    """A/F (sensors, lines) in a band, the sensor beside the drive point first."""
    spectra = band_spectra(simulated_campaign(scenario, engine="linear").runs[0], low_hz, high_hz)
    return np.asarray(spectra[2:] / spectra[1])


@pytest.mark.parametrize("channels", ["", "force", "response", f"{TIP}+Z"])
def test_the_drive_point_tells_a_reversed_force_and_heave_does_not(rig: Scenario, channels: str) -> None:
    """Between heave and the first elastic mode a free mass moves: A/F of all sensors is real and has one sign."""
    modes = truth_of(rig).as_tested[0].natural_frequency_hz
    heave, bending = modes[modes < 2.0].max(), modes[modes > 2.0].min()
    rigid = accelerance(having(rig, "sign-flip", channels=channels), 3 * heave, 0.4 * bending)
    assert rigid.shape[1] > 10
    assert np.abs(rigid.imag).max() < 0.05 * np.abs(rigid.real).min()
    alike = (np.sign(rigid.real) == np.sign(rigid.real[:1])).all()
    assert alike == (channels != f"{TIP}+Z")
    assert (rigid[0].real > 0).all() == (channels not in ("force", "response"))


def test_the_shaker_gives_power_at_the_drive_point_unless_the_force_is_reversed(rig: Scenario) -> None:
    """The imaginary part of A/F there, over the frequency, is the mobility's real part, which nothing passive turns."""
    right = accelerance(rig, 2.5, 34.0)[0]
    turned = accelerance(having(rig, "sign-flip", channels="force"), 2.5, 34.0)[0]
    assert (right.imag > 0).all() and (turned.imag < 0).all()


def test_a_reversed_force_is_all_responses_reversed(rig: Scenario) -> None:
    force, responses = (
        accelerance(having(rig, "sign-flip", channels=channels), 3.0, 34.0) for channels in ("force", "response")
    )
    np.testing.assert_allclose(force, responses, atol=1e-6 * np.abs(force).max())
