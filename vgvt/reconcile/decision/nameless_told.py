"""What one thing without a name would do where names leave something: who looks for it wants its place and its law."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.beside_nameless import Array, each_alone, gained, places_beside, starts_beside
from vgvt.reconcile.decision.kinds import Kind, kind_of
from vgvt.reconcile.decision.leads import NEARLY_ALL
from vgvt.reconcile.evidence.confirmation import not_spoken_against, shares_taken, too_much
from vgvt.reconcile.evidence.free_places import places_differ
from vgvt.reconcile.evidence.nameless import Nameless, with_nameless
from vgvt.reconcile.evidence.residual import Residual
from vgvt.reconcile.evidence.rivals import worth_of
from vgvt.reconcile.evidence.strain import strain_sd
from vgvt.reconcile.fitting.fit import FAR, FORGIVING, NEAR, Fit, fit
from vgvt.reconcile.fitting.rough_start import rough_start
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.work.one_thread import one_thread
from vgvt.reconcile.work.progress import Progress, silent

Stages = tuple[tuple[float, int], ...]
# Stages for a start that the calibration has bent towards what is missing.
_BENT = FAR[:-1]
# A fit is given up that will not take so much of what is too much: nine tenths will not be taken, nor data be met.
_HALF = 0.5
# Bottoms whose costs are as near as this are one.
_SAME = 2.0


@one_thread
def nameless_told(found: Attribution, thresholds: Thresholds, tell: Progress = silent) -> Attribution:
    """The same with one nameless thing that gains what a name needs where names leave something, or there are none.

    It meets the data, or takes nine tenths of what is too much: else what is there is no one thing whose law is smooth.
    Beside names where the answer is "partly explained" for another reason than itself; where it is "unknown" alone, or
    beside one lead, where it does not meet the data alone and each of the two gains beside the other what a name needs.
    Not beside what depends on level, nor where nothing is held out, or one point alone was fitted: then it could be
    anywhere. It stands instead of no name, and changes no verdict.
    """
    case = found.null.problem
    if found.nameless is not None or not (case.split.held.any() and places_differ(case)):
        return found
    kind, each = kind_of(found), thresholds.evidence_nats
    told: Nameless | None = None
    if kind is Kind.PARTLY_EXPLAINED and all(h.linear for h in found.final.hypotheses):
        tell(0.0, "one nameless thing beside what was named")
        model = _Model(found.final, found.final_residual)
        there = _best(found, tuple(range(len(found.rounds))), found.final, model)
        told = None if there is None else _convincing(there, found.final, model, each)
    elif kind is Kind.UNKNOWN:
        told = _told_of_the_unknown(found, each, tell)
    return found if told is None else replace(found, nameless=told)


class _Model(NamedTuple):
    """A model, and what it leaves."""

    fit: Fit
    left: Residual


def _told_of_the_unknown(found: Attribution, each: float, tell: Progress) -> Nameless | None:
    """One alone, or beside one lead."""
    tell(0.0, "one nameless thing where nothing has a name")
    led = found.led if found.led is not None and all(h.linear for h in found.led.hypotheses) else None
    asked = replace(found, rounds=found.leads if led else (), final=led or found.null)
    model, told = _Model(found.null, found.null_residual), None
    alone = _best(asked, (), found.null, model)
    if alone is not None:
        told = _convincing(alone, found.null, model, each)
        if told is not None and _met(told, found.null_residual):
            return told
    for kept, beside in each_alone(asked, 1) if led else ():
        tell(0.5, f"one nameless thing beside {beside.hypotheses[0].name}")
        both = _best(asked, kept, beside, model)
        if both is None or (alone is not None and not _ahead(both, alone, found.null, beside, each)):
            continue
        convinced = _convincing(both, beside, model, each)
        if convinced is not None and (told is None or convinced.evidence_nats > told.evidence_nats):
            told = convinced
    return told


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
    return replace(there, ahead_nats=float(gains[0])) if taken >= NEARLY_ALL or _met(there, model.left) else None


def _met(there: Nameless, left: Residual) -> bool:
    """Whether it leaves no more than campaigns leave in which nothing is missing, of data and of tolerances."""
    most = left.limits
    return most.met_by(there.chi2_per_dof, there.held_out_chi2_per_dof) and strain_sd(there) <= most.strain_sd


def _best(asked: Attribution, kept: tuple[int, ...], alone: Fit, model: _Model) -> Nameless | None:
    """The nameless thing that does best beside some names or none, ``alone`` their fit, however far its start is.

    Where nothing has a name the tolerances are bent as far as they could be: where it does not meet the data from
    there, misplaced peaks are forgiven first, and then the stated values are begun from.
    """
    best: Nameless | None = None
    worthless = model.fit.cost - _HALF * too_much(*model)
    for where in places_beside(asked.final, alone):
        seen: list[float] = []
        for u, e, stages in _begun(asked, kept, alone):
            there = with_nameless(alone.problem, alone.hypotheses, u, e, where, worthless, stages)
            if there is None:
                continue
            if best is None or there.evidence_nats > best.evidence_nats:
                best = there
            if _met(there, asked.null_residual) or any(abs(there.cost - cost) < _SAME for cost in seen):
                break
            seen.append(there.cost)
    return best


def _begun(asked: Attribution, kept: tuple[int, ...], alone: Fit) -> Iterator[tuple[Array, Array, Stages]]:
    """Scores u and e to begin from, and the stages that come first, those that nearly always do before the others."""
    for u, e in starts_beside(asked.final, kept, alone):
        yield u, e, ()
    if kept:
        # What is known of two bends the tolerances no more.
        return
    yield alone.u, alone.e, _BENT
    try:
        begun = rough_start(alone.problem, alone.hypotheses, alone.e)
    except NoStructureError:
        return
    yield *begun, FORGIVING
