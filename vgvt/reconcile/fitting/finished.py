"""A fit gone on with to its end."""

from __future__ import annotations

from vgvt.reconcile.fitting.fit import TO_THE_END, Fit, fit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.local_slopes import origin_at
from vgvt.reconcile.question.level_grid import depends_on_level
from vgvt.reconcile.work.progress import Progress, naming


def finished(found: Fit, tell: Progress) -> Fit:
    """A fit gone on with to its end, with exact slopes where that is far out, or joints depend on level."""
    held = not found.followed and any(depends_on_level(found.problem, h) for h in found.hypotheses)
    if found.converged and not held and origin_at(found.problem, found.u, found.e, found.hypotheses) is None:
        return found
    tell = naming(tell, found.hypotheses[-1])
    try:
        more = fit(found.problem, found.hypotheses, found.u, found.e, TO_THE_END, tell, exact=True, follow=True)
    except NoStructureError:
        return found
    # With other slopes the same scores are of another evidence: there it is what was lowered that counts.
    better = more.cost <= found.cost if held else more.evidence_nats >= found.evidence_nats
    return more if better else found
