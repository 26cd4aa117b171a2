"""Points of a beam between the links of its chain: nearer to the beam than the links that they ride on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

from vgvt.effects.beams import with_beams
from vgvt.reconcile.mechanics.refinement import meshed, to_continuum
from vgvt.reconcile.question.problem import _fine_enough
from vgvt.reconcile.question.uncertain import prepared
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation.assembly import Plan
from vgvt.simulation.attached import carried_rows
from vgvt.simulation.reduced import Layouts, Structure, structure

# At places that are no edges of cells, on and off the axis, and one at a tip.
PLACES_M = (
    (-0.1, 0.215, 0.0),
    (0.1, 0.407, 0.0),
    (0.08, -0.613, 0.0),
    (0.0, 0.79, 0.0),
    (-0.1, -0.985, 0.0),
    (0.1, 1.0, 0.0),
)


@pytest.fixture(scope="module")
def beam() -> Scenario:
    """The teaching beam with sensors and drive anywhere."""
    scenario = load_scenario("teaching-beam")
    grid = scenario.accelerometers.grid.model_copy(
        update={
            "node": tuple(range(1, len(PLACES_M) + 1)),
            "x_m": tuple(p[0] for p in PLACES_M),
            "y_m": tuple(p[1] for p in PLACES_M),
        }
    )
    return scenario.model_copy(
        update={
            "accelerometers": scenario.accelerometers.model_copy(update={"grid": grid}),
            "acquisition": scenario.acquisition.model_copy(update={"runs": (tuple(range(1, len(PLACES_M) + 1)),)}),
            "shaker": driven_at(scenario, 0.79).shaker,
        }
    )


def cut(scenario: Scenario, cells: int) -> Layouts:
    names = [b.name for b in scenario.airframe.beam]
    return Layouts.of(prepared(with_beams(scenario, names, lambda b: b.model_copy(update={"cells": cells}))))


def driven_at(scenario: Scenario, y_m: float) -> Scenario:
    """The same with the shaker farther in or out."""
    return scenario.model_copy(update={"shaker": scenario.shaker.model_copy(update={"position_m": (0.08, y_m, 0.0)})})


def shapes(found: Structure, rows: np.ndarray, count: int) -> np.ndarray:
    """What rows see (modes, rows) of the first modes, each with its largest value 1."""
    _, vectors = scipy.linalg.eigh((found.stiffness + found.stiffness.T) / 2, (found.mass + found.mass.T) / 2)
    seen = (rows @ vectors[:, :count]).T
    return seen / np.take_along_axis(seen, np.abs(seen).argmax(axis=1)[:, None], 1)


def between_links(layout: Plan) -> tuple[Structure, np.ndarray]:
    found = structure(layout, layout.grid)
    return found, np.vstack([found.axis, found.drive])


def riding(layouts: Layouts) -> tuple[Structure, np.ndarray]:
    """Sensors where their links are, and the drive under an edge of a cell."""
    found = structure(layouts.first, [replace(p, seats=()) for p in layouts.first.grid])
    return found, np.vstack([found.axis, found.drive])


def test_shapes_of_few_cells_are_those_of_many(beam: Scenario) -> None:
    """Of 24 cells against 192, eight elastic modes: by a fifth of what riding on a link errs, at most."""
    modes = slice(6, 14)
    exact = shapes(*between_links(cut(beam, 192).first), modes.stop)[modes]
    coarse = cut(beam, 24)
    between = np.abs(shapes(*between_links(coarse.first), modes.stop)[modes] - exact).max()
    rides = np.abs(shapes(*riding(coarse), modes.stop)[modes] - exact).max()
    assert rides > 0.02
    assert between < 0.2 * rides


def test_a_point_of_the_axis_lies_on_the_parabola_between_two_links(beam: Scenario) -> None:
    """Of twelve cells, in the first bending: as smooth as a beam, where links have their bends at hinges alone."""
    along = tuple(float(y) for y in np.arange(0.2, 0.81, 0.02))
    nodes = tuple(range(1, len(along) + 1))
    grid = beam.accelerometers.grid.model_copy(update={"node": nodes, "x_m": (0.0,) * len(along), "y_m": along})
    on_the_axis = beam.model_copy(
        update={
            "accelerometers": beam.accelerometers.model_copy(update={"grid": grid}),
            "acquisition": beam.acquisition.model_copy(update={"runs": (nodes,)}),
        }
    )
    layouts = cut(on_the_axis, 12)
    bends = [np.abs(np.diff(shapes(*found, 7)[6, :-1], 2)) for found in (between_links(layouts.first), riding(layouts))]
    assert bends[0].max() < 2.5 * bends[0].mean()
    assert bends[1].max() > 3.5 * bends[1].mean()


@pytest.mark.parametrize("cells", [12, 24, 59])
def test_a_shaker_pushes_the_beam_and_not_a_link_beside_it(beam: Scenario, cells: int) -> None:
    layout = cut(beam, cells).first
    found, rows = between_links(layout)
    assert len(layout.parts.shares(layout.drive.part, layout.drive.position_m)) == 1
    np.testing.assert_allclose(found.drive, rows[-1], atol=1e-9)


def test_a_fit_that_moves_the_drive_does_not_cut_the_beam_anew(beam: Scenario) -> None:
    """Nor one that asks for other cells, or roots with joints: what it differs by is to be the drive's place alone."""
    layouts = cut(beam, 24)
    stated = layouts.first.scenario
    moved = driven_at(stated, 0.78)
    names = [b.name for b in moved.airframe.beam]
    softer = with_beams(moved, names, lambda b: b.model_copy(update={"root_bending_stiffness_n_m_per_rad": 1e4}))
    heavier = moved.airframe.body.model_copy(update={"mass_kg": 1.01 * moved.airframe.body.mass_kg})
    edited = moved.model_copy(update={"airframe": moved.airframe.model_copy(update={"body": heavier})})
    for scenario in (moved, softer, edited):
        parts = layouts.plan(scenario).parts
        assert parts.pushed == layouts.first.parts.pushed
        for name, chain in parts.chains.items():
            stations = [link.twist_arc_m for link in chain.links if link.twist_arc_m > 0]
            assert stations == [link.twist_arc_m for link in layouts.first.parts.chains[name].links]


@pytest.mark.parametrize("y_m", [0.775, 0.78, 0.8])
def test_a_drive_that_a_fit_moves_goes_along_the_beam(beam: Scenario, y_m: float) -> None:
    """Not on the link that it had its place on, which twists as a whole: by a fifth of what that errs, at most."""
    modes, layouts = slice(6, 14), cut(beam, 24)
    exact = shapes(*between_links(cut(driven_at(beam, y_m), 192).first), modes.stop)[modes]
    layout = layouts.plan(driven_at(layouts.first.scenario, y_m))
    found, rows = between_links(layout)
    moved = np.abs(shapes(found, rows, modes.stop)[modes] - exact)[:, -1].max()
    link, _ = carried_rows(found, layout, layout.drive.carrier, layout.drive.position_m)
    rows[-1] = link[2]
    assert moved < 0.2 * np.abs(shapes(found, rows, modes.stop)[modes] - exact)[:, -1].max()


def test_the_error_falls_with_the_square_of_the_links(beam: Scenario) -> None:
    """Four times as many cells leave a sixteenth or so; a point that rides on a link has a quarter left."""
    modes = slice(6, 12)
    exact = shapes(*between_links(cut(beam, 192).first), modes.stop)[modes]
    left = [np.abs(shapes(*between_links(cut(beam, n).first), modes.stop)[modes] - exact).max() for n in (12, 48)]
    assert left[1] < left[0] / 10


def test_a_point_of_the_body_rides_on_it(beam: Scenario) -> None:
    hati = load_scenario("hati-unsymmetric")
    layouts = cut(hati, 12)
    (_, between), (_, rides) = between_links(layouts.first), riding(layouts)
    on_the_body = [k for k, p in enumerate((*layouts.first.grid, layouts.first.drive)) if p.part == "body"]
    assert on_the_body
    np.testing.assert_allclose(between[on_the_body], rides[on_the_body], atol=1e-12)
    assert np.abs(between - rides).max() > 1e-3


@pytest.mark.parametrize(("cells", "without"), [(12, 0.01), (24, 0.004), (59, 0.0005)])
def test_a_chain_that_is_made_up_for_foretells_one_of_many_cells(beam: Scenario, cells: int, without: float) -> None:
    """The rows of the first elastic modes with what is added are those of a beam of 192 cells."""
    layouts = cut(beam, cells)
    own = structure(layouts.first, layouts.first.grid)
    rows = np.vstack([own.axis, own.drive])
    change = to_continuum(layouts.first.scenario, layouts, own, 120.0)
    fine, exact = between_links(cut(beam, 192).first)
    modes = slice(6, 12)
    wanted = shapes(fine, exact, modes.stop)[modes]
    better = shapes(own, rows + np.vstack([change.axis, change.drive]), modes.stop)[modes]
    off = [np.abs(found - wanted).max() for found in (better, shapes(own, rows, modes.stop)[modes])]
    assert off[0] < without < off[1]


def test_an_aircraft_whose_modes_its_cells_mix_gets_more_of_them() -> None:
    """The BFF's items sit between its cells: a mode at one and a half times the band is five per cent off."""
    bff = load_scenario("bff")
    limit_hz = 3 * bff.excitation.band_hz[1]
    assert [b.cells for b in _fine_enough(bff, limit_hz).airframe.beam] == [
        2 * b.cells for b in meshed(bff).airframe.beam
    ]
    for name in ("hati-unsymmetric", "garteur-sm-ag19", "teaching-beam"):
        scenario = load_scenario(name)
        assert _fine_enough(scenario, 3 * scenario.excitation.band_hz[1]) == meshed(scenario)
