"""One nameless thing beside none or some of the names that were given, and what both gain together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.evidence.lasting import lasting_nats
from vgvt.reconcile.evidence.nameless import Nameless, with_nameless
from vgvt.reconcile.evidence.place_of_name import place_of_name
from vgvt.reconcile.evidence.plausible import implausible
from vgvt.reconcile.evidence.rivals import overrated, worth_to
from vgvt.reconcile.evidence.still_explained import StillExplained, still_explained, surprise
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.work.progress import Progress, silent
from vgvt.reconcile.work.team import ALONE, Team

Array = NDArray[np.float64]
# A fit is given up only where it lacks more than this, too.
_SLACK_NATS = 20.0


@dataclass(frozen=True, slots=True, eq=False)
class Beside:
    """Some of the names, by index, fitted alone, and with a nameless thing.

    ``nats`` (2,) is what both gain together on the model without any: tempered, and where errors of the model last.
    """

    kept: tuple[int, ...]
    fit: Fit
    nameless: Nameless
    nats: Array


def each_beside(
    found: Attribution, count: int, needed: float = -np.inf, team: Team = ALONE, tell: Progress = silent
) -> list[Beside]:
    """Each choice of so many names with what nameless thing does best beside them.

    One that will not gain as much as is ``needed`` is not gone on with.
    """
    return _best_of_each(found, list(each_alone(found, count)), needed, team, tell)


def each_alone(found: Attribution, count: int) -> Iterator[tuple[tuple[int, ...], Fit]]:
    """Each choice of so many names, by index, and their fit without the others, as far as that is a plausible one."""
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
        yield kept, alone


def best_beside(found: Attribution, team: Team = ALONE, tell: Progress = silent) -> Beside | None:
    """The nameless thing that does best beside all names."""
    every = tuple(range(len(found.rounds)))
    return next(iter(_best_of_each(found, [(every, found.final)], -np.inf, team, tell)), None)


def _best_of_each(
    found: Attribution, models: Sequence[tuple[tuple[int, ...], Fit]], needed: float, team: Team, tell: Progress
) -> list[Beside]:
    """The nameless thing that does best beside each choice of names, by index and with their fit, if there is any."""
    last, worth = found.final, worth_to(found.final)
    # Of what it must take, less what the scores' precision may make of that.
    worthless = found.null.cost - 2 * (needed - _SLACK_NATS)
    asked = [
        (kept, alone, (_down, (last.problem, alone.hypotheses, u, e, where, worthless)))
        for kept, alone in models
        for where in places_beside(last, alone)
        for u, e in starts_beside(last, kept, alone)
    ]
    best: dict[tuple[int, ...], Beside] = {}
    for (kept, alone, _), there in zip(asked, team.work_off([task for _, _, task in asked], tell), strict=True):
        if there is None:
            continue
        nats = gained(found.null, alone, there, worth)
        if kept not in best or nats[0] > best[kept].nats[0]:
            best[kept] = Beside(kept, alone, there, nats)
    return list(best.values())


def _down(
    problem: Problem, hypotheses: tuple[Hypothesis, ...], u: Array, e: Array, where: StillExplained, worthless: float,
    tell: Progress,
) -> Nameless | None:  # fmt: skip
    """A nameless thing at a place beside some names, from some scores."""
    tell(0.0, f"one nameless thing, {where.words}")
    return with_nameless(problem, hypotheses, u, e, where, worthless)


def gained(null: Fit, alone: Fit, there: Nameless, worth: float) -> Array:
    """What a nameless thing and the names beside it, ``alone`` their fit, gain on the model without any, (2,) nats.

    ``worth`` is what one of the fitted values is worth.
    """
    tempered = there.evidence_nats - null.evidence_nats - overrated(there.chi2, null, worth)
    taken = max(0.0, 0.5 * worth * (alone.cost - there.cost))
    # What its values cost is what chance would make of as many.
    price = taken - surprise(taken) + float(np.log(there.where.asked))
    return np.array([tempered, there.lasting_nats - lasting_nats(null)]) - price


def starts_beside(last: Fit, kept: tuple[int, ...], alone: Fit) -> list[tuple[Array, Array]]:
    """Scores u and e to begin from beside some names: those of the fit of all, and those of them alone."""
    return [(last.u, _scores(last, kept)), *([] if alone is last else [(alone.u, alone.e)])]


def places_beside(last: Fit, alone: Fit) -> list[StillExplained]:
    """Where a nameless thing may be: where most is left beside all names, and beside those that are kept.

    And where the others are, which found it wherever sensors sit. Nowhere where no place can be told.
    """
    found = [s for s in (still_explained(last), still_explained(alone)) if s is not None and s.label]
    if not found:
        return []
    gone = [k for k, h in enumerate(last.hypotheses) if not any(h is kept for kept in alone.hypotheses)]
    found += [s for k in gone if (s := place_of_name(last, k, found[0])) is not None]
    return list({(s.label, s.when): s for s in found}.values())


def _scores(last: Fit, kept: tuple[int, ...]) -> Array:
    """Scores of some hypotheses of a fit, joined."""
    parts = np.split(last.e, np.cumsum([len(h.parameters) for h in last.hypotheses])[:-1])
    return np.concatenate([np.zeros(0), *(parts[k] for k in kept)])
