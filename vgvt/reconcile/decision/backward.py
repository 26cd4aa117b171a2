"""What of a finished selection stays: no effect that later ones made needless, none without a place of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vgvt.reconcile.decision.place_control import distinct_places, ends_of
from vgvt.reconcile.evidence.lasting import lasting_nats
from vgvt.reconcile.evidence.plausible import AXES
from vgvt.reconcile.fitting.fit import NEAR, Fit, fit
from vgvt.reconcile.prediction.grouping import NoStructureError
from vgvt.reconcile.question.hypothesis import Hypothesis
from vgvt.reconcile.question.thresholds import Thresholds

if TYPE_CHECKING:
    from vgvt.reconcile.decision.addition import Addition
    from vgvt.reconcile.evidence.rivals import Rival

Array = NDArray[np.float64]


def needed(rounds: list[Addition], current: Fit, thresholds: Thresholds) -> tuple[list[Addition], Fit]:
    """Leave out the first of the earlier effects that the later ones have made needless, and ask again of the rest.

    Needless is what gains less than a name needs by either view, every line for itself or errors that last: what both
    grant is not taken from a name for how many lines the noise makes of them.
    """
    if len(rounds) < 2:
        return rounds, current
    for k in range(len(rounds) - 1):
        kept, e, _ = without(current, k)
        try:
            less = fit(current.problem, kept, current.u, e, NEAR)
        except NoStructureError:
            # It holds the aircraft up: nothing makes that needless.
            continue
        gained = min(current.evidence_nats - less.evidence_nats, lasting_nats(current) - lasting_nats(less))
        if gained < thresholds.evidence_nats:
            return needed([r for i, r in enumerate(rounds) if i != k], less, thresholds)
    return rounds, current


def without(current: Fit, index: int) -> tuple[tuple[Hypothesis, ...], Array, Array]:
    """Hypotheses of a model but for one, their scores (e,), and those of the one (its parameters,)."""
    ends = np.cumsum([len(h.parameters) for h in current.hypotheses])
    scores = np.split(current.e, ends[:-1])
    kept = [k for k in range(len(ends)) if k != index]
    rest = np.concatenate([np.zeros(0), *(scores[k] for k in kept)])
    return tuple(current.hypotheses[k] for k in kept), rest, scores[index]


def without_last(rounds: Sequence[Addition], start: Fit) -> tuple[list[Addition], Fit, list[Rival]]:
    """Rounds without the last one, the model that they leave (``start`` without any), and the winners that are gone.

    All of them where an earlier effect had been left out as needless beside the last one: no fit is there of the rest.
    """
    # What does as well as an earlier one was found beside the last.
    kept = [replace(r, in_its_place=()) for r in rounds[:-1]]
    if not kept:
        return [], start, [r.winner for r in rounds]
    found = kept[-1].winner.fit
    if [h.name for h in found.hypotheses] == [r.winner.name for r in kept]:
        return kept, found, [rounds[-1].winner]
    return [], start, [r.winner for r in rounds[::-1]]


def nowhere(addition: Addition) -> bool:
    """Whether the winner, a thing at a place, has none: it does as well at another one, or lies off the aircraft.

    Where data are met, that is how much they say of its place. Where much is still missed, it has bent to imitate what
    is no such thing: a moment by a force anywhere on an arm, or on an arm longer than there is.
    """
    winner = addition.winner
    if not ends_of(winner.fit):
        return False
    elsewhere = [r.fit for r in addition.equivalent if r.name == winner.name]
    return len(distinct_places([winner.fit, *elsewhere])) > 1 or _beyond(winner.fit)


def _beyond(found: Fit) -> bool:
    """Whether a place of the last effect is further out than its parameters plausibly reach."""
    reach = {p.name: (p.low, p.high) for p in found.hypotheses[-1].parameters if p.name in AXES}
    values = found.values(len(found.hypotheses) - 1)
    return any(not reach[n][0] <= v[0] <= reach[n][1] for n, v in values.items() if n in reach)
