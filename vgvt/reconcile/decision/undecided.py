"""What a next test has to tell apart: the explanations that one campaign leaves beside each other."""

from __future__ import annotations

from collections.abc import Sequence

from vgvt.data.shown import listed
from vgvt.reconcile.decision.attribute import Attribution
from vgvt.reconcile.decision.place_control import distinct_places
from vgvt.reconcile.evidence.rivals import Rival
from vgvt.reconcile.fitting.fit import Fit
from vgvt.reconcile.next_test.suggest import COMPARED
from vgvt.reconcile.question.hypothesis import Hypothesis


def undecided(found: Attribution) -> tuple[Fit, ...]:
    """The fits that a next test has to tell apart: of the last round that names several effects, the best fit of each.

    Where no round does, all that the last one with several holds: one effect at several places. Else what the last
    round holds: an effect that is alone, at one level. Nothing where there is no round: no name, nothing to tell.
    """
    for addition in reversed(found.rounds):
        best: dict[str, Fit] = {}
        rivals = (addition.winner, *addition.equivalent)
        if addition.in_its_place:
            # Fits that hold the same others: what they foretell differs by the one alone.
            beside = addition.in_its_place[0].fit.hypotheses[:-1]
            same = (r for r in addition.equivalent if _all_same(r.fit.hypotheses[:-1], beside))
            rivals = (*addition.in_its_place, *same)
        for r in rivals:
            best.setdefault(r.name, r.fit)
        if len(best) > 1:
            return tuple(best.values())
    apart = [_apart(addition.equivalent) for addition in reversed(found.rounds)]
    if not apart:
        return ()
    return tuple(r.fit for r in next((several for several in apart if len(several) > 1), apart[0]))


def words_of_the_rest(found: Attribution) -> tuple[str, ...]:
    """What is said of explanations that no test was compared for: the fourth of a round, and those of other rounds."""
    said, last = list[str](), [fit.hypotheses[-1] for fit in undecided(found)]
    names = [h.name for h in last]
    if len(last) > COMPARED:
        called = names if len(set(names)) == len(names) else [h.label for h in last]
        said.append(
            f"Tests were compared for {listed(called[:COMPARED], COMPARED)}; {listed(called[COMPARED:], len(called))} "
            "explains the data as well, and is to be told from what is left of them"
        )
    several = [list(dict.fromkeys(r.name for r in addition.alike)) for addition in found.rounds]
    for alike in several:
        if len(alike) > 1 and not set(alike) & set(names):
            said.append(f"Which of {' or '.join(alike)} is there no test was compared for: it is the next question")
    return tuple(said)


def _all_same(some: Sequence[Hypothesis], others: Sequence[Hypothesis]) -> bool:
    """Whether two models hold the same variants, in order."""
    return len(some) == len(others) and all(a.same(b) for a, b in zip(some, others, strict=True))


def _apart(rivals: tuple[Rival, ...]) -> list[Rival]:
    """Those of rivals with one name that say different things: two starts of one variant that met say the same."""
    kept: list[Rival] = []
    for r in rivals:
        if not any(r.hypothesis.same(o.hypothesis) and len(distinct_places([o.fit, r.fit])) < 2 for o in kept):
            kept.append(r)
    return kept


def next_best(found: Attribution) -> tuple[Fit, ...]:
    """What the last name that depends on level would have to be told from at another one, where it is alone.

    Its fit, and that of the effect of another name that came nearest; nothing where there is none.
    """
    for addition in reversed(found.rounds):
        winner = addition.winner
        if not winner.hypothesis.linear:
            others = [r for r in addition.rivals if r.name != winner.name]
            return (winner.fit, max(others, key=lambda r: r.gain_nats).fit) if others else ()
    return ()
