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

from vgvt.reconcile.fit import Fit
from vgvt.reconcile.grouping import NoStructureError
from vgvt.reconcile.misfit import data_misfit
from vgvt.reconcile.problem import Problem, with_more_cells
from vgvt.reconcile.surrogate import anchor
from vgvt.reconcile.uncertain import between_stations

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
    here = _misfit(found, replace(found.problem, scenario=base))
    there = [_misfit(found, replace(found.problem, scenario=scenario)) for scenario in aside]
    return [] if here is None else [t - here for t in there if t is not None]


def _by_cells(found: Fit) -> list[Array]:
    """Change of the misfit (2 N,) by twice as many cells; nothing where there are many."""
    finer = with_more_cells(found.problem)
    there = None if finer is None else _misfit(found, finer)
    return [] if there is None else [there - data_misfit(found.problem, found.predicted, found.sigma)]


def _misfit(found: Fit, problem: Problem) -> Array | None:
    """The misfit (2 N,) of another problem at the same scores; None where there is no such aircraft."""
    try:
        there = anchor(problem, found.u, found.hypotheses, found.e, slopes=False)
        return data_misfit(problem, there.predict(found.u, found.e), found.sigma)
    except NoStructureError:
        return None
