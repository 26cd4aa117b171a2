"""Whether a name gives way to another one beside all the others: what is missing twice is not seen one by one.

A round takes the best of one effect more, and takes nothing back. Where two effects are missing, a relative of one may
gain most alone, as it takes something of the other's, too, or held-out data may speak against the right one while the
other is not there. What had convinced in the round of a name is therefore put in its place once all names are there:
not by what it promises there (:mod:`vgvt.reconcile.decision.in_its_place`), which a bent calibration hides, but fitted.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.backward import without
from vgvt.reconcile.decision.place_control import as_good, controlled
from vgvt.reconcile.evidence.confirmation import not_spoken_against
from vgvt.reconcile.evidence.plausible import implausible
from vgvt.reconcile.evidence.rivals import Rival, against
from vgvt.reconcile.fitting.fit import FAR, NEAR, Fit, fit
from vgvt.reconcile.fitting.fit_unless_behind import fit_unless_behind
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.work.progress import Progress, naming, part, silent
from vgvt.reconcile.work.team import Task, Team

if TYPE_CHECKING:
    from vgvt.reconcile.decision.attribute import Attribution

Array = NDArray[np.float64]

# Other effects of a round that are put in the place of its name, and what each must have gained there of what that did.
_OTHERS, _NEAR = 2, 0.25


def exchanged(
    found: Attribution, thresholds: Thresholds, tell: Progress = silent, workers: int = 1
) -> tuple[Addition, ...]:
    """Rounds of the names ``found`` with one exchanged for another that does better beside the rest; none without any.

    Asked where names leave something, and none of them depends on level: that waits for a second level.
    ``thresholds`` are those of the campaign. The rounds are those of a search that had begun with what does best alone;
    every one of them convinces. Held-out data may not prefer the names that were ``found``. What does as well as the
    new name beside all the others stands in its place (:class:`~vgvt.reconcile.decision.addition.Addition`).
    """
    final, named = found.final, [a.winner.name for a in found.rounds]
    if found.final_residual.adequate or named != [h.name for h in final.hypotheses]:
        return ()
    if not all(h.linear for h in final.hypotheses):
        return ()
    asked = [(k, r) for k, addition in enumerate(found.rounds) for r in _others(addition, named, thresholds)]
    if not asked:
        return ()
    with Team(workers, (final.problem,)) as team:
        tasks: list[Task] = [(_in_place_of, (final, k, r.hypothesis, _own_scores(r.fit))) for k, r in asked]
        fitted = team.work_off(tasks, part(tell, 0.0, 0.7))
        there = [(k, f) for (k, _), f in zip(asked, fitted, strict=True) if f is not None]
        best = ahead_of(found.null, final, [f for _, f in there], thresholds.set_nats)
        if best is None or not not_spoken_against(best, final):
            return ()
        # In the place of the same name alone: no answer holds two pairs that have no name in common.
        where = next(k for k, f in there if f is best)
        alike = _as_well(found.null, best, [f for k, f in there if k == where and f is not best], thresholds.set_nats)
        return _rounds(found, best, alike, thresholds, part(tell, 0.7, 1.0), team)


def leads_further(other: Attribution, found: Attribution, set_nats: float) -> bool:
    """Whether a search that went on from an exchange explains more than what was ``found``, held-out data allowing."""
    if not other.rounds or not not_spoken_against(other.final, found.final):
        return False
    return other.final_residual.adequate or ahead_of(found.null, found.final, [other.final], set_nats) is not None


def ahead_of(null: Fit, final: Fit, fits: Sequence[Fit], set_nats: float) -> Fit | None:
    """The best of some fits where it is ahead of a ``final`` one by more than the data leave open, else None."""
    judged = against(null, [final, *fits])
    best, before = judged[0], next(r for r in judged if r.fit is final)
    return best.fit if best.gain_nats > before.gain_nats + set_nats else None


def _others(addition: Addition, named: Sequence[str], thresholds: Thresholds) -> list[Rival]:
    """The best of each other effect that convinced in a round, best first: two at most, linear and plausible ones.

    Before them what was found to do as well, or better, beside all the others: no round may have tried it. A name that
    is alone has none beside it, and the rivals of its round have been fitted as they would be in its place.
    """
    best = {r.name: r for r in addition.in_its_place[1:] if r.name not in named}
    there = len(best)
    rivals = addition.rivals if len(named) > 1 else ()
    for r in sorted(rivals, key=lambda r: -r.gain_nats):
        enough = r.convinces(thresholds) and r.gain_nats >= _NEAR * addition.winner.gain_nats
        if enough and r.name not in named and r.hypothesis.linear and not implausible(r.fit):
            best.setdefault(r.name, r)
    return list(best.values())[: there + _OTHERS]


def _own_scores(found: Fit) -> Array:
    """Scores of a fit's last effect (its parameters,)."""
    return found.e[found.e.size - len(found.hypotheses[-1].parameters) :]


def _in_place_of(final: Fit, index: int, hypothesis: Hypothesis, own: Array, tell: Progress) -> Fit | None:
    """A model with another effect, last, in the place of that of an index; None where there is no such aircraft."""
    kept, e, _ = without(final, index)
    tell = naming(tell, hypothesis)
    try:
        return fit_unless_behind(
            final.problem, (*kept, hypothesis), final.u, np.concatenate([e, own]), FAR, final.chi2, tell
        )
    except NoStructureError:
        return None


def _as_well(null: Fit, best: Fit, others: Sequence[Fit], set_nats: float) -> tuple[Rival, ...]:
    """The best fit as a rival, then those of others that neither evidence nor held-out data tell from it."""
    judged = against(null, [best, *others])
    first = next(r for r in judged if r.fit is best)
    near = [r for r in judged if r is not first and r.gain_nats > first.gain_nats - set_nats]
    return (first, *(r for r in near if as_good(r.fit, best, set_nats) and not implausible(r.fit)))


def _rounds(
    found: Attribution, best: Fit, alike: tuple[Rival, ...], thresholds: Thresholds, tell: Progress, team: Team
) -> tuple[Addition, ...]:
    """The effects of a fit as rounds, one by one from what does best alone; none where one does not convince.

    ``alike`` is the fit itself, and then those with another effect in the place of its last one that do as well.
    """
    count = len(best.hypotheses)
    alone = team.work_off([(_of_these, (best, (k,))) for k in range(count)], part(tell, 0.0, 0.3))
    if any(f is None for f in alone):
        return ()
    order = sorted(range(count), key=lambda k: -alone[k].evidence_nats)
    before, rounds = found.null, list[Addition]()
    for n in range(1, count + 1):
        here = part(tell, 0.3 + 0.7 * (n - 1) / count, 0.3 + 0.7 * n / count)
        there = alone[order[0]] if n == 1 else _of_these(best, tuple(order[:n]), here)
        winner = None if there is None else against(before, [there])[0]
        if winner is None or not winner.convinces(thresholds):
            return ()
        others = [r for r in found.rounds[0].rivals if n == 1 and len(r.fit.hypotheses) == 1 and r.name != winner.name]
        rivals = tuple(sorted((winner, *others), key=lambda r: -r.gain_nats))
        in_its_place = alike if len(alike) > 1 and order[n - 1] == count - 1 else ()
        addition = Addition(winner, (winner,), rivals, before.held_out_chi2_per_dof, in_its_place, exchanged=True)
        rounds.append(controlled(addition, partial(_judged, before), thresholds.set_nats, here, team))
        before = winner.fit
    return tuple(rounds)


def _judged(before: Fit, found: Fit) -> Rival:
    """A fit as a rival, against the model without its last effect."""
    return against(before, [found])[0]


def _of_these(found: Fit, chosen: tuple[int, ...], tell: Progress) -> Fit | None:
    """A fit of some of a model's effects, in that order, from where they are; None where there is no such aircraft."""
    ends = np.cumsum([0, *(len(h.parameters) for h in found.hypotheses)])
    own = [found.e[ends[k] : ends[k + 1]] for k in chosen]
    try:
        return fit(found.problem, tuple(found.hypotheses[k] for k in chosen), found.u, np.concatenate(own), NEAR, tell)
    except NoStructureError:
        return None
