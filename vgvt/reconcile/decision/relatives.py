"""What a name could be taken for, by what its effect says itself: how far behind each relative is, or that none asked.

A relative of what is really there has the name where that is not among the effects to choose from, and meets the data
as well: no evidence says so. Who reads a name has to know which of its relatives were compared.
"""

from __future__ import annotations

from collections.abc import Collection

from vgvt.data.shown import listed
from vgvt.reconcile.decision.addition import Addition
from vgvt.reconcile.decision.attribute import Attribution

_MOST = 4
_NEVER, _ABSENT = "not fitted in its round", "not among the effects to choose from"


def words_of_relatives(found: Attribution, offered: Collection[str], tried: Collection[str]) -> tuple[str, ...]:
    """A sentence for each name that could be taken for others that are told neither beside it nor as refused.

    ``offered`` are the effects to choose from by name, ``tried`` those of them that this campaign can have.
    """
    told = {a.winner.name for a in found.rounds} | {r.name for r in found.vetoed}
    said = (_of_a_name(addition, told, offered, tried) for addition in found.rounds)
    return tuple(text for text in said if text)


def _of_a_name(addition: Addition, elsewhere: set[str], offered: Collection[str], tried: Collection[str]) -> str:
    winner = addition.winner
    likenesses: tuple[str, ...] = winner.hypothesis.cls.confused_with  # type: ignore[attr-defined]
    told = elsewhere | {r.name for r in addition.alike}
    asked = [name for name in likenesses if name in tried and name not in told]
    absent = [name for name in likenesses if name not in offered]
    best: dict[str, float] = {}
    for r in addition.rivals:
        best[r.name] = max(r.gain_nats, best.get(r.name, r.gain_nats))
    refused = "gave way beside the others" if addition.exchanged else "was refused"
    parts = [_behind(name, winner.gain_nats - best[name], refused) for name in asked if name in best]
    # A name that took another one's place was compared before it was in its round.
    never = [name for name in asked if name not in best and not addition.exchanged]
    parts += [
        f"{listed(names, _MOST)} {_was(names)} {what}" for names, what in ((never, _NEVER), (absent, _ABSENT)) if names
    ]
    return f"Of what {winner.name} could be taken for, {'; '.join(parts)}" if parts else ""


def _behind(name: str, nats: float, refused: str) -> str:
    """How far a relative is behind a name; one that is ahead had been ``refused``, in words."""
    return f"{name} is {nats:.0f} nats behind" if nats >= 0 else f"{name}, {-nats:.0f} nats ahead, {refused}"


def _was(names: Collection[str]) -> str:
    return "was" if len(names) == 1 else "were"
