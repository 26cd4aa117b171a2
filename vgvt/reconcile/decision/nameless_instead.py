"""Names set against a thing that has none: what one smooth law at one place does without them speaks for no name.

Of what is not in the catalogue relatives take the most, and two more take what these leave: together they meet the
data, with as many sizes as it takes. What is really there is one thing at one place. Whatever its law may be, it does
with that what they do together, and lets go of the tolerances that they bent.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.leads import led_by_all
from vgvt.reconcile.decision.one_level import bends_at_one_level
from vgvt.reconcile.evidence.confirmation import not_spoken_against
from vgvt.reconcile.evidence.lasting import lasting_nats
from vgvt.reconcile.evidence.nameless import Nameless, with_nameless
from vgvt.reconcile.evidence.plausible import implausible
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.evidence.rivals import against, overrated, worth_to
from vgvt.reconcile.evidence.still_explained import StillExplained, still_explained, surprise
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.work.one_thread import one_thread
from vgvt.reconcile.work.progress import Progress, silent

Array = NDArray[np.float64]
# A fit is given up only where it lacks more than this, too.
_SLACK_NATS = 20.0


@dataclass(frozen=True, slots=True, eq=False)
class _Beside:
    """Some of the names, by index, fitted alone, and with a nameless thing.

    ``nats`` (2,) is what both gain together on the model without any: tempered, and where errors of the model last.
    """

    kept: tuple[int, ...]
    fit: Fit
    nameless: Nameless
    nats: Array


@one_thread
def set_against_nameless(found: Attribution, thresholds: Thresholds, tell: Progress = silent) -> Attribution:
    """The same without the names that a nameless thing makes needless; all of them leads where that needs none.

    Where a thing at one place, fitted beside all names, gains what a name needs, something nameless is there, and each
    of them has to gain as much beside it. Where none does, the fewest names that stand with a nameless thing must be
    ahead of all of them by that. Either way by both views of the model's own error, and held-out data must not speak
    for the names. What depends on level at one place waits for a second level.
    """
    if not found.rounds or bends_at_one_level(found) or not all(h.linear for h in found.final.hypotheses):
        return found
    still, named, each = still_explained(found.final), len(found.rounds), thresholds.evidence_nats
    (names,) = against(found.null, [found.final])
    gain = np.array([names.gain_nats, names.lasting_nats])
    beside = None
    if still is not None and still.nats >= each:
        beside = _best(found, tuple(range(named)), found.final)
    there = beside is not None and bool((beside.nats >= gain + each).all())
    fewer: Array | None = None
    for count in range(named):
        tell(count / named, f"one nameless thing beside {count} of {named} names")
        needed = gain + each
        if there and beside is not None:
            needed = np.maximum(gain, beside.nats) - each * (named - count)
        if fewer is not None:
            # A name that stays has to gain on fewer of them what a name needs.
            needed = np.maximum(needed, fewer + each)
        with_each = list(_with(found, count, float(needed[0])))
        stand = [b for b in with_each if (b.nats > needed).all() and not_spoken_against(b.nameless, found.final)]
        if stand:
            best = max(stand, key=lambda b: float(b.nats[0]))
            return _instead(found, best, float(best.nats[0] - gain[0]), thresholds)
        reached = [b.nats for b in with_each]
        fewer = np.max([*([] if fewer is None else [fewer]), *reached], axis=0) if reached else fewer
    return found


def _with(found: Attribution, count: int, needed: float = -np.inf) -> Iterator[_Beside]:
    """Each choice of so many names with what nameless thing does best beside them.

    One that will not gain as much as is ``needed`` is not gone on with.
    """
    last = found.final
    for kept in combinations(range(len(found.rounds)), count):
        alone = found.null
        if kept:
            try:
                alone = fit(last.problem, tuple(last.hypotheses[k] for k in kept), last.u, _scores(last, kept), NEAR)
            except NoStructureError:
                continue
            if any(implausible(alone, k) for k in range(count)):
                continue
        best = _best(found, kept, alone, needed)
        if best is not None:
            yield best


def _best(found: Attribution, kept: tuple[int, ...], alone: Fit, needed: float = -np.inf) -> _Beside | None:
    """The nameless thing that does best beside some names, ``alone`` their fit."""
    last, null, worth = found.final, found.null, worth_to(found.final)
    starts = [(last.u, _scores(last, kept))]
    if alone is not last:
        starts.append((alone.u, alone.e))
    best: _Beside | None = None
    for where in _places(last, alone):
        # Of what it must take, less what the scores' precision may make of that.
        worthless = null.cost - 2 * (needed - _SLACK_NATS)
        for u, e in starts:
            there = with_nameless(last.problem, alone.hypotheses, u, e, where, worthless)
            if there is None:
                continue
            tempered = there.evidence_nats - null.evidence_nats - overrated(there.chi2, null, worth)
            taken = max(0.0, 0.5 * worth * (alone.cost - there.cost))
            # What its values cost is what chance would make of as many.
            price = taken - surprise(taken) + float(np.log(where.asked))
            nats = np.array([tempered, there.lasting_nats - lasting_nats(null)]) - price
            if best is None or nats[0] > best.nats[0]:
                best = _Beside(kept, alone, there, nats)
    return best


def _places(last: Fit, alone: Fit) -> list[StillExplained]:
    """Where a nameless thing may be: where most is left beside all names, and beside those that are kept."""
    found = [s for s in (still_explained(last), still_explained(alone)) if s is not None]
    return list({(s.label, s.when): s for s in found}.values())


def _scores(last: Fit, kept: tuple[int, ...]) -> Array:
    """Scores of some hypotheses of a fit, joined."""
    parts = np.split(last.e, np.cumsum([len(h.parameters) for h in last.hypotheses])[:-1])
    return np.concatenate([np.zeros(0), *(parts[k] for k in kept)])


def _instead(found: Attribution, best: _Beside, ahead_nats: float, thresholds: Thresholds) -> Attribution:
    """What stays of an attribution beside a nameless thing that is ahead of it by so much."""
    names = tuple(a.winner.name for k, a in enumerate(found.rounds) if k not in best.kept)
    nameless = replace(best.nameless, instead_of=names, ahead_nats=ahead_nats)
    if not best.kept:
        return replace(led_by_all(found), nameless=nameless)
    # What does as well in a name's place was found beside names that are gone.
    rounds = tuple(replace(found.rounds[k], in_its_place=()) for k in best.kept)
    gone = tuple(a.winner for k, a in enumerate(found.rounds) if k not in best.kept)
    return replace(
        found, rounds=rounds, final=best.fit, final_residual=residual(best.fit, thresholds),
        vetoed=(*gone, *found.vetoed), nameless=nameless,
    )  # fmt: skip
