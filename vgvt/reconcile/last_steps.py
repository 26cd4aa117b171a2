"""Fits that a round rests on, gone on with to their ends: what is compared on its way down is compared by chance."""

from __future__ import annotations

from collections.abc import Sequence

from vgvt.reconcile.fit import TO_THE_END, Fit, fit
from vgvt.reconcile.grouping import NoStructureError
from vgvt.reconcile.local_slopes import origin_near
from vgvt.reconcile.progress import Progress, naming
from vgvt.reconcile.rivals import Rival, against
from vgvt.reconcile.shortlist import BIASED
from vgvt.reconcile.team import ALONE, Team
from vgvt.reconcile.thresholds import Thresholds

# Rivals this near to the best, as a share of its gain, are fitted to the end before they are compared.
_WITHIN = 0.1
# Held-out errors this near to the least, as a multiple of it, may still become it.
_MAY_YET = 1.5


def ended(
    current: Fit,
    rivals: Sequence[Rival],
    confirmed: Sequence[Rival],
    thresholds: Thresholds,
    tell: Progress,
    team: Team = ALONE,
) -> tuple[Rival, ...]:
    """The rivals judged anew, those that may win at the end of their fits, not on their way.

    These are the best of the confirmed, by evidence and, where much is left and held-out data decide, by these, and
    what gains most of all, which held-out data may have refused on its way.
    """
    first = max(rivals, key=lambda r: r.gain_nats)
    chosen = _in_reach(confirmed, thresholds.set_nats)
    if not first.fit.converged:
        chosen.add(id(first))
    going = [k for k, r in enumerate(rivals) if id(r) in chosen]
    fits = [r.fit for r in rivals]
    for k, there in zip(going, team.work_off([(finished, (fits[k],)) for k in going], tell), strict=True):
        fits[k] = there
    return against(current, fits)


def _in_reach(confirmed: Sequence[Rival], set_nats: float) -> set[int]:
    """Identities of the confirmed that may turn out to be the best."""
    if not confirmed:
        return set()
    best = max(confirmed, key=lambda r: r.gain_nats)
    within = max(set_nats, _WITHIN * best.gain_nats)
    found = {id(r) for r in confirmed if r.gain_nats > best.gain_nats - within}
    missed = [r.held_out for r in confirmed if r.held_out is not None]
    if best.fit.chi2_per_dof >= BIASED and missed:
        reach = _MAY_YET * min(missed)
        found |= {id(r) for r in confirmed if r.held_out is not None and r.held_out <= reach}
    return found


def finished(found: Fit, tell: Progress) -> Fit:
    """A fit gone on with to its end, with exact slopes where that is far out."""
    if found.converged and origin_near(found.problem, found.u, found.e, None, found.hypotheses) is None:
        return found
    tell = naming(tell, found.hypotheses[-1])
    try:
        more = fit(found.problem, found.hypotheses, found.u, found.e, TO_THE_END, tell, exact=True)
    except NoStructureError:
        return found
    return more if more.evidence_nats >= found.evidence_nats else found
