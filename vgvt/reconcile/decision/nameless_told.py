"""What one thing without a name would do where names leave something: who looks for it wants its place and its law."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.beside_nameless import Array, Beside, each_alone, gained, places_beside, starts_beside
from vgvt.reconcile.decision.kinds import Kind, kind_of
from vgvt.reconcile.evidence.confirmation import not_spoken_against, share_taken, too_much
from vgvt.reconcile.evidence.nameless import Nameless, with_nameless
from vgvt.reconcile.evidence.residual import Residual
from vgvt.reconcile.evidence.rivals import worth_of
from vgvt.reconcile.evidence.strain import strain_sd
from vgvt.reconcile.fitting.fit import FAR, FORGIVING, Fit
from vgvt.reconcile.fitting.rough_start import rough_start
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.work.one_thread import one_thread
from vgvt.reconcile.work.progress import Progress, silent

Stages = tuple[tuple[float, int], ...]
# Stages for a start that the calibration has bent towards what is missing.
_BENT = FAR[:-1]
_HALF = 0.5


class _Left(NamedTuple):
    """A model, and what it leaves."""

    fit: Fit
    residual: Residual


@one_thread
def nameless_told(found: Attribution, thresholds: Thresholds, tell: Progress = silent) -> Attribution:
    """The same with one nameless thing that gains what a name needs where names leave something, or there are none.

    It takes half of what is too much, as a name would have to: else what is there is no one thing whose law is smooth.
    Beside names where the answer is "partly explained" for another reason than itself; where it is "unknown" alone, or
    beside one lead, where it does not meet the data alone and each of the two gains beside the other what a name needs.
    Not beside what depends on level. It stands instead of no name, and changes no verdict.
    """
    if found.nameless is not None:
        return found
    kind, each = kind_of(found), thresholds.evidence_nats
    told: Beside | None = None
    if kind is Kind.PARTLY_EXPLAINED and all(h.linear for h in found.final.hypotheses):
        tell(0.0, "one nameless thing beside what was named")
        told = _convincing(
            found, tuple(range(len(found.rounds))), found.final, _Left(found.final, found.final_residual), each
        )
    elif kind is Kind.UNKNOWN:
        told = _told_of_the_unknown(found, each, tell)
    return found if told is None else replace(found, nameless=_told(told))


def _told_of_the_unknown(found: Attribution, each: float, tell: Progress) -> Beside | None:
    """One alone, or beside one lead."""
    tell(0.0, "one nameless thing where nothing has a name")
    led = found.led if found.led is not None and all(h.linear for h in found.led.hypotheses) else None
    left = _Left(found.null, found.null_residual)
    asked = replace(found, rounds=found.leads if led else (), final=led or found.null)
    best = _convincing(asked, (), found.null, left, each)
    if best is not None and _met(found, best.nameless):
        return best
    least = each if best is None else best.nats + each
    for kept, beside in each_alone(asked, 1) if led else ():
        tell(0.5, f"one nameless thing beside {beside.hypotheses[0].name}")
        both = _convincing(asked, kept, beside, left, each)
        if both is not None and (both.nats >= least).all() and (best is None or both.nats[0] > best.nats[0]):
            best = both
    return best


def _convincing(asked: Attribution, kept: tuple[int, ...], alone: Fit, model: _Left, each: float) -> Beside | None:
    """The best one beside some names, if it gains on them what a name needs, by both views of the model's own error.

    It takes half of what is too much in a ``model``, and held-out data do not speak against it.
    """
    best = _best(asked, kept, alone, model.fit.cost - _HALF * too_much(*model))
    if best is None or not (_gains(alone, alone, best.nameless) >= each).all():
        return None
    enough = share_taken(best.nameless, *model) >= _HALF
    return best if enough and not_spoken_against(best.nameless, alone) else None


def _told(best: Beside) -> Nameless:
    return replace(best.nameless, ahead_nats=float(_gains(best.fit, best.fit, best.nameless)[0]))


def _met(found: Attribution, there: Nameless) -> bool:
    """Whether it leaves no more than campaigns leave in which nothing is missing, of data and of tolerances."""
    most = found.null_residual.limits
    return most.met_by(there.chi2_per_dof, there.held_out_chi2_per_dof) and strain_sd(there) <= most.strain_sd


def _best(asked: Attribution, kept: tuple[int, ...], alone: Fit, worthless: float) -> Beside | None:
    """The nameless thing that does best beside some names or none, ``alone`` their fit, however far its start is.

    Where nothing has a name the tolerances are bent as far as they could be: where it does not meet the data from
    there, misplaced peaks are forgiven first, and then the stated values are begun from.
    """
    best: Beside | None = None
    for where in places_beside(asked.final, alone):
        for u, e, stages in _begun(asked, kept, alone):
            there = with_nameless(alone.problem, alone.hypotheses, u, e, where, worthless, stages)
            if there is None:
                continue
            nats = _gains(asked.null, alone, there)
            if best is None or nats[0] > best.nats[0]:
                best = Beside(kept, alone, there, nats)
            if _met(asked, there):
                break
    return best


def _begun(asked: Attribution, kept: tuple[int, ...], alone: Fit) -> Iterator[tuple[Array, Array, Stages]]:
    """Scores u and e to begin from, and the stages that come first, those that nearly always do before the others."""
    for u, e in starts_beside(asked.final, kept, alone):
        yield u, e, ()
    yield alone.u, alone.e, _BENT
    yield *rough_start(alone.problem, alone.hypotheses, alone.e), FORGIVING


def _gains(model: Fit, alone: Fit, there: Nameless) -> Array:
    """What it gains on a model, which does not meet the data: a value is worth what it is to the thing."""
    return gained(model, alone, there, worth_of(there.problem, there.predicted))
