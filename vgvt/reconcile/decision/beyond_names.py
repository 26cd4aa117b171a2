"""Whether names are the whole truth: what a law at one place still explains beside them, where it is more than chance.

A name that meets the data may stand for something of its kind that is not in the catalogue. That is not explained, but
in part; and where it does not take nearly all of what was too much it is a lead. Several names beside which something
is still there are leads, too: relatives of one thing that has no name take it piece by piece, and leave the rest. Of
eleven answers of several names in part that the study saw in its seeds 58 to 84 one named what was there, and beside
that one no law explained any more.
"""

from __future__ import annotations

from dataclasses import replace

from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.leads import demoted, takes_nearly_all
from vgvt.reconcile.decision.one_level import bends_at_one_level
from vgvt.reconcile.evidence.still_explained import still_explained
from vgvt.reconcile.question.thresholds import Thresholds
from vgvt.reconcile.work.one_thread import one_thread


@one_thread
def asked_beyond_names(found: Attribution, thresholds: Thresholds) -> Attribution:
    """The same with what a law still explains beside its names, where that takes as many nats as a name does.

    Where a joint waits for a second level, what a linear law explains waits for it, too. Names that leave more than a
    tenth of what was too much are leads, and so are several; where nothing was too much there is no tenth of it.
    """
    if not found.rounds or bends_at_one_level(found):
        return found
    still = still_explained(found.final)
    if still is None or still.nats < thresholds.evidence_nats:
        return found
    told = replace(found, still=still)
    if found.null_residual.adequate:
        return told
    if not takes_nearly_all(found):
        return demoted(found)
    return told if len(found.rounds) == 1 else demoted(told)
