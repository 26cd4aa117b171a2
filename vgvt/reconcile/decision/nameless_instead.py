"""Names set against a thing that has none: what one smooth law at one place does without them speaks for no name.

Of what is not in the catalogue relatives take the most, and two more take what these leave: together they meet the
data, with as many sizes as it takes. What is really there is one thing at one place. Whatever its law may be, it does
with that what they do together, and lets go of the tolerances that they bent.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.beside_nameless import Array, Beside, best_beside, each_beside
from vgvt.reconcile.decision.leads import led_by_all
from vgvt.reconcile.decision.one_level import bends_at_one_level
from vgvt.reconcile.evidence.confirmation import not_spoken_against
from vgvt.reconcile.evidence.free_places import places_differ
from vgvt.reconcile.evidence.residual import residual
from vgvt.reconcile.evidence.rivals import against
from vgvt.reconcile.evidence.still_explained import still_explained
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.work.one_thread import one_thread
from vgvt.reconcile.work.progress import Progress, silent
from vgvt.reconcile.work.team import Team


@one_thread
def set_against_nameless(
    found: Attribution, thresholds: Thresholds, tell: Progress = silent, workers: int = 1
) -> Attribution:
    """The same without the names that a nameless thing makes needless; all of them leads where that needs none.

    Where a thing at one place, fitted beside all names, gains what a name needs, something nameless is there, and each
    of them has to gain as much beside it. Where none does, the fewest names that stand with a nameless thing must be
    ahead of all of them by that, or at all where the two are fewer things: on one that does as well alone, two and
    three names have gained nothing. Either way by both views of the model's own error, and held-out data must not speak
    for the names. What depends on level at one place waits for a second level. Where one point alone is fitted a thing
    could be anywhere, and takes no names: what is left beside these is asked in
    :mod:`vgvt.reconcile.decision.beyond_names`, which tells no place then. ``workers`` processes share the work, which
    changes the time and nothing else.
    """
    if not found.rounds or bends_at_one_level(found) or not all(h.linear for h in found.final.hypotheses):
        return found
    if not places_differ(found.final.problem):
        return found
    # What has the problem's and the names' identity keeps it.
    with Team(workers, (found.final.problem, *found.final.hypotheses)) as team:
        return _fewest(found, thresholds, tell, team)


def _fewest(found: Attribution, thresholds: Thresholds, tell: Progress, team: Team) -> Attribution:
    """The fewest of its names that stand with a nameless thing; all of them where none does."""
    still, named, each = still_explained(found.final), len(found.rounds), thresholds.evidence_nats
    (names,) = against(found.null, [found.final])
    gain = np.array([names.gain_nats, names.lasting_nats])
    beside = None
    if still is not None and still.nats >= each:
        beside = best_beside(found, team, tell)
    there = beside is not None and bool((beside.nats >= gain + each).all())
    fewer: Array | None = None
    for count in range(named):
        tell(count / named, f"one nameless thing beside {count} of {named} names")
        # As many things as there were names must be ahead by a name's worth, fewer of them ahead at all.
        needed = gain + (each if count + 1 == named else 0.0)
        if there and beside is not None:
            needed = np.maximum(gain, beside.nats) - each * (named - count)
        if fewer is not None:
            # A name that stays has to gain on fewer of them what a name needs.
            needed = np.maximum(needed, fewer + each)
        with_each = each_beside(found, count, float(needed[0]), team, tell)
        stand = [b for b in with_each if (b.nats > needed).all() and not_spoken_against(b.nameless, found.final)]
        if stand:
            best = max(stand, key=lambda b: float(b.nats[0]))
            return _instead(found, best, float(best.nats[0] - gain[0]), thresholds)
        reached = [b.nats for b in with_each]
        fewer = np.max([*([] if fewer is None else [fewer]), *reached], axis=0) if reached else fewer
    return found


def _instead(found: Attribution, best: Beside, ahead_nats: float, thresholds: Thresholds) -> Attribution:
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
