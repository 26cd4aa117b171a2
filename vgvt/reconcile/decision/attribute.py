"""Fit the short list jointly with the unknowns, compare by evidence, and name only what held-out data confirm."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from vgvt.data.shown import counted, headed
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.backward import needed, nowhere, without_last
from vgvt.reconcile.decision.fitted_list import fit_all, tried
from vgvt.reconcile.decision.hopeless import hopeless
from vgvt.reconcile.decision.in_its_place import reconsidered
from vgvt.reconcile.decision.last_steps import ended
from vgvt.reconcile.decision.place_control import controlled
from vgvt.reconcile.evidence.bending import plain_likenesses, straightened
from vgvt.reconcile.evidence.confirmation import confirmed_by_held_out, held_out_nats, takes_enough
from vgvt.reconcile.evidence.localise import localise
from vgvt.reconcile.evidence.nameless import Nameless
from vgvt.reconcile.evidence.plausible import implausible, likelier
from vgvt.reconcile.evidence.residual import Residual, residual
from vgvt.reconcile.evidence.rivals import Rival, against, distinct
from vgvt.reconcile.evidence.same_place import left_where_it_was
from vgvt.reconcile.evidence.still_explained import StillExplained
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.level_grid import linear_first
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.search.shortlist import BIASED, second_list, swallowed
from vgvt.reconcile.work.one_thread import one_thread
from vgvt.reconcile.work.progress import Progress, part
from vgvt.reconcile.work.team import Team

# Held-out errors this near to each other say nothing of which is right, where both are far from noise.
_AS_GOOD = 1.1
# Of the progress: when all names are there that will be, and what a round takes of the time of the one before it, which
# few searches have much of.
_CHOSEN, _LATER = 0.95, 0.25


@dataclass(frozen=True, slots=True, eq=False)
class Attribution:
    """The model without effects, the rounds that added one, the fit at the end, and what each of both ends leaves.

    ``leads`` are rounds that take too little to give a name, or are no plausible thing, ``led`` the fit with them
    (:mod:`vgvt.reconcile.decision.leads`). ``still`` is what a law at one place explains beside the names, where it is
    more than chance explains (:mod:`vgvt.reconcile.decision.beyond_names`). ``nameless`` is a thing of no catalogue
    that does better than names did (:mod:`vgvt.reconcile.decision.nameless_instead`), or with what they leave
    (:mod:`vgvt.reconcile.decision.nameless_told`).
    """

    null: Fit
    null_residual: Residual
    rounds: tuple[Addition, ...]
    final: Fit
    final_residual: Residual
    last_rivals: tuple[Rival, ...]
    vetoed: tuple[Rival, ...]
    leads: tuple[Addition, ...] = ()
    led: Fit | None = None
    still: StillExplained | None = None
    nameless: Nameless | None = None

    def __repr__(self) -> str:
        before, after = self.null_residual.train_chi2_per_dof, self.final_residual.train_chi2_per_dof
        left = f"χ² per degree of freedom {before:.3g}{f' → {after:.3g}' if self.rounds else ''}"
        lines = [f"named: {a.in_words}" for a in self.rounds] + [f"lead: {a.in_words}" for a in self.leads]
        return headed(f"Attribution: {counted(len(self.rounds), 'name')}, {left}", lines)


@one_thread
def attribute(
    null: Fit,
    hypotheses: Sequence[Hypothesis],
    thresholds: Thresholds,
    *,
    most: int = 3,
    progress: Progress | None = None,
    begun: tuple[Fit, tuple[Addition, ...], tuple[Rival, ...]] | None = None,
    keep: Callable[[Fit, Sequence[Addition], Sequence[Rival]], None] | None = None,
    workers: int = 1,
) -> Attribution:
    """Forward selection of at most ``most`` effects by evidence that held-out data confirm, then a backward check.

    It ends where no other effect gains a name, not where the data are met: a small second effect hides in what all the
    data together allow, as it would if it were alone.

    ``thresholds`` are those of the campaign (:func:`~vgvt.reconcile.question.thresholds.thresholds_for`).
    ``begun`` are the null model, the rounds and what they refused, of a call that was broken off; ``keep`` is told all
    three after each round.
    ``workers`` processes share what can be done at once; the answer is the same with any number.
    """
    with Team(workers, (null.problem, *hypotheses)) as team:
        return _selected(null, hypotheses, thresholds, most, progress, begun, keep, team)


def _selected(
    null: Fit,
    hypotheses: Sequence[Hypothesis],
    thresholds: Thresholds,
    most: int,
    progress: Progress | None,
    begun: tuple[Fit, tuple[Addition, ...], tuple[Rival, ...]] | None,
    keep: Callable[[Fit, Sequence[Addition], Sequence[Rival]], None] | None,
    team: Team,
) -> Attribution:
    """:func:`attribute`, with those who share the work."""
    tell = progress or (lambda fraction, message: None)
    start, done, refused_then = (null, (), ()) if begun is None else begun
    rounds = list(done)
    current = rounds[-1].winner.fit if rounds else start
    vetoed: list[Rival] = list(refused_then)
    rivals: tuple[Rival, ...] = rounds[-1].rivals if rounds else ()
    for k in range(len(rounds), most):
        left = [h for h in hypotheses if h.name not in {r.winner.name for r in rounds}]
        straight, bent = linear_first(current.problem, left)
        before = residual(current, thresholds)
        if hopeless(k, most, current, start, before, residual(start, thresholds)):
            break
        here = part(tell, *(_CHOSEN * _worked_off(n, most) for n in (k, k + 1)))
        rivals = tried(current, straight, before, thresholds, part(here, 0.0, 0.5), team)
        if k == 0 and rivals:
            start = current = _restart(null, rivals[0])
            if current is not null:
                before = residual(current, thresholds)
                found = [r.fit for r in rivals]
                if before.train_chi2_per_dof < BIASED <= null.chi2_per_dof:
                    # What was screened where the calibration had lost its way says little of where it belongs.
                    again = tried(current, straight, before, thresholds, part(here, 0.5, 0.6), team, again=True)
                    found += [r.fit for r in again]
                rivals = against(current, found)
        choice = _choice(current, rivals, straight, bent, before, thresholds, part(here, 0.6, 0.7), team, named=k > 0)
        if choice.best is None and not before.fitted_adequate and not swallowed(current, before):
            # What is sharp, and hidden by tolerances that are not quite bent, promises nothing near by.
            more = tried(current, straight, before, thresholds, part(here, 0.7, 0.95), team, afar=True)
            if k == 0 and more and (better := _restart(current, more[0])) is not current:
                start, current, before = better, better, residual(better, thresholds)
            rivals = against(current, distinct([r.fit for r in (*choice.rivals, *more)]))
            later, rest = [h for h in bent if h not in choice.joints], part(here, 0.95, 1.0)
            choice = _choice(current, rivals, straight, later, before, thresholds, rest, team, named=k > 0)
        rivals, passed, confirmed, best, _ = choice
        vetoed += [r for r in rivals if r.convinces(thresholds) and r not in confirmed]
        if best is None:
            break
        winner, equal = best
        equal = (*equal, *_ahead_in_all(winner, rivals, passed, thresholds))
        equal = (*equal, *plain_likenesses(winner, confirmed, equal, thresholds))
        addition = Addition(winner, equal, rivals, before.held_out_chi2_per_dof)
        rounds.append(controlled(addition, partial(_judged, current), thresholds.set_nats, part(here, 1.0, 1.0), team))
        current, rivals = winner.fit, rounds[-1].rivals
        if keep is not None:
            keep(start, rounds, vetoed)
    rounds, current = needed(rounds, current, thresholds)
    while rounds and nowhere(rounds[-1]) and not residual(current, thresholds).adequate:
        # What stands between these data and a name is what that round asked, not what was asked beside its own.
        rivals = rounds[-1].rivals
        rounds, current, refused = without_last(rounds, start)
        vetoed += refused
    after = residual(current, thresholds)
    rounds = reconsidered(
        rounds, current, hypotheses, thresholds.set_nats, part(tell, _CHOSEN, 1.0), team, met=after.adequate
    )
    return Attribution(start, residual(start, thresholds), tuple(rounds), current, after, rivals, tuple(vetoed))


def _worked_off(number: int, most: int) -> float:
    """The share of the time in which so many rounds of so many are worked off."""
    return float((1 - _LATER**number) / (1 - _LATER**most))


class _Choice(NamedTuple):
    """The rivals of a round, those that passed, those that keep what they passed with, and the winner with its equals.

    There is no winner where none may give its name. ``joints`` are those that depend on level and were asked.
    """

    rivals: tuple[Rival, ...]
    passed: list[Rival]
    confirmed: list[Rival]
    best: tuple[Rival, tuple[Rival, ...]] | None
    joints: list[Hypothesis]


def _choice(
    current: Fit,
    rivals: tuple[Rival, ...],
    straight: Sequence[Hypothesis],
    bent: Sequence[Hypothesis],
    before: Residual,
    thresholds: Thresholds,
    tell: Progress,
    team: Team,
    *,
    named: bool,
) -> _Choice:
    """What a round makes of its rivals, fitted to their ends and beside the ``bent`` joints that they could be."""
    confirmed = passed = [r for r in rivals if _passed(r, current, before, thresholds)]
    twins = _twins(bent, confirmed, before, named)
    if twins:
        later = second_list(current, twins, straight, thresholds.evidence_nats, part(tell, 0.0, 0.25), team)
        more = fit_all(current, later, twins, part(tell, 0.25, 0.5), team, afar=swallowed(current, before))
        rivals = against(current, [r.fit for r in (*rivals, *more)])
        confirmed = passed = [r for r in rivals if _passed(r, current, before, thresholds)]
    if any(r.gain_nats >= thresholds.evidence_nats for r in rivals):
        rivals = ended(current, rivals, confirmed, thresholds, part(tell, 0.5, 1.0), team)
        passed = [r for r in rivals if _passed(r, current, before, thresholds)]
        confirmed = [r for r in passed if takes_enough(r.fit, current, before)]
    confirmed = straightened(confirmed, thresholds.set_nats)
    if confirmed:
        confirmed = likelier(confirmed, _equal(_first(confirmed), confirmed, thresholds))
    return _Choice(rivals, passed, *_taking_it_away(current, confirmed, before, thresholds), twins)


def _passed(rival: Rival, current: Fit, before: Residual, thresholds: Thresholds) -> bool:
    """Whether a rival may give its name: enough evidence, and held-out data that confirm it."""
    return rival.convinces(thresholds) and confirmed_by_held_out(rival.fit, rival.held_out, current, before, thresholds)


def _taking_it_away(
    current: Fit, confirmed: Sequence[Rival], before: Residual, thresholds: Thresholds
) -> tuple[list[Rival], tuple[Rival, tuple[Rival, ...]] | None]:
    """The winner of the confirmed with its equals, and those of them that were not refused on the way to it.

    One that would win is refused where it leaves the residual to the place that explained it before.
    """
    left, place = sorted(confirmed, key=lambda r: -r.gain_nats), None
    while left:
        ahead = _first(left)
        winner, equal = _foretelling(ahead, _equal(ahead, left, thresholds))
        missed = winner.held_out
        if missed is None or missed <= before.limits.held_out_per_dof or before.held_out_chi2_per_dof is None:
            return left, (winner, equal)
        # Signatures of single interfaces: the whole airframe is none.
        place = localise(current, everywhere=False) if place is None else place
        after, noise = localise(winner.fit, everywhere=False), before.held_out_noise_per_dof or 0.0
        if not left_where_it_was(place, after, before.held_out_chi2_per_dof - noise, missed - noise):
            return left, (winner, equal)
        left = [r for r in left if r is not winner]
    return [], None


def _first(confirmed: Sequence[Rival]) -> Rival:
    """Of the confirmed the one that gains most; where much is left, of those that held-out data put first."""
    ahead = max(confirmed, key=lambda r: r.gain_nats)
    missed = [r.held_out for r in confirmed if r.held_out is not None]
    if ahead.fit.chi2_per_dof < BIASED or not missed:
        return ahead
    return max((r for r in confirmed if _as_good(r, min(missed))), key=lambda r: r.gain_nats)


def _equal(winner: Rival, confirmed: Sequence[Rival], thresholds: Thresholds) -> tuple[Rival, ...]:
    """The confirmed that cannot be told from the winner: within reach of its evidence, or of its held-out error.

    Under a model that still misses much, evidence weighs how far wrong unknowns are bent: held-out data decide alone.
    """
    missed = [r.held_out for r in confirmed if r.held_out is not None]
    if winner.fit.chi2_per_dof >= BIASED and winner.held_out is not None and missed:
        # Within reach of the least, as the winner is: within that of the winner would be twice as far.
        return tuple(r for r in confirmed if _as_good(r, min(missed)))
    near = winner.gain_nats - thresholds.set_nats
    return tuple(r for r in confirmed if r.gain_nats > near)


def _foretelling(ahead: Rival, equal: tuple[Rival, ...]) -> tuple[Rival, tuple[Rival, ...]]:
    """Of what cannot be told from the rival that is ``ahead`` the one that all data together put first, and all of it.

    Fitted data leave it open: what foretells the others better is the model to go on with.
    """
    if len(equal) < 2 or ahead.fit.chi2_per_dof >= BIASED or ahead.held_out is None:
        return ahead, equal

    def by_all(r: Rival) -> float:
        return r.gain_nats + held_out_nats(ahead.fit, r.fit, ahead.fit) if r.held_out is not None else -np.inf

    first = max(equal, key=by_all)
    return first, (first, *(r for r in equal if r is not first))


def _as_good(r: Rival, missed: float) -> bool:
    """Whether held-out data are met about as well as by what misses them so much."""
    return r.held_out is not None and r.held_out <= _AS_GOOD * missed


def _ahead_in_all(
    winner: Rival, rivals: Sequence[Rival], passed: Sequence[Rival], thresholds: Thresholds
) -> list[Rival]:
    """Rivals that held-out data alone do not confirm, and that are ahead of the winner by all data together.

    What keeps them from a name of their own may be chance, and what the winner owes its name to is then that chance.
    What they do confirm and was refused for another reason, its place or how little it takes, is not among them.
    """
    if winner.fit.chi2_per_dof >= BIASED or winner.held_out is None:
        return []
    unconfirmed = [r for r in rivals if r.convinces(thresholds) and r not in passed and r.name != winner.name]
    others = [r for r in unconfirmed if r.held_out is not None and not implausible(r.fit)]
    return [r for r in others if r.gain_nats + held_out_nats(winner.fit, r.fit, winner.fit) > winner.gain_nats]


def _twins(bent: Sequence[Hypothesis], confirmed: Sequence[Rival], before: Residual, named: bool) -> list[Hypothesis]:
    """Of the nonlinear joints, those that a name could be mistaken for; all, where there is no name and should be one.

    One level tells them from their linear likeness by little, and each costs marches over whole records: beside an
    effect that earlier rounds ``named`` it tells nothing.
    """
    if not confirmed:
        return [] if before.adequate or named else list(bent)
    names = {r.name for r in confirmed}
    return [h for h in bent if names & set(h.cls.confused_with)]  # type: ignore[attr-defined]


def _judged(current: Fit, found: Fit) -> Rival:
    """One fit as a rival on its own."""
    return against(current, [found])[0]


def _restart(null: Fit, winner: Rival) -> Fit:
    """The model without effects fitted again from the winner's scores: a better basin makes a fairer comparison.

    The same where it is no better there.
    """
    try:
        again = fit(null.problem, (), winner.fit.u, np.zeros(0), NEAR)
    except NoStructureError:
        # What the effect held up falls without it.
        return null
    return again if again.evidence_nats > null.evidence_nats + 0.5 else null
