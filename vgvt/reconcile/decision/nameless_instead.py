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
from vgvt.reconcile.decision.leads import demoted
from vgvt.reconcile.decision.one_level import bends_at_one_level
from vgvt.reconcile.evidence.nameless import Nameless, with_nameless
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.evidence.rivals import against, worth_to
from vgvt.reconcile.evidence.still_explained import StillExplained, still_explained, surprise
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.work.one_thread import one_thread
from vgvt.reconcile.work.progress import Progress, silent

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class _Beside:
    """Some of the names, by index, fitted alone, and with a nameless thing: ``nats`` against the model without any."""

    kept: tuple[int, ...]
    fit: Fit
    nameless: Nameless
    nats: float


@one_thread
def set_against_nameless(found: Attribution, thresholds: Thresholds, tell: Progress = silent) -> Attribution:
    """The same without the names that a nameless thing makes needless; all of them leads where that needs none.

    Where a law at one place still explains something beside the names, something nameless is there, and each of them
    has to gain beside it what a name needs. Where none does, the fewest names that stand with a nameless thing must be
    ahead of all of them by as much. What depends on level at one place waits for a second level.
    """
    if not found.rounds or bends_at_one_level(found) or not all(h.linear for h in found.final.hypotheses):
        return found
    still, named = still_explained(found.final), len(found.rounds)
    gain, each = against(found.null, [found.final])[0].gain_nats, thresholds.evidence_nats
    beside = None
    if still is not None and still.nats >= each:
        beside = _best(found, tuple(range(named)), found.final)
    for count in range(named):
        tell(count / named, f"one nameless thing beside {count} of {named} names")
        needed = gain + each if beside is None else max(gain, beside.nats) - each * (named - count)
        stand = [b for b in _with(found, count, needed) if b.nats > needed]
        if stand:
            best = max(stand, key=lambda b: b.nats)
            return _instead(found, best, best.nats - gain, thresholds)
    return found


def _with(found: Attribution, count: int, needed: float = -np.inf) -> Iterator[_Beside]:
    """Each choice of so many names with what nameless thing does best beside them, if as much as ``needed`` nats."""
    last = found.final
    for kept in combinations(range(len(found.rounds)), count):
        alone = found.null
        if kept:
            try:
                alone = fit(last.problem, tuple(last.hypotheses[k] for k in kept), last.u, _scores(last, kept), NEAR)
            except NoStructureError:
                continue
        best = _best(found, kept, alone, needed)
        if best is not None:
            yield best


def _best(found: Attribution, kept: tuple[int, ...], alone: Fit, needed: float = -np.inf) -> _Beside | None:
    """The nameless thing that does best beside some names, ``alone`` their fit.

    One that will not gain as much as is ``needed`` is not gone on with.
    """
    last, null, worth = found.final, found.null, worth_to(found.final)
    cost = alone.chi2 + float(alone.scores @ alone.scores)
    best: _Beside | None = None
    for where in _places(last, alone):
        # Of what it must take, and no less: what the scores' precision makes of it is not known yet.
        worthless = null.chi2 + float(null.scores @ null.scores) - 2 * needed
        for u, e in ((last.u, _scores(last, kept)), (alone.u, alone.e)):
            there = with_nameless(last.problem, alone.hypotheses, u, e, where, worthless)
            if there is None:
                continue
            gain = there.evidence_nats - null.evidence_nats - 0.5 * (1 - worth) * (null.chi2 - there.chi2)
            taken = max(0.0, 0.5 * worth * (cost - there.cost))
            # What its values cost is what chance would make of as many.
            nats = gain + surprise(taken) - taken - float(np.log(where.asked))
            if best is None or nats > best.nats:
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
        return replace(demoted(found), nameless=nameless)
    rounds = tuple(found.rounds[k] for k in best.kept)
    gone = tuple(a.winner for k, a in enumerate(found.rounds) if k not in best.kept)
    return replace(
        found, rounds=rounds, final=best.fit, final_residual=residual(best.fit, thresholds),
        vetoed=(*gone, *found.vetoed), nameless=nameless,
    )  # fmt: skip
