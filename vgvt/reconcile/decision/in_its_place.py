"""Whether another effect does as well in the place of a named one, asked where everything else has come right.

A calibration that had bent itself to imitate an effect shows little of it, and what is tried for it first is what that
little looks like: a delay was called a mount, and no delay had been tried. With the effect in the model the unknowns
stand where they belong. Without it, and with nothing else moved, all that it does is in sight, and so is whatever could
do the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.backward import without
from vgvt.reconcile.decision.place_control import as_good
from vgvt.reconcile.evidence.plausible import implausible
from vgvt.reconcile.evidence.rivals import Rival, against
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.prediction.local_slopes import Origin
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.search.candidate_fits import fitted_from
from vgvt.reconcile.search.courses import best_course
from vgvt.reconcile.search.screen import at_sizes
from vgvt.reconcile.search.screened import Screened
from vgvt.reconcile.search.shortlist import BIASED
from vgvt.reconcile.search.stand import Stand
from vgvt.reconcile.work.progress import Progress, part, silent
from vgvt.reconcile.work.team import ALONE, Task, Team

# Of what a named effect buys where unknowns follow linearly, what another one must seem to buy to be fitted there. The
# closed form sees a resonance between the steps of its scan, and a place between its stations, only roughly. Beside
# names that leave something it sees less: the unknowns are bent towards what is not there, and whatever promises most
# is fitted.
_PROMISED = 0.5
_FITTED = 4
# What the order of effects may cost where they are the same model.
_SAME_NATS = 1.0


def reconsidered(
    rounds: Sequence[Addition],
    current: Fit,
    hypotheses: Sequence[Hypothesis],
    set_nats: float,
    tell: Progress = silent,
    team: Team = ALONE,
    *,
    met: bool = True,
) -> list[Addition]:
    """The rounds of a fit, each with what does as well as its winner, within ``set_nats``, or better in its place.

    ``met`` says that nothing but noise is left. What had been found to do so before is asked again: later rounds may
    have told the two.
    Nothing is asked of a model that still misses much: what would do better there is what imitates the rest.
    """
    if current.chi2_per_dof >= BIASED:
        return [replace(a, in_its_place=()) for a in rounds]
    named, found = {a.winner.name for a in rounds}, list[Addition]()
    others = [h for h in hypotheses if h.name not in named]
    for k, addition in enumerate(rounds):
        here = part(tell, k / len(rounds), (k + 1) / len(rounds))
        known = [r for r in addition.in_its_place[1:] if r.name not in named]
        own, rivals = in_its_place(current, k, others, set_nats, here, team, known, _PROMISED if met else 0.0)
        addition = replace(addition, in_its_place=())
        if own is not None and rivals:
            winner = addition.winner
            # By what the name had gained in its round.
            gain, raw = winner.gain_nats - own.gain_nats, winner.raw_nats - own.raw_nats
            lasting = winner.lasting_nats - own.lasting_nats
            alike = (
                replace(
                    r, gain_nats=r.gain_nats + gain, raw_nats=r.raw_nats + raw, lasting_nats=r.lasting_nats + lasting
                )
                for r in (own, *rivals)
            )
            addition = replace(addition, in_its_place=tuple(alike))
        found.append(addition)
    return found


def in_its_place(
    current: Fit,
    index: int,
    others: Sequence[Hypothesis],
    set_nats: float,
    tell: Progress = silent,
    team: Team = ALONE,
    known: Sequence[Rival] = (),
    share: float = _PROMISED,
) -> tuple[Rival | None, list[Rival]]:
    """The effect of that index of a model as a rival, and what of ``others`` does as well or better, best first.

    Asked is what promises more than a ``share`` of what that effect buys; ``known`` are effects, each last in a fit,
    that are asked whatever the closed form makes of them, one variant each. All are judged against the model that is
    left without it, and have it, or what is in its place, last. None, and nothing, where that order makes another
    model, or there is nothing to ask.
    """
    problem = current.problem
    kept, e, own = without(current, index)
    try:
        stand = fit(problem, kept, current.u, e, ())
        last = fit(problem, (*kept, current.hypotheses[index]), current.u, np.concatenate([e, own]), ())
    except NoStructureError:
        # It holds the aircraft up.
        return None, []
    # What depends on level has its linear likeness here, and levels tell the two.
    asked = [h for h in others if h.linear]
    if last.cost > current.cost + 2 * _SAME_NATS:
        # It acts on what a later one changed: last, it is another model, and no measure for what is in its place.
        return None, []
    start = Stand.of(stand)
    bought = 0.5 * (start.cost - current.cost)
    if not asked or bought <= 0:
        return None, []
    tries: list[Task] = [
        (fitted_from, (stand, s, NEAR))
        for s in (*_promising(start, asked, share * bought, part(tell, 0.0, 0.7)), *map(_arrived, known))
    ]
    fits = team.work_off(tries, part(tell, 0.7, 1.0))
    there = [_at_its_end(best_course(f, others)) for f in fits if f is not None]
    last = replace(_at_its_end(last), converged=current.converged)
    judged = against(stand, [last, *there])
    mine = next(r for r in judged if r.fit is last)
    rivals = dict[str, Rival]()
    for r in judged:
        near = r is not mine and r.gain_nats > mine.gain_nats - set_nats
        if near and as_good(r.fit, last, set_nats) and not implausible(r.fit):
            rivals.setdefault(r.name, r)
    return mine, list(rivals.values())


def _at_its_end(found: Fit) -> Fit:
    """The same fit judged by slopes that are taken where it ended: by those of its way down, up to 4 nats otherwise."""
    origin = Origin(found.u.copy(), found.e.copy())
    there = fit(found.problem, found.hypotheses, found.u, found.e, (), origin=origin, follow=found.followed)
    return replace(there, converged=found.converged)


def _arrived(rival: Rival) -> Screened:
    """The last effect of a fit as it ended there."""
    values = {k: v[0] for k, v in rival.fit.values(len(rival.fit.hypotheses) - 1).items()}
    return Screened(rival.hypothesis, values, rival.gain_nats, arrived=True)


def _promising(start: Stand, asked: Sequence[Hypothesis], least: float, tell: Progress) -> list[Screened]:
    """The best variant of each of the few effects that could buy most, and more than the ``least``, by the closed form.

    At a part of its size, where a screen looks first, nothing could: it is all of it, or nothing, that is missing.
    """
    sized: list[Screened] = []
    for k, hypothesis in enumerate(asked):
        tell(k / len(asked), f"in its place {hypothesis.name}")
        sized += at_sizes(start, hypothesis)
    best: dict[str, Screened] = {}
    for s in sorted(sized, key=lambda s: -s.gain_nats):
        if s.visible and s.gain_nats > least:
            best.setdefault(s.hypothesis.name, s)
    return [replace(s, start=start.fit.scores) for s in list(best.values())[:_FITTED]]
