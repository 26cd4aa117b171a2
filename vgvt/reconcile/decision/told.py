"""What a verdict says of its effects in numbers: no size that nothing shows, and errors that know of the unknowns.

A search compares effects, and slopes of the stated aircraft lead it well enough. What is told must stand by itself: how
far a hook was moved and how high it is are known by their ratio alone, and by slopes of the stated aircraft each seemed
to be known to two per cent.
"""

from __future__ import annotations

from dataclasses import replace

from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.evidence.unseen import with_unseen
from vgvt.reconcile.fitting.fit import TO_THE_END, Fit, fit
from vgvt.reconcile.fitting.spare_sizes import leaner
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.work.progress import Progress, silent
from vgvt.reconcile.work.team import Team


def with_told_parameters(
    found: Attribution, thresholds: Thresholds, tell: Progress = silent, workers: int = 1
) -> Attribution:
    """The same names with the final fit as it is told: without spare sizes, and with slopes of the whole aircraft.

    Its errors know of what the model has no unknown for.

    Leads stay as they are, and so does what holds a joint that depends on level: a march has slopes of its own.
    """
    if not found.rounds or not all(h.linear for h in found.final.hypotheses):
        return found
    with Team(workers, (found.final.problem,)) as team:
        final = with_unseen(polished(leaner(found.final, tell, team), tell))
    return replace(found, final=final, final_residual=residual(final, thresholds))


def polished(found: Fit, tell: Progress = silent) -> Fit:
    """A fit gone on with by the slopes of the whole aircraft, effects and all, as it is where the fit has arrived.

    Other slopes stop where they promise no more: beside the bottom, where an effect and an unknown multiply. Where
    these lead no further down, what is told still has the errors by them: by others a size had a third of its own.
    """
    try:
        more = fit(found.problem, found.hypotheses, found.u, found.e, TO_THE_END, tell, whole=True)
        if more.cost <= found.cost:
            return more
        here = fit(found.problem, found.hypotheses, found.u, found.e, (), whole=True)
    except NoStructureError:
        return found
    return replace(here, converged=found.converged)
