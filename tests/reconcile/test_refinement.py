"""Cells of a chain: too few are made enough, and what is added gives a chain the frequencies of another one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import scipy.linalg
from reconciled_case import campaign_of, small_scenario, without_instrument_noise

from vgvt.effects import available_effects
from vgvt.effects.beams import with_beams
from vgvt.reconcile.fitting.fit import fit
from vgvt.reconcile.mechanics.refinement import meshed, towards
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import CELLS, make_problem
from vgvt.reconcile.question.uncertain import prepared
from vgvt.scenario import Scenario
from vgvt.simulation import simulated_campaign
from vgvt.simulation.reduced import Layouts, structure

TOP_HZ = 60.0


def cut_into(cells: int) -> Scenario:
    """The small scenario with a number of cells a wing."""
    scenario = small_scenario()
    return with_beams(scenario, ["wing"], lambda b: b.model_copy(update={"cells": cells}))


def below(stiffness: np.ndarray, mass: np.ndarray) -> np.ndarray:
    """Natural frequencies up to the top, in Hz."""
    squares = scipy.linalg.eigvalsh((stiffness + stiffness.T) / 2, (mass + mass.T) / 2)
    found = np.sqrt(np.abs(squares)) / (2 * np.pi)
    return found[(found > 2.0) & (found < TOP_HZ)]


def test_few_cells_become_twelve_and_enough_stay() -> None:
    assert [b.cells for b in meshed(cut_into(5)).airframe.beam] == [12]
    enough = cut_into(14)
    assert meshed(enough) is enough


def test_a_chain_gets_the_frequencies_of_the_other() -> None:
    coarse, fine = prepared(cut_into(6)), prepared(cut_into(12))
    layouts = Layouts.of(coarse)
    plan, other = layouts.plan(coarse), layouts.plan(fine)
    own, target = structure(plan, plan.grid), structure(other, other.grid)
    change = towards(fine, layouts, own, 3 * TOP_HZ)
    wanted = below(target.stiffness, target.mass)
    before, after = below(own.stiffness, own.mass), below(own.stiffness + change.stiffness, own.mass)
    count = min(before.size, after.size, wanted.size)
    assert count >= 6
    error = np.abs(after[:count] / wanted[:count] - 1).max()
    # Eigenvectors stay, hence eigenvalues are met exactly; the suspension's damping and weight take no part.
    assert error < 1e-6 < np.abs(before[:count] / wanted[:count] - 1).max()


def test_the_highest_modes_flexibility_brings_the_response_nearer(tmp_path: Path) -> None:
    """A chain of 36 cells, whose modes the refinement gives to one of 12: between them the rest counts, too."""
    scenario = small_scenario()
    beams = tuple(b.model_copy(update={"cells": 36}) for b in scenario.airframe.beam)
    fine = scenario.model_copy(update={"airframe": scenario.airframe.model_copy(update={"beam": beams})})
    campaign = simulated_campaign(without_instrument_noise(fine), engine="linear")
    case = make_problem(campaign, scenario, lines=120, cache=tmp_path)
    u = np.zeros(case.size)
    # What 36 cells lack of a continuum is a ninth of what 12 lack.
    u[case.unknowns.index(CELLS)] = -np.arctanh(1 / 9) / CELLS.sd
    nothing = np.zeros(len(case.refinement.places))
    bare = replace(
        case,
        refinement=replace(case.refinement, flexibility=nothing),
        coarseness=replace(case.coarseness, flexibility=nothing),
    )
    left = [
        np.median(np.abs(anchor(p, u, slopes=False).predict(u, np.zeros(0)) / case.measured.values - 1))
        for p in (case, bare)
    ]
    assert left[0] < 0.95 * left[1]


def test_a_swapped_sensor_is_refined_where_it_sits(tmp_path: Path) -> None:
    """What the cells lack is another thing at a tip than at a root: labelled with the other point it is still there."""
    scenario = small_scenario()
    case = make_problem(campaign_of(scenario, 1), scenario, lines=120, cache=tmp_path)
    row = {channel.dof.node: k for k, channel in enumerate(case.measured.channels)}
    swapped = Hypothesis(available_effects()["swapped-sensors"], {"node": 2, "other_node": 19})
    u = np.zeros(case.size)
    plain = fit(case, (), u, np.zeros(0), ()).predicted
    found = fit(case, (swapped,), u, np.zeros(0), ()).predicted
    np.testing.assert_allclose(found[row[2]], plain[row[19]], rtol=1e-6)
    np.testing.assert_allclose(found[row[19]], plain[row[2]], rtol=1e-6)
    assert np.abs(plain[row[2]] / plain[row[19]] - 1).max() > 0.1
