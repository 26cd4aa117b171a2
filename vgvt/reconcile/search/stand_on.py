"""The stand on a fit, made once for all that is screened from it."""

from __future__ import annotations

from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.question.problem import Problem
from vgvt.reconcile.search.stand import Stand

# The last stand, with what it is known by, and the problem, whose identity is its own for as long as it is held here.
_last: list[tuple[tuple[object, ...], Problem, Stand]] = []


def stand_on(null: Fit) -> Stand:
    """The stand on a fit; the last one is kept, with the slopes that it knows.

    A fit that was sent to a helper once more is the same by what it holds.
    """
    named = tuple((h.name, repr(sorted(h.settings.items()))) for h in null.hypotheses)
    key = (id(null.problem), named, null.scores.tobytes(), null.chi2, null.evidence_nats)
    if not _last or _last[0][0] != key:
        _last[:] = [(key, null.problem, Stand.of(null))]
    return _last[0][2]
