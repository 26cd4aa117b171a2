"""A chain of many cells loses what one of few does: its joints may have less, and dampers of modes give the rest."""

from __future__ import annotations

import numpy as np
import pytest
from bare_poles import poles
from numpy.typing import NDArray

from vgvt.effects.beams import with_beams
from vgvt.scenario import load_scenario
from vgvt.scenario.airframe import Airframe
from vgvt.simulation.once import damping_once

# Times the limit: as far as modes are given what their joints lack.
NEAR = 3.0


def cut(name: str, cells: int) -> Airframe:
    """A bundled aircraft with so many cells in every beam."""
    scenario = load_scenario(name)
    beams = [b.name for b in scenario.airframe.beam]
    return with_beams(scenario, beams, lambda b: b.model_copy(update={"cells": cells})).airframe


def damped(airframe: Airframe) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies, Hz, and damping ratios of its elastic modes, from the dampers that are in the model."""
    swinging = poles(airframe)
    return np.abs(swinging) / (2 * np.pi), -swinging.real / np.abs(swinging)


@pytest.mark.parametrize("name", ["quick", "hati-unsymmetric", "teaching-beam"])
def test_modes_near_the_limit_lose_the_same_with_any_cells(name: str) -> None:
    """Up to three times the limit; the finer chain's joints alone would give a fifth of it, and less."""
    limit_hz = load_scenario(name).airframe.damping.limit_hz
    coarse_hz, coarse = damped(cut(name, 12))
    fine_hz, fine = damped(cut(name, 60))
    near = np.flatnonzero(fine_hz < 0.9 * NEAR * limit_hz)
    beyond = near[fine_hz[near] > limit_hz]
    assert beyond.size >= 3
    found = damping_once(cut(name, 60))
    assert found.per_stiffness_s < 0.2 * found.growth_s
    # Damping grows with frequency, which is not the same with other cells: by a few per cent in high torsion.
    np.testing.assert_allclose(fine[near] / fine_hz[near], coarse[near] / coarse_hz[near], rtol=0.02)


@pytest.mark.parametrize("cells", [12, 60])
def test_damping_above_the_limit_grows_with_frequency(cells: int) -> None:
    airframe = cut("quick", cells)
    stated, (hz, ratio) = airframe.damping, damped(airframe)
    above = (hz > stated.limit_hz) & (hz < NEAR * stated.limit_hz)
    # From the stated ratio at the limit, or from a little less, where a mode below it would have too much.
    least = min([stated.damping_ratio / stated.limit_hz, *(np.array(stated.modal) / hz[: len(stated.modal)])])
    np.testing.assert_allclose(ratio[above], least * hz[above], rtol=1e-6)


def test_the_highest_mode_of_a_fine_chain_still_swings() -> None:
    """It is damped by joints alone, so that an explicit step holds."""
    _, ratio = damped(cut("quick", 60))
    assert ratio.max() < 0.75


def test_ratios_beyond_the_limit_are_told_of_whatever_the_cells() -> None:
    """With what those modes have in place of them: the same with 60 cells as with 12."""
    told = []
    for cells in (12, 60):
        airframe = cut("quick", cells)
        given = airframe.damping.model_copy(update={"modal": (*airframe.damping.modal, 0.015, 0.015)})
        told.append(damping_once(airframe.model_copy(update={"damping": given})).without_effect(given))
    for said in told:
        assert said is not None
        assert "has 5 ratios, of which the last 2 go to no mode" in said
        assert "2.31 % at 46." in said
