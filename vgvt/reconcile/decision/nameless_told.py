"""What one thing without a name would do where names leave something: who looks for it wants its place and its law."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.beside_nameless import each_alone, gained
from vgvt.reconcile.decision.kinds import Kind, kind_of
from vgvt.reconcile.decision.leads import NEARLY_ALL
from vgvt.reconcile.decision.nameless_sought import Without, met, sought
from vgvt.reconcile.evidence.confirmation import not_spoken_against, shares_taken, too_much
from vgvt.reconcile.evidence.free_places import places_differ
from vgvt.reconcile.evidence.nameless import Nameless
from vgvt.reconcile.evidence.residual import Residual
from vgvt.reconcile.evidence.rivals import worth_of
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.work.one_thread import one_thread
from vgvt.reconcile.work.progress import Progress, silent
from vgvt.reconcile.work.team import Team

# A fit is given up that will not take so much of what is too much: nine tenths will not be taken, nor data be met.
_HALF = 0.5


@one_thread
def nameless_told(found: Attribution, thresholds: Thresholds, tell: Progress = silent, workers: int = 1) -> Attribution:
    """The same with one nameless thing that gains what a name needs where names leave something, or there are none.

    It meets the data, or takes nine tenths of what is too much: else what is there is no one thing whose law is smooth.
    Beside names where the answer is "partly explained" for another reason than itself; where it is "unknown" alone, or
    beside one lead, where it does not meet the data alone and each of the two gains beside the other what a name needs.
    Not beside what depends on level, nor where nothing is held out, or one point alone was fitted: then it could be
    anywhere. It stands instead of no name, and changes no verdict. ``workers`` processes share the work, which changes
    the time and nothing else.
    """
    case = found.null.problem
    if found.nameless is not None or not (case.split.held.any() and places_differ(case)):
        return found
    kind, each = kind_of(found), thresholds.evidence_nats
    told: Nameless | None = None
    if kind is Kind.PARTLY_EXPLAINED and all(h.linear for h in found.final.hypotheses):
        told = _told_beside_names(found, each, tell, workers)
    elif kind is Kind.UNKNOWN:
        told = _told_of_the_unknown(found, each, tell, workers)
    return found if told is None else replace(found, nameless=told)


class _Model(NamedTuple):
    """A model, and what it leaves."""

    fit: Fit
    left: Residual

    @property
    def worthless(self) -> float:
        """The cost at which a thing takes too little of what is too much."""
        return self.fit.cost - _HALF * too_much(self.fit, self.left)


def _told_beside_names(found: Attribution, each: float, tell: Progress, workers: int) -> Nameless | None:
    """One beside all names."""
    tell(0.0, "one nameless thing beside what was named")
    model, every = _Model(found.final, found.final_residual), Without(tuple(range(len(found.rounds))), found.final)
    with _team(found.final, workers) as team:
        ((_, there),) = sought(found, [every], model.worthless, team, tell)
    return None if there is None else _convincing(there, found.final, model, each)


def _told_of_the_unknown(found: Attribution, each: float, tell: Progress, workers: int) -> Nameless | None:
    """One alone, or beside one lead."""
    tell(0.0, "one nameless thing where nothing has a name")
    led = found.led if found.led is not None and all(h.linear for h in found.led.hypotheses) else None
    asked = replace(found, rounds=found.leads if led else (), final=led or found.null)
    model, told = _Model(found.null, found.null_residual), None
    alone: Nameless | None = None
    with _team(asked.final, workers) as team:
        for (kept, without), there in sought(asked, _models(asked), model.worthless, team, tell):
            alone = there if not kept else alone
            if there is None:
                continue
            if kept and alone is not None and not _ahead(there, alone, found.null, without, each):
                continue
            convinced = _convincing(there, without, model, each)
            if convinced is not None and not kept and met(convinced, found.null_residual.limits):
                return convinced
            if convinced is not None and (told is None or convinced.evidence_nats > told.evidence_nats):
                told = convinced
    return told


def _models(asked: Attribution) -> Iterator[Without]:
    """The model without any name, then those with one lead each."""
    yield Without((), asked.null)
    if asked.rounds:
        yield from (Without(*model) for model in each_alone(asked, 1))


def _team(last: Fit, workers: int) -> Team:
    """Who shares the work; what has the problem's and the hypotheses' identity keeps it."""
    return Team(workers, (last.problem, *last.hypotheses))


def _ahead(both: Nameless, alone: Nameless, null: Fit, lead: Fit, each: float) -> bool:
    """Whether a thing and a ``lead`` gain together what a name needs on a thing ``alone``, a value worth the same."""
    worth = worth_of(both.problem, both.predicted)
    return bool((gained(null, lead, both, worth) >= gained(null, null, alone, worth) + each).all())


def _convincing(there: Nameless, alone: Fit, model: _Model, each: float) -> Nameless | None:
    """A thing with what it gains on the fit ``alone`` without it; None where that is too little.

    By both views of the model's own error, and held-out data do not speak against it. It meets the data, or takes
    nearly all of what is too much in the ``model``.
    """
    # What it has found by another start, or by more steps, is none of its own.
    without = max((alone, fit(there.problem, there.hypotheses, there.u, there.e, NEAR)), key=lambda f: f.evidence_nats)
    gains = gained(without, without, there, worth_of(there.problem, there.predicted))
    if not (gains >= each).all() or not not_spoken_against(there, without):
        return None
    taken = min(shares_taken(there, model.fit, there.held_out_chi2_per_dof, model.left))
    return replace(there, ahead_nats=float(gains[0])) if taken >= NEARLY_ALL or met(there, model.left.limits) else None
