"""How finely to cut the beams of what was found, so that its simulation errs as the fit says that the data do."""

from __future__ import annotations

import math

from vgvt.effects.beams import with_beams
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.mechanics.refinement import MOST_CELLS
from vgvt.reconcile.question.problem import CELLS
from vgvt.scenario.model import Scenario


def with_cells(scenario: Scenario, fit: Fit) -> Scenario:
    """The scenario with as many times its cells as the fit asks for, its finest beam with 60 at most.

    A chain of n cells errs by 1/n²: of the stated chain's error a fit finds all in data of the same chain, and next to
    none in those of an aircraft, which has no cells.
    """
    beams = scenario.airframe.beam
    found = CELLS.amount(float(fit.u[fit.problem.unknowns.index(CELLS)]))
    finest = max((b.cells for b in beams), default=MOST_CELLS)
    most = max(1.0, MOST_CELLS / finest)
    times = min(most, 1 / math.sqrt(-found)) if found < 0 else most
    names = [b.name for b in beams]
    return with_beams(scenario, names, lambda b: b.model_copy(update={"cells": round(times * b.cells)}))
