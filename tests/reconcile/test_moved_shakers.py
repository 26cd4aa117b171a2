"""A next test that moves the shaker along a beam: the chain is another one, and so is all that is known of it."""

from __future__ import annotations

import numpy as np
import pytest

from vgvt.reconcile.next_test.before_test import expected_fit
from vgvt.reconcile.next_test.procedures import changed, procedures
from vgvt.reconcile.question.problem import Problem, slopes_in
from vgvt.scenario import load_scenario
from vgvt.scenario.cells import cells_of
from vgvt.simulation.pushed import pushed_beams


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return expected_fit(load_scenario("teaching-beam"), lines=40, cache=tmp_path_factory.mktemp("cache")).problem


@pytest.mark.parametrize(
    ("words", "recut"),
    [("centre line", True), ("mirror image", False), pytest.param("further forward", False, marks=pytest.mark.slow)],
)
def test_a_shaker_elsewhere_on_a_beam_has_slopes_of_its_own(case: Problem, words: str, recut: bool) -> None:
    """Slopes of another chain had been taken for its own, up to 7 % of what EI changes."""
    after = changed(case, next(p for p in procedures(case) if words in p.words))
    assert (cells_of_beam(after) != cells_of_beam(case)) == recut
    fresh = slopes_in(after.start.scenario, after.unknowns[:-1], after.layouts, after.nominal)
    for name in ("mass", "stiffness", "drive"):
        known, own = after.slopes[name][:-1], fresh[name]
        size = np.linalg.norm(own.reshape(len(own), -1), axis=1)
        missed = np.linalg.norm((known - own).reshape(len(own), -1), axis=1)
        assert (missed <= 1e-6 * size + 1e-9).all()


def cells_of_beam(problem: Problem) -> tuple[float, ...]:
    """Where the cells of one side end; the other side's shaker cuts it, too."""
    scenario = problem.start.scenario
    beam = scenario.airframe.beam[0]
    pushed = tuple(arc for name, arc in pushed_beams(scenario) if name == beam.name)
    return tuple(np.round(cells_of(beam, pushed).edges_m, 9))
