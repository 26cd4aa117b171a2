"""Sizes of named effects that the data do not ask for, left out: a root that gives way in bending need not in torsion.

A size on a logarithmic scale cannot vanish: held in its range, what nothing shows of it is made up for by the size that
is there, and its neighbour's error bar knows nothing of that. Without it the same effect has one parameter less, and is
preferred where evidence says so.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vgvt.reconcile.fitting.finished import finished
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.fitting.fit_unless_behind import HOPELESS
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.work.progress import Progress, naming, silent
from vgvt.reconcile.work.team import ALONE, Task, Team


def leaner(found: Fit, tell: Progress = silent, team: Team = ALONE, *, last: bool = False) -> Fit:
    """The fit without the sizes that its evidence is better without, one after the other; itself where there is none.

    Only those of the ``last`` effect are asked, where that is said. A size that is left out is a setting of its
    hypothesis, at the value where it does nothing; which one of them it is was a choice, and is paid for as one.
    """
    while True:
        tries: list[Task] = [
            (_without, (found, k, name)) for k, name in _spare(found) if not last or k == len(found.hypotheses) - 1
        ]
        fits = [f for f in team.work_off(tries, tell) if f is not None]
        best = max(fits, key=lambda f: f.evidence_nats, default=None)
        if best is None or best.evidence_nats <= found.evidence_nats:
            return found
        found = best


def sizes_of(hypothesis: Hypothesis) -> list[str]:
    """Names of the parameters that each say how big an effect is."""
    return [p.name for p in hypothesis.parameters if p.neutral is not None]


def _spare(found: Fit) -> Iterator[tuple[int, str]]:
    """Index of a hypothesis and name of a size, of all that are not the only one of their effect."""
    for k, hypothesis in enumerate(found.hypotheses):
        sizes = sizes_of(hypothesis)
        if len(sizes) > 1:
            yield from ((k, name) for name in sizes)


def _without(found: Fit, index: int, size: str, tell: Progress) -> Fit | None:
    """The fit with one size of one hypothesis where it does nothing; None where there is no such thing.

    None, too, where it leaves a multiple of what is left with that size: its way to the end is long, and leads nowhere.
    """
    own = found.hypotheses[index]
    names = [p.name for p in own.parameters]
    less = own.without(size)
    before = sum(len(h.parameters) for h in found.hypotheses[:index])
    e = np.delete(found.e, before + names.index(size))
    joined = (*found.hypotheses[:index], less, *found.hypotheses[index + 1 :])
    try:
        near = fit(found.problem, joined, found.u, e, NEAR, naming(tell, less))
        return None if near.chi2 > HOPELESS * found.chi2 else finished(near, tell)
    except NoStructureError:
        return None
