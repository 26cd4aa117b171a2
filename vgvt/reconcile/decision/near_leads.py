"""Which of several leads is told is no matter of a hair: what comes nearly as near stands beside it.

A name has to pass sharp rules, and of two effects at the edge of one the data decide little. Where neither gets a name,
who goes to the aircraft must know of both: on measured data a soft root and a surging spring changed places with every
small change of the search.
"""

from __future__ import annotations

from dataclasses import replace

from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.evidence.plausible import implausible
from vgvt.reconcile.evidence.rivals import Rival

# Of what the lead takes of the held-out error, what another effect must take; and how many others are told.
_NEARLY, _MOST = 0.9, 2


def with_nearly_as_near(addition: Addition) -> Addition:
    """The round of a lead with the rivals that held-out data put nearly where it is, one of each effect, best first."""
    others = tuple(nearly_as_near(addition))
    return replace(addition, equivalent=(*addition.equivalent, *others)) if others else addition


def nearly_as_near(addition: Addition) -> list[Rival]:
    """Rivals of a round that take nearly as much of the held-out error as its winner, and are not beside it already."""
    before, winner = addition.held_out_before, addition.winner
    if before is None or winner.held_out is None or winner.held_out >= before:
        return []
    reach = before - _NEARLY * (before - winner.held_out)
    told = {winner.name, *(r.name for r in addition.alike)}
    best: dict[str, Rival] = {}
    measured = [(r.held_out, r) for r in addition.rivals if r.held_out is not None and r.held_out <= reach]
    for _, r in sorted(measured, key=lambda pair: pair[0]):
        if r.name not in told and not implausible(r.fit):
            best.setdefault(r.name, r)
    return list(best.values())[:_MOST]


def beside_a_lead(addition: Addition) -> list[str]:
    """What stands beside a lead, in words: what comes nearly as near, and what only held-out data put before it."""
    winner = addition.winner
    best: dict[str, Rival] = {}
    for r in addition.alike:
        if r.name != winner.name:
            best.setdefault(r.name, r)
    nearer: list[str] = []
    near: list[str] = []
    for name, r in best.items():
        ahead = r.held_out is not None and winner.held_out is not None and r.held_out < winner.held_out
        (nearer if ahead else near).append(name if r.held_out is None else f"{name} ({r.held_out:.2f})")
    said = []
    if near:
        said.append(f"{' or '.join(near)} in place of {winner.name} comes nearly as near: which is ahead may be chance")
    if nearer:
        said.append(
            f"{' or '.join(nearer)} in place of {winner.name} meets held-out data better, and was passed over for "
            "another reason"
        )
    return said
