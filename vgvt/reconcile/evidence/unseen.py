"""What the model has no unknown for, and by how much it may have moved what a fit says.

A wing's stiffness has a few stations; what it does between them no unknown says, and a soft root or a payload's place
stands for it. Cells are made up for, but not without a rest. Neither is noise that many lines wear down: each is a
definite change of the prediction, of known size, that leads all scores astray at once. (Consider parameters, as in
Tapley, Schutz and Born, Statistical Orbit Determination, 2004, chapter 6: not estimated, and not forgotten.)
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.fitting.misfit import data_misfit
from vgvt.reconcile.prediction.grouping import NoStructureError, cells_at
from vgvt.reconcile.prediction.surrogate import anchor
from vgvt.reconcile.question.problem import CELLS, Problem, with_more_cells
from vgvt.reconcile.question.uncertain import between_stations

Array = NDArray[np.float64]


def with_unseen(found: Fit) -> Fit:
    """The fit that knows by how much what it has no unknown for may have moved its scores."""
    changes = [*_between(found), *_by_cells(found)]
    if not changes:
        return found
    # What a change of the prediction does to the scores of a fit that takes it for data.
    return replace(found, unseen=np.array(changes) @ found.tangent @ found.covariance)


def _between(found: Fit) -> list[Array]:
    """Changes of the misfit (2 N,) by a deviation of stiffness and mass between the stations of the unknowns."""
    base, aside = between_stations(found.problem.scenario)
    if not aside:
        return []
    here = _misfit(found, replace(found.problem, scenario=base), found.u)
    there = [_misfit(found, replace(found.problem, scenario=scenario), found.u) for scenario in aside]
    return [] if here is None else [t - here for t in there if t is not None]


def _by_cells(found: Fit) -> list[Array]:
    """Change of the misfit (2 N,) by twice as many cells; nothing where there are many.

    Of records of a chain as coarse as stated, which is there as it is, nothing has to be made up for.
    """
    problem, finer = found.problem, with_more_cells(found.problem)
    if finer is None:
        return []
    none = found.u.copy()
    none[problem.unknowns.index(CELLS)] = 0.0
    here, there = (_misfit(found, p, none) for p in (problem, finer))
    as_stated = [b.cells for b in problem.scenario.airframe.beam] == [b.cells for b in problem.stated.airframe.beam]
    share = 1 + cells_at(problem, found.u) if as_stated else 1.0
    return [] if here is None or there is None else [share * (there - here)]


def _misfit(found: Fit, problem: Problem, u: Array) -> Array | None:
    """The misfit (2 N,) of another problem at scores u; None where there is no such aircraft."""
    try:
        there = anchor(problem, u, found.hypotheses, found.e, slopes=False)
        return data_misfit(problem, there.predict(u, found.e), found.sigma)
    except NoStructureError:
        return None
