"""What points of a beam do, read off a chain of a few links, against beam elements that share no code with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from finite_element import Array, build, natural_modes

from vgvt.effects.beams import with_beams
from vgvt.reconcile.question.uncertain import prepared
from vgvt.scenario import Scenario, load_scenario
from vgvt.simulation.assembly import bare_rig, hung_rig, plan
from vgvt.simulation.linear import LinearModel, linearise
from vgvt.simulation.reduced import Layouts, Structure, structure
from vgvt.simulation.truth import bare_modes

ELEMENTS = 60
# Elastic ones, but for the first: the spring that beam elements lack moves its frequency by 1.5 %.
MODES = slice(7, 14)
# On no edge of a cell, off the axis on either side.
X_M, Y_M = (-0.1, 0.1, -0.1, 0.1, 0.1), (0.215, 0.407, -0.613, 0.79, -0.985)


def without_instruments(scenario: Scenario) -> Scenario:
    """What beam elements know: the airframe alone, on its spring, and points that weigh nothing."""
    nodes = tuple(range(1, len(X_M) + 1))
    grid = scenario.accelerometers.grid.model_copy(update={"node": nodes, "x_m": X_M, "y_m": Y_M})
    gauge = {"mass_kg": 1e-9, "end_mass_kg": 0.0}
    return scenario.model_copy(
        update={
            "accelerometers": scenario.accelerometers.model_copy(update={"grid": grid, "mass_kg": 1e-9}),
            "acquisition": scenario.acquisition.model_copy(update={"runs": (nodes,)}),
            "transducer": scenario.transducer.model_copy(update=gauge),
            "stinger": scenario.stinger.model_copy(update={"mass_kg": 0.0}),
            # On the body: where a shaker pushes a beam, a cell ends.
            "shaker": scenario.shaker.model_copy(update={"position_m": (0.0, 0.0, 0.0), "attached_to": "body"}),
        }
    )


def driven_at(scenario: Scenario, x_m: float, y_m: float) -> Scenario:
    """The same with the shaker under a point of the beam."""
    shaker = scenario.shaker.model_copy(update={"position_m": (x_m, y_m, 0.0), "attached_to": "beam"})
    return scenario.model_copy(update={"shaker": shaker})


def cut(scenario: Scenario, cells: int) -> Scenario:
    """The same with so many cells a side."""
    names = [b.name for b in scenario.airframe.beam]
    return with_beams(scenario, names, lambda b: b.model_copy(update={"cells": cells}))


def seen_by(found: Structure | LinearModel, rows: Array) -> tuple[Array, Array]:
    """Frequencies (modes,), Hz, and what rows see of mass-normalised shapes (modes, rows)."""
    squares, shapes = scipy.linalg.eigh((found.stiffness + found.stiffness.T) / 2, (found.mass + found.mass.T) / 2)
    return np.sqrt(squares[MODES]) / (2 * np.pi), (rows @ shapes).T[MODES]


def beam_elements(scenario: Scenario) -> tuple[Array, Array]:
    """Frequencies (modes,), Hz, and mass-normalised shapes (modes, points) of beam elements."""
    model = build(scenario.airframe, ELEMENTS)
    frequency, shapes = natural_modes(model.mass, model.stiffness)
    rows = np.array(
        [
            np.array([0.0, 0.0, 1.0])
            @ model.motion_at(np.array([x, y, 0.0]), f"beam-{'right' if y > 0 else 'left'}")[:3]
            for x, y in zip(X_M, Y_M, strict=True)
        ]
    )
    return frequency[MODES], (rows @ shapes).T[MODES]


@pytest.mark.parametrize(("cells", "within"), [(12, 0.02), (24, 0.01)])
def test_sensors_see_the_shapes_of_beam_elements(cells: int, within: float) -> None:
    """Mass-normalised, seven modes in bending and torsion, by a sixth of what riding on a link errs, at most.

    The spring and the weight that beam elements lack leave 0.4 % of the largest value, however many the cells.
    """
    scenario = without_instruments(load_scenario("teaching-beam"))
    layout = Layouts.of(prepared(cut(scenario, cells))).first
    frequency, exact = beam_elements(scenario)
    off = []
    for points in (layout.grid, [replace(p, seats=()) for p in layout.grid]):
        found = structure(layout, points)
        hz, seen = seen_by(found, found.axis)
        np.testing.assert_allclose(hz, frequency, rtol=0.02)
        signs = np.sign((seen * exact).sum(axis=1))[:, None]
        off.append(np.abs(signs * seen - exact).max() / np.abs(exact).max())
    assert off[0] < within
    assert off[0] < off[1] / 6


@pytest.mark.parametrize(("cells", "within"), [(12, 0.015), (24, 0.006)])
def test_a_shaker_under_a_beam_pushes_the_shapes_of_beam_elements(cells: int, within: float) -> None:
    """In the simulator, at any of five points: a link that is not cut for it is off by six times as much somewhere."""
    scenario = without_instruments(load_scenario("teaching-beam"))
    _, exact = beam_elements(scenario)
    off = np.zeros((2, len(X_M)))
    for k, (x_m, y_m) in enumerate(zip(X_M, Y_M, strict=True)):
        driven = prepared(cut(driven_at(scenario, x_m, y_m), cells))
        for r, layout in enumerate((plan(driven), plan(driven, ()))):
            rig = hung_rig(layout, 0)
            pushed = linearise(rig.model, rig.qpos, ((layout.drive.site, layout.drive.axis),))
            _, seen = seen_by(pushed, pushed.displacement)
            off[r, k] = np.abs(np.abs(seen[:, 0]) - np.abs(exact[:, k])).max() / np.abs(exact).max()
    assert off[0].max() < within
    assert off[0].max() < off[1].max() / 6


@pytest.mark.parametrize(("cells", "within"), [(12, 0.025), (24, 0.012)])
def test_a_simulated_campaign_s_truth_has_the_shapes_of_beam_elements(cells: int, within: float) -> None:
    """The bare airframe's, each of largest value one: what the sealed truth holds and sensors of a simulation feel."""
    scenario = without_instruments(load_scenario("teaching-beam"))
    layout = plan(cut(scenario, cells))
    bare = bare_modes(layout, bare_rig(layout))
    frequency, exact = beam_elements(scenario)
    elastic = slice(MODES.start - 6, MODES.stop - 6)
    np.testing.assert_allclose(bare.natural_frequency_hz[elastic], frequency, rtol=0.02)
    seen = bare.shapes[elastic, : len(X_M)].real
    scaled = [s / np.abs(s).max(axis=1, keepdims=True) for s in (seen, exact)]
    signs = np.sign((scaled[0] * scaled[1]).sum(axis=1))[:, None]
    assert np.abs(signs * scaled[0] - scaled[1]).max() < within
