"""Fits that a round rests on, gone on with to their ends: what is compared on its way down is compared by chance.

Nor is an effect refused, or put behind another one, for a size that it does not need: the same effect without it is
what it stands for (:mod:`vgvt.reconcile.fitting.spare_sizes`).
"""

from __future__ import annotations

from collections.abc import Sequence

from vgvt.reconcile.evidence.rivals import Rival, against, distinct
from vgvt.reconcile.fitting.finished import finished
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.fitting.spare_sizes import leaner, sizes_of
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.search.shortlist import BIASED
from vgvt.reconcile.work.progress import Progress
from vgvt.reconcile.work.team import ALONE, Team

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
    """The rivals judged anew, those that may win at the end of their fits, not on their way; one of two that meet.

    These are the best of the confirmed, by evidence and, where much is left and held-out data decide, by these, what
    gains most of all, which held-out data may have refused on its way, and what gains a name but for what lasts, which
    a size less may change.
    """
    first = max(rivals, key=lambda r: r.gain_nats)
    chosen = _in_reach(confirmed, thresholds.set_nats)
    if not first.fit.converged:
        chosen.add(id(first))
    chosen |= {id(r) for r in rivals if r.gain_nats >= thresholds.evidence_nats > r.lasting_nats and _has_spare(r.fit)}
    going = [k for k, r in enumerate(rivals) if id(r) in chosen]
    fits = [r.fit for r in rivals]
    for k, there in zip(going, team.work_off([(_at_its_end, (fits[k],)) for k in going], tell), strict=True):
        fits[k] = there
    return against(current, distinct(fits))


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


def _at_its_end(found: Fit, tell: Progress) -> Fit:
    """A fit gone on with, and without the sizes of its last effect that the data do not ask for."""
    there = finished(found, tell)
    return leaner(there, tell, last=True) if _has_spare(there) else there


def _has_spare(found: Fit) -> bool:
    """Whether the last effect of a fit has more than one size, and what it leaves can tell them apart.

    Where much is left what is missing asks for sizes, too; and a march, which each of them costs, is not asked.
    """
    last = found.hypotheses[-1]
    return found.chi2_per_dof < BIASED and last.linear and len(sizes_of(last)) > 1
