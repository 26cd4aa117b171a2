"""A fit gone on with to its end."""

from __future__ import annotations

from vgvt.reconcile.fitting.descent import NEARLY_MET
from vgvt.reconcile.fitting.fit import TO_THE_END, Fit, fit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.local_slopes import origin_at
from vgvt.reconcile.question.level_grid import depends_on_level
from vgvt.reconcile.work.progress import Progress, naming

_BACK = ((0.15, 8), (0.03, 8), *TO_THE_END)
"""From where slopes that held what joints show have led out of the valley: steps that forgive lead back towards it."""


def finished(found: Fit, tell: Progress) -> Fit:
    """A fit gone on with to its end, with exact slopes where that is far out, or joints depend on level.

    Where these were held and data are missed, it goes on from where the fit has strayed only if the way back ends at no
    bottom.
    """
    held = not found.followed and any(depends_on_level(found.problem, h) for h in found.hypotheses)
    if found.converged and not held and origin_at(found.problem, found.u, found.e, found.hypotheses) is None:
        return found
    tell = naming(tell, found.hypotheses[-1])
    strayed = held and found.cost > NEARLY_MET * found.points
    best = found
    for stages in (_BACK, TO_THE_END) if strayed else (TO_THE_END,):
        try:
            more = fit(found.problem, found.hypotheses, found.u, found.e, stages, tell, exact=True, follow=True)
        except NoStructureError:
            continue
        # With other slopes the same scores are of another evidence: there it is what was lowered that counts.
        if more.cost <= best.cost if held else more.evidence_nats >= best.evidence_nats:
            best = more
            if more.converged:
                break
    return best
