"""A round's short list and the fits of it: near where the calibration stands, or from where it still forgives."""

from __future__ import annotations

from collections.abc import Sequence

from vgvt.reconcile.evidence.residual import Residual
from vgvt.reconcile.evidence.rivals import Rival, against, distinct
from vgvt.reconcile.fitting.fit import FAR, NEAR, Fit
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.search.candidate_fits import begun_anew, finalists, fitted_from
from vgvt.reconcile.search.courses import best_course, in_other_courses
from vgvt.reconcile.search.next_items import at_next_items
from vgvt.reconcile.search.screened import Screened
from vgvt.reconcile.search.shortlist import BIASED, shortened, swallowed
from vgvt.reconcile.work.progress import Progress, part
from vgvt.reconcile.work.team import ALONE, Task, Team

_AT_LEAST, _FAR_AHEAD = 3, 5.0
# Fitted together after these, whoever shares the work: none of them is left out for another one's sake.
_AT_ONCE = 2


def tried(
    current: Fit,
    hypotheses: Sequence[Hypothesis],
    before: Residual,
    thresholds: Thresholds,
    tell: Progress,
    team: Team = ALONE,
    *,
    again: bool = False,
    afar: bool = False,
) -> tuple[Rival, ...]:
    """The most promising of some hypotheses, fitted; ``afar`` as if the calibration had swallowed part of them."""
    afar = afar or swallowed(current, before)
    needed, listing = thresholds.evidence_nats, part(tell, 0.0, 0.6)
    chosen = shortened(current, hypotheses, before, needed, listing, team, again=again, afar=afar)
    return fit_all(current, chosen, hypotheses, part(tell, 0.6, 1.0), team, afar=afar)


def fit_all(
    current: Fit,
    chosen: Sequence[Screened],
    hypotheses: Sequence[Hypothesis],
    tell: Progress,
    team: Team = ALONE,
    *,
    afar: bool,
) -> tuple[Rival, ...]:
    """The short list fitted, best first; what the screen puts far behind a fit that is there already is left out.

    From ``afar`` all begin with steps that forgive misplaced peaks, and those that do best by these go on.
    Of ``hypotheses`` come other courses of changes between runs, and other items that a thing may be.
    """
    screened = chosen
    if afar:
        seen = tuple(s for s in chosen if s.upright)
        rest = tuple(s for s in chosen if not s.upright)
        chosen = (*seen, *finalists(current, rest, part(tell, 0.0, 0.4), team))
        tell = part(tell, 0.4, 1.0)
        last = {s.hypothesis for s in chosen}
        screened = [s for s in screened if s.hypothesis in last]
    tell, anew, later = part(tell, 0.0, 0.7), part(tell, 0.7, 0.9), part(tell, 0.9, 1.0)
    found: list[Fit] = []
    # Of finalists none is left out for another one's sake: they are fitted together.
    first = len(chosen) if afar else _AT_LEAST
    waves = [chosen[:first], *(chosen[k : k + _AT_ONCE] for k in range(first, len(chosen), _AT_ONCE))]
    for k, wave in enumerate(waves):
        best = max((f.evidence_nats - current.evidence_nats for f in found), default=0.0)
        enough = len(found) >= _AT_LEAST and best > 0.4 * current.chi2
        tasks: list[Task] = [
            (fitted_from, (current, s, FAR if afar or s.upright else NEAR))
            for s in wave
            if not (enough and best > _FAR_AHEAD * s.gain_nats)
        ]
        fits = team.work_off(tasks, part(tell, k / len(waves), (k + 1) / len(waves)))
        found += [f for f in fits if f is not None]
    # A model with an effect has been brought near by that; one without may be anywhere.
    if afar and found and not current.hypotheses and min(f.chi2_per_dof for f in found) >= BIASED:
        found += begun_anew(current, screened, min(f.chi2 for f in found), anew, team)
    found += in_other_courses(current, found, hypotheses, part(later, 0.0, 0.5), team)
    found += at_next_items(current, found, hypotheses, part(later, 0.5, 1.0), team, placed=afar)
    return against(current, distinct([best_course(f, hypotheses) for f in found]))
