"""Whether names are the whole truth: what a law at one place still explains beside them, where it is more than chance.

A name that meets the data may stand for something of its kind that is not in the catalogue. That is not explained, but
in part.
"""

from __future__ import annotations

from dataclasses import replace

from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.one_level import bends_at_one_level
from vgvt.reconcile.evidence.still_explained import still_explained
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.work.one_thread import one_thread


@one_thread
def asked_beyond_names(found: Attribution, thresholds: Thresholds) -> Attribution:
    """The same with what a law still explains beside its names, where that takes as many nats as a name does.

    Where a joint waits for a second level, what a linear law explains waits for it, too.
    """
    if not found.rounds or bends_at_one_level(found):
        return found
    still = still_explained(found.final)
    return found if still is None or still.nats < thresholds.evidence_nats else replace(found, still=still)
