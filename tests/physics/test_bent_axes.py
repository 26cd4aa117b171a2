"""Wings whose elastic axis bends converge to the finite elements in second order, wherever in the span it bends."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
from bent_beams import Array, bent_wings, chain_hz, exact_hz, with_cells

from vgvt.reconcile.mechanics.refinement import to_continuum
from vgvt.scenario import Airframe, load_scenario
from vgvt.scenario.cells import bent_within_a_cell
from vgvt.simulation.reduced import Layouts, Structure, structure

CRANKED = np.array([[0.0, 0.0, 0.0], [0.15, 0.5, 0.0], [0.5, 0.9, 0.25]])
"""A crank and a break of dihedral at 47 % of the length: in the middle of a cell for many numbers of cells."""
BLENDED = np.array([[0.0, 0.0, 0.0], [0.1, 0.9, 0.0], [0.12, 0.96, 0.02], [0.13, 1.0, 0.06], [0.16, 1.02, 0.15]])
"""Winglets that are blended in, on less than a cell for few cells."""
ENGINES = [{"name": "engine", "mass_kg": 0.2, "position_m": (0.2, 0.62, 0.03), "attached_to": "wing", "mirror": True}]


def quarter_circle(stations: int) -> Array:
    """Points along an arc in plan."""
    angle = np.linspace(0.0, np.pi / 2, stations)
    return np.stack([1 - np.cos(angle), np.sin(angle), np.zeros(stations)], axis=1)


def zigzag(bends: int) -> Array:
    """Points left and right of a straight line."""
    y = np.linspace(0.0, 1.0, bends + 2)
    return np.stack([0.02 * (np.arange(bends + 2) % 2), y, np.zeros(bends + 2)], axis=1)


@pytest.mark.parametrize(
    ("airframe", "cells", "most"),
    [
        pytest.param(bent_wings(CRANKED, 12), (12, 16, 24, 25, 36), 1.1, id="cranked"),
        pytest.param(
            bent_wings(CRANKED, 12, tip=0.5, in_plane=False, items=ENGINES), (12, 16, 25, 36), 1.2, id="tapered"
        ),
        pytest.param(bent_wings(BLENDED, 12), (8, 12, 24, 36), 1.4, id="blended-winglet"),
        # For 16 cells every second station is in the middle of a cell.
        pytest.param(bent_wings(quarter_circle(31), 12), (12, 16, 24, 32), 1.4, id="arc"),
    ],
)
def test_bent_wings_converge_in_second_order(airframe: Airframe, cells: tuple[int, ...], most: float) -> None:
    """The error times the square of the number of cells is ``most`` times as large for some numbers as for others."""
    exact = exact_hz(airframe)
    errors = [chain_hz(with_cells(airframe, n)) / exact - 1 for n in cells]
    constants = np.sqrt(np.mean(np.square(errors), axis=1)) * np.square(cells)
    assert constants.max() < most * constants.min(), f"{constants}"
    assert np.abs(errors[0]).max() < 0.03


def test_a_warning_says_how_many_cells_are_enough() -> None:
    """Twelve cells for 23 bends of 50 degrees are wrong by several per cent; with what is advised they are right."""
    airframe = bent_wings(zigzag(23), 12)
    exact = exact_hz(airframe)
    said = bent_within_a_cell(airframe.beam[0])
    assert said is not None
    assert "'wing' bends by" in said
    assert np.abs(chain_hz(airframe) / exact - 1).max() > 0.03
    advised = with_cells(airframe, int(said.split("write cells = ")[1].split(",")[0]))
    assert bent_within_a_cell(advised.beam[0]) is None
    assert np.abs(chain_hz(advised) / exact - 1).max() < 0.005


def test_the_loop_makes_up_for_coarse_cells_of_bent_wings() -> None:
    """Modal stiffness from a finer chain leaves less than a tenth of what twelve cells err by."""
    beam, airframe = load_scenario("teaching-beam"), bent_wings(CRANKED, 12)
    scenario = beam.model_copy(
        update={
            "airframe": airframe.model_copy(update={"damping": beam.airframe.damping}),
            "shaker": beam.shaker.model_copy(update={"position_m": (0.0, 0.0, 0.0), "attached_to": "body"}),
        }
    )
    layouts = Layouts.of(scenario)

    def hung(cells: int) -> Structure:
        finer = scenario.model_copy(update={"airframe": with_cells(scenario.airframe, cells)})
        layout = layouts.plan(finer)
        return structure(layout, layout.grid, None)

    own = hung(12)
    added = to_continuum(scenario, layouts, own, 60.0).stiffness
    fine = hung(96)
    exact = _elastic_hz(fine.stiffness, fine.mass)
    before, after = (_elastic_hz(k, own.mass) / exact - 1 for k in (own.stiffness, own.stiffness + added))
    assert np.abs(before).max() > 0.003
    assert np.abs(after).max() < 0.1 * np.abs(before).max()


def _elastic_hz(stiffness: Array, mass: Array) -> Array:
    squares = scipy.linalg.eigh((stiffness + stiffness.T) / 2, (mass + mass.T) / 2, eigvals_only=True)
    return np.asarray(np.sqrt(squares[6:16]) / (2 * np.pi))
