"""What a reconciliation can come to, and which of them an attribution amounts to."""

from __future__ import annotations

from enum import StrEnum

from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.doubts import doubts, strained_too_much
from vgvt.reconcile.decision.one_level import rests_on_one_level
from vgvt.reconcile.decision.place_control import open_places


class Kind(StrEnum):
    """What a reconciliation can come to."""

    ADEQUATE = "adequate"
    EXPLAINED = "explained"
    AMBIGUOUS = "ambiguous"
    PARTLY_EXPLAINED = "partly_explained"
    UNKNOWN = "unknown"


def kind_of(found: Attribution) -> Kind:
    """The verdict that an attribution amounts to."""
    if not found.rounds:
        # Data that are met at the price of tolerances far exceeded are not explained by the scenario as stated.
        met = found.null_residual.adequate and not strained_too_much(found.null) and found.nameless is None
        return Kind.ADEQUATE if met else Kind.UNKNOWN
    doubtful = bool(doubts(found))
    # What a joint that depends on level leaves, or makes of the tolerances, is for the second level to say: a name that
    # rests on one is not settled, however little is left. A linear name beside such a likeness has to meet the data.
    # What a law at one place explains as it is no joint leaves: it is not asked beside one.
    # A fit that had not ended and meets the data is no other: what it was on its way to does not matter either.
    ended = found.final.converged or found.final_residual.adequate
    bends = ended and found.still is None and any(not a.winner.hypothesis.linear for a in found.rounds)
    awaits_level = rests_on_one_level(found) and (bends or (found.final_residual.met and not doubtful))
    if (not found.final_residual.adequate or doubtful) and not awaits_level:
        return Kind.PARTLY_EXPLAINED
    several = any(len({r.name for r in a.alike}) > 1 or open_places(a) for a in found.rounds)
    return Kind.AMBIGUOUS if several or rests_on_one_level(found) else Kind.EXPLAINED
